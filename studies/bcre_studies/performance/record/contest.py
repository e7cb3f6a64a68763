"""Who competes, on which scenes, against which truth; and what each of them gets wrong.

A contender is prepared for a scene and a number of cells and then solves it as often as asked.
Our own models follow the bounds of their steps; the rivals take a fixed step, half of what their
scheme allows with the largest layer that occurs, where they take a step at all.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache, partial
from typing import Any, cast

import numpy as np

import bcre_ca
import bcre_pde
from bcre_pde import Method, exact
from bcre_studies.models.automaton import rule_of
from bcre_studies.models.bcre import problem_of, run_of
from bcre_studies.models.registry import SCHEMES
from bcre_studies.observables.fronts import edge
from bcre_studies.performance.rivals import (
    fipy_solver,
    method_of_lines,
    numpy_automaton,
    pypde_expressions,
)
from bcre_studies.performance.rivals.rivals import EndState, Solve
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.scene import Scene, load

WAVE = "nonlinear wave, exact"
PAST_SCARP = "figure 1, past its scarp"
PDE_TOLERANCE = 1e-5
"""Local error in time per step; what it leaves is below the error in space on all these grids."""

TRUTH_CELLS = (400, 800, 1600)
FRONT_SHARE = 0.1
"""The front is where R falls below this part of its largest value, seen from downhill."""


@cache
def scenes() -> dict[str, Scene]:
    """The scenes of the contest.

    Past its scarp figure 1 has no converged solution without curvature, and is solved with the
    kappa that the paper's cells of d = 1 amount to, gamma d/2.
    """
    figure1 = load("figure1")
    return {
        "figure 1, before its scarp": figure1.with_changes(until=150.0),
        PAST_SCARP: figure1.with_changes(until=250.0, kappa=0.005),
        "figure 2": load("figure2"),
        "figure 3": load("figure3"),
        WAVE: load("climbing_wave"),
    }


@dataclass(frozen=True)
class Contender:
    """A model with its method.

    Parameters
    ----------
    prepare: takes a scene and cells, returns the function that solves it.
    coarsest: fewest cells.
    most: cell-steps beyond which no finer grid is tried.
    finer: factor from grid to grid.
    only: the scenes in which it enters; all of them if left out.
    """

    name: str
    prepare: Callable[[Scene, int], Solve]
    coarsest: int
    most: float
    finer: int = 2
    only: tuple[str, ...] = ()

    def enters(self, label: str) -> bool:
        """Whether it competes on the scene of that label."""
        return not self.only or label in self.only


METHODS: tuple[Method, ...] = ("runge-kutta", "RK45", "DOP853", "LSODA", "BDF")


def own() -> tuple[Contender, ...]:
    """The automaton's schemes and the PDE's methods."""
    limits = ((50, 4e8), (50, 4e8), (25, 1e8))
    pdes: dict[Method, float] = {"LSODA": 4e5, "BDF": 4e5}
    return tuple(
        Contender(model.label, partial(_automaton, model.name), coarsest, most)
        for model, (coarsest, most) in zip(SCHEMES.values(), limits, strict=True)
    ) + tuple(
        Contender(f"PDE, {method}", partial(_pde, method), 25, pdes.get(method, 1.5e7))
        for method in METHODS
    )


def rivals() -> tuple[Contender, ...]:
    """What a user would pick instead; FiPy only where it is installed."""
    compiling: dict[str, Any] = {"finer": 4, "only": ("figure 2", WAVE)}  # for minutes
    found = (
        Contender("NumPy automaton", _numpy, 50, 6e6),
        Contender("py-pde expressions, central", _pypde_central, 100, 1e7, **compiling),
        Contender("py-pde expressions, upwind Euler", _pypde_upwind, 100, 1e7, **compiling),
        Contender("SciPy LSODA, banded", _lines, 50, 4e5),
    )
    fipy = (Contender("FiPy", _fipy, 50, 3e4),)
    return found + (fipy if fipy_solver.available() else ())


def _automaton(scheme: str, scene: Scene, cells: int) -> Solve:
    changed = scene.with_changes(cells=cells, step="auto", scheme=scheme)
    rule, x = rule_of(changed), changed.centres()
    start = bcre_ca.Pile(*changed.initial(x))
    ends, until = scene.domain.ends, scene.time.until

    def solve() -> EndState:
        (end,) = bcre_ca.frames(start, rule, [until], ends)
        return EndState(x, end.h, end.R, end.steps, end.steps)

    return solve


def _pde(method: Method, scene: Scene, cells: int) -> Solve:
    problem = problem_of(scene)

    def solve() -> EndState:
        end = bcre_pde.solve(problem, [scene.time.until], cells, method, PDE_TOLERANCE)
        return EndState(end.x, end.h[-1], end.R[-1], end.steps, end.evaluations)

    return solve


def _numpy(scene: Scene, cells: int) -> Solve:
    return numpy_automaton.prepare(_printed(scene), scene.time.until, cells, _step(scene, cells))


def _pypde_central(scene: Scene, cells: int) -> Solve:
    return pypde_expressions.prepare(problem_of(scene), scene.time.until, cells)


def _pypde_upwind(scene: Scene, cells: int) -> Solve:
    step = _step(scene, cells)
    return pypde_expressions.prepare(problem_of(scene), scene.time.until, cells, step)


def _lines(scene: Scene, cells: int) -> Solve:
    return method_of_lines.prepare(problem_of(scene), scene.time.until, cells, PDE_TOLERANCE)


def _fipy(scene: Scene, cells: int) -> Solve:
    return fipy_solver.prepare(problem_of(scene), scene.time.until, cells, _step(scene, cells))


def _printed(scene: Scene) -> bcre_pde.Problem:
    """The scene as the paper's rule sees it, without curvature."""
    return problem_of(scene.with_changes(kappa=0.0))


def _step(scene: Scene, cells: int) -> float:
    """A whole part of the end time, at most half of the stable step at the largest layer."""
    coarse = scene.with_changes(cells=100, step="auto", scheme="upwind")
    largest = max(
        float(pile.max()) for pile in (truth_of(scene).R, coarse.initial(coarse.centres())[1])
    )
    rule = rule_of(scene.with_changes(cells=cells, step="auto", scheme="upwind"))
    bound = rule.max_stable_step(1.5 * largest, _flattest(coarse))
    return scene.time.until / math.ceil(scene.time.until / (0.5 * bound))


def _flattest(scene: Scene) -> float:
    h, _ = scene.initial(scene.centres())
    return float(np.min(h[:-1] - h[1:])) / scene.d


@dataclass(frozen=True)
class Truth:
    """h and R at the end as functions of x, and the relative L1 error of R of what gave them."""

    layers: Callable[[Array], tuple[Array, Array]]
    R: Array
    error: float


def truth_of(scene: Scene) -> Truth:
    """The exact solution where the scene has one, else a solve on three grids."""
    return _truth(scene.model_dump_json(), scene)


_known: dict[str, Truth] = {}


def _truth(key: str, scene: Scene) -> Truth:
    if key not in _known:
        # Without diffusion and curvature the only scene is that of the nonlinear wave.
        exactly = scene.material.D == scene.material.kappa == 0
        _known[key] = _exact(scene) if exactly else _solved(scene)
    return _known[key]


def _exact(scene: Scene) -> Truth:
    wave = exact.climbing_hump(
        v=scene.material.v,
        gamma=scene.material.gamma,
        height=0.3,
        width=1.5,
        length=scene.domain.length,
        until=scene.time.until,
    )
    x = scene.centres(1600)
    return Truth(
        lambda at: wave.layers(at, scene.time.until), wave.layers(x, scene.time.until)[1], 0.0
    )


def _solved(scene: Scene) -> Truth:
    problem, until = problem_of(scene), [scene.time.until]
    runs = [
        run_of(scene, bcre_pde.solve(problem, until, cells, tolerance=1e-8))
        for cells in TRUTH_CELLS
    ]
    x = runs[0].x
    coarse, medium, fine = (run.sample(x) for run in runs)
    index = bcre_pde.grid_convergence_index(fine, medium, coarse)
    finest, Sc = runs[-1], scene.material.Sc

    def layers(at: Array) -> tuple[Array, Array]:
        return finest.sample(at, "u") - Sc * at, finest.sample(at)

    return Truth(layers, finest.R[-1], index.error / float(np.mean(np.abs(fine))))


def errors(scene: Scene, end: EndState) -> dict[str, float]:
    """What the contender got wrong at the end.

    ``error_R``: mean|R - R*| / mean|R*|; ``error_h``: mean|h - h*| / mean|h* - h(t=0)|;
    ``error_front``: distance of the downhill front, a length; ``error_slope``: difference of the
    mean slope between the first and the last cell.
    """
    h, R = truth_of(scene).layers(end.x)
    start, _ = scene.initial(end.x)
    span = float(end.x[-1] - end.x[0])
    front = _front(end.x, end.R) - _front(end.x, R)
    slope = ((end.h[0] - end.h[-1]) - (h[0] - h[-1])) / span
    return {
        "error_R": float(np.mean(np.abs(end.R - R)) / np.mean(np.abs(R))),
        "error_h": float(np.mean(np.abs(end.h - h)) / np.mean(np.abs(h - start))),
        "error_front": abs(float(front)),
        "error_slope": abs(float(slope)),
    }


def _front(x: Array, R: Array) -> float:
    """x of the last fall of R below a tenth of its rise above the thinnest layer."""
    level = float(R.min()) + FRONT_SHARE * float(np.ptp(R))
    return -edge(-x[::-1], R[::-1], level)


def rungs(
    contender: Contender, scene: Scene, most: float | None = None
) -> Iterator[tuple[int, Solve, EndState]]:
    """Ever finer grids with what the contender made of them, up to ``most`` cell-steps.

    They begin with the first that can hold the start of the scene.
    """
    cells, most = contender.coarsest, min(contender.most, most or contender.most)
    while not scene.holds(cells):
        cells *= contender.finer
    while True:
        solve = contender.prepare(scene, cells)
        end = solve()
        yield cells, solve, end
        # A step is at most as long as a cell: finer grids take as many more steps at least.
        if contender.finer**2 * cells * end.evaluations > most:
            return
        cells *= contender.finer


def row_of(label: str, contender: Contender, cells: int, end: EndState) -> dict[str, Any]:
    """One line of the table of errors."""
    return {
        "scene": label,
        "contender": contender.name,
        "cells": cells,
        "steps": end.steps,
        "cell_steps": cells * end.evaluations,
        **cast(dict[str, Any], errors(scenes()[label], end)),
    }
