"""The automaton of ``bcre_ca.plane`` on a scene."""

from __future__ import annotations

import time
from collections.abc import Sequence

import numpy as np

import bcre_ca
from bcre_ca.plane import Plane, Sand, Source, frames
from bcre_ca.plane.theory import max_stable_step
from bcre_studies.models.plane.run import PlaneRun
from bcre_studies.models.registry import AUTOMATON
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.plane.scene import PlaneScene
from bcre_studies.scenes.refusal import SceneError

MOST_CELL_STEPS = 1e13
"""A run that would take more is refused: it would not end within hours."""


def run(scene: PlaneScene, times: Sequence[float], threads: int | None = None) -> PlaneRun:
    """The scene in the automaton, recorded at the ascending times.

    Raises
    ------
    SceneError
        where the scene's step cannot be stable or is outgrown, or the run would not end.
    """
    h, R = scene.initial()
    try:
        start, plane = Sand(h, R), plane_of(scene, h)
        _refuse_endless(scene, max_stable_step(plane))
        for _ in frames(start, plane, [0.0], scene.time.step, threads):
            pass  # compiles, so that the clock sees the run alone
        began = time.perf_counter()
        found = list(frames(start, plane, times, scene.time.step, threads))
    except (bcre_ca.UnstableStep, FloatingPointError) as failure:
        step = scene.time.step
        raise SceneError(f"time.step = {step!r}: {failure}, or be 'auto'") from None
    last = found[-1]
    return PlaneRun(
        model=AUTOMATON.name,
        scene=scene,
        t=np.array([sand.t for sand in found]),
        h=np.array([sand.h for sand in found]),
        R=np.array([sand.R for sand in found]),
        inflow=np.array([sand.inflow for sand in found]),
        outflow=np.array([sand.outflow for sand in found]),
        steps=last.steps,
        wall_s=time.perf_counter() - began,
        facts={
            "step_lowered": last.lowered,
            "step_raised": last.raised,
            "blocks_redone": last.redone,
        },
    )


def plane_of(scene: PlaneScene, h: Array) -> Plane:
    """What the sand of the scene lies on; h is its static layer at the start."""
    material, domain = scene.material, scene.domain
    walls = scene.walls()
    fixed = scene.time.step
    return Plane(
        bcre_ca.Rule(
            material.v,
            material.D,
            material.gamma,
            material.Sc,
            domain.d,
            dt=1.0 if fixed == "auto" else fixed,
            dry=scene.automaton.dry,
        ),
        flow=scene.automaton.flow,
        D_across=material.across,
        ends=domain.ends,
        sides=domain.sides,
        walls=walls if walls.any() else None,
        base=None if scene.base is None else h - scene.base.thickness,
        sources=tuple(
            Source(source.rate, source.place, source.width, (source.start, source.until))
            for source in scene.source
        ),
    )


def _refuse_endless(scene: PlaneScene, longest_step: float) -> None:
    fixed = scene.time.step
    steps = scene.time.until / (longest_step if fixed == "auto" else fixed)
    cells = scene.domain.cells * scene.domain.cells_across
    if steps * cells > MOST_CELL_STEPS:
        raise SceneError(
            f"time.until = {scene.time.until!r}: would take {steps:.1g} steps of {cells} cells; "
            f"must take at most {MOST_CELL_STEPS:.0e} cell-steps"
        )
