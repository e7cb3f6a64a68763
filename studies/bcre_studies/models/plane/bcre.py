"""BCRE of ``bcre_pde.plane`` on a scene: a tilted plane without walls and sources."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

import bcre_pde
from bcre_pde.plane import Material, Problem, solve
from bcre_studies.models.plane.run import PlaneRun
from bcre_studies.models.registry import BCRE
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.plane.scene import PlaneScene
from bcre_studies.scenes.refusal import SceneError


def run(scene: PlaneScene, times: Sequence[float], threads: int = 1) -> PlaneRun:
    """The scene in BCRE on its own cells, recorded at the ascending times.

    Raises
    ------
    SceneError
        for a scene that BCRE does not take here, or where the solver gives up.
    """
    require_taken(scene)
    try:
        solution = solve(
            problem_of(scene), times, scene.domain.shape, scene.solver.tolerance, threads
        )
    except bcre_pde.SolveError as failure:
        raise SceneError(f"domain.cells = {scene.domain.cells!r}: {failure}") from None
    return PlaneRun(
        model=BCRE.name,
        scene=scene,
        t=solution.t,
        h=solution.h,
        R=solution.R,
        inflow=np.zeros_like(solution.t),
        outflow=solution.outflow,
        steps=solution.steps,
        wall_s=solution.wall_s,
        facts={"evaluations": solution.evaluations},
    )


def require_taken(scene: PlaneScene) -> None:
    """Raise :class:`SceneError` for what BCRE on a plane does not have here."""
    flow, ends = scene.automaton.flow, scene.domain.ends
    for key, value, is_taken, allowed in (
        ("automaton.flow", flow, flow == "tilted", "'tilted'"),
        ("domain.ends", ends, ends != "closed", "'open' or 'periodic'"),
        ("wall", f"{len(scene.wall)} walls", not scene.wall, "left out"),
        ("source", f"{len(scene.source)} sources", not scene.source, "left out"),
    ):
        if not is_taken:
            raise SceneError(f"{key} = {value!r}: must be {allowed} for --model pde")
    along, across = scene.domain.shape
    if along < bcre_pde.SMALLEST_GRID or across < 3:
        raise SceneError(f"domain.cells = {along} x {across}: must be 8 x 3 at least for BCRE")


def problem_of(scene: PlaneScene) -> Problem:
    """The scene as an initial value problem of BCRE."""
    material, domain = scene.material, scene.domain
    assert domain.ends != "closed"
    return Problem(
        initial=lambda x, y: _layers(scene, x, y),
        material=Material(material.v, material.D, material.across, material.gamma, material.Sc),
        length=domain.length,
        width=domain.width,
        ends=domain.ends,
        sides=domain.sides,
        thickness=math.inf if scene.base is None else scene.base.thickness,
    )


def _layers(scene: PlaneScene, x: Array, y: Array) -> tuple[Array, Array]:
    """The initial layers in the cells; on the foot, where x is the length, h goes on as it ends."""
    h, R = scene.initial()
    if x.shape == h.shape:
        return h, R
    return (1.5 * h[-1] - 0.5 * h[-2]).reshape(x.shape), R[-1].reshape(x.shape)
