"""Solving an initial value problem for BCRE, recorded at given times."""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, get_args

import numpy as np

from bcre_pde.gate import (
    ascending,
    initial_layers,
    require_callable,
    require_kind,
    require_tolerance,
    whole,
)
from bcre_pde.material import Material
from bcre_pde.problem import SMALLEST_GRID, Array, Method, Problem, Solution
from bcre_pde.source import Source

if TYPE_CHECKING:
    from pde import CartesianGrid, FieldCollection

    from bcre_pde.line.marched import MarchedOnLine


TOLERANCE = 1e-6
"""Default local error per step, relative to the largest rolling layer."""

MOST_EVALUATIONS = 10**8
"""How often one solve may evaluate the right-hand side before it is taken to be endless."""


def solve(
    problem: Problem,
    times: Sequence[float],
    cells: int,
    method: Method = "runge-kutta",
    tolerance: float = TOLERANCE,
    stop: Callable[[Solution], bool] | None = None,
    equation: type[MarchedOnLine] | None = None,
) -> Solution:
    """Solve BCRE up to the last of the ascending ``times``.

    py-pde and the compiled code are imported at the first call.

    Parameters
    ----------
    problem: what to solve.
    times: when to record the layers; 0 records the start.
    cells: number N of cells, >= 8.
    method: ``"runge-kutta"`` is py-pde's adaptive explicit Runge-Kutta-Fehlberg solver, kept below
        the stable step; the others go through py-pde to SciPy's solver of that name.
    tolerance: local error per step, relative to the largest rolling layer (and, for SciPy's
        solvers, to each value).
    stop: asked after every recorded time with a solution of the first and the latest frame; True
        ends the solve there.
    equation: another model on a line (see :mod:`bcre_pde.equation`); left out, BCRE.

    Raises
    ------
    SolveError
        where the solver gave up, or would evaluate the right-hand side more often than
        ``MOST_EVALUATIONS``; ValueError for arguments that are not allowed.
    """
    times = ascending(times)
    if method not in get_args(Method):
        raise ValueError(f"method = {method!r}: must be one of {get_args(Method)}")
    require_kind("problem", problem, Problem)
    require_tolerance(tolerance)
    cells = whole("cells", cells, SMALLEST_GRID)
    from bcre_pde.advance import advance
    from bcre_pde.equation import BCRE

    if stop is not None:
        require_callable(stop=stop)
    if equation is None:
        require_kind("material", problem.material, Material)
    model = BCRE if equation is None else equation
    grid = model.grid(problem.length, cells, problem.ends)
    marched = model(problem.material, grid, MOST_EVALUATIONS, problem.ends == "wall")
    state = _initial_state(problem, marched, grid)
    record = _Recorder(problem, grid)
    if problem.sources:
        marched.pour(problem.sources)
    marched.evolution_rate(state)  # compiles, so that the clock sees the solve alone
    began = time.perf_counter()
    now = 0.0
    for then in times:
        if then > now:
            counted = marched.evaluations
            for span in _between_changes(problem.sources, now, then):
                if problem.sources:
                    marched.pour([s for s in problem.sources if s.start <= span[0] < s.until])
                state, steps = advance(marched, state, span, method, tolerance)
                record.steps += steps
            record.evaluations += marched.evaluations - counted
            record.step_error = marched.step_error
            now = then
        record.add(state, then, time.perf_counter() - began)
        if stop is not None and stop(record.solution(ends_only=True)):
            break
    return record.solution()


def _between_changes(
    sources: Sequence[Source], now: float, then: float
) -> Iterator[tuple[float, float]]:
    """The stretches of time in which no source begins or ends."""
    changes = {t for source in sources for t in (source.start, source.until) if now < t < then}
    return itertools.pairwise([now, *sorted(changes), then])


class _Recorder:
    """Gathers frames and counts into a :class:`Solution`."""

    def __init__(self, problem: Problem, grid: CartesianGrid) -> None:
        self.problem = problem
        self.x: Array = grid.cell_coords[:, 0]
        self.frames: list[tuple[float, Array]] = []
        self.steps = 0
        self.evaluations = 0
        self.step_error = 0.0
        self.wall_s = 0.0

    def add(self, state: FieldCollection, t: float, wall_s: float) -> None:
        self.frames.append((t, state.data.copy()))
        self.wall_s = wall_s

    def solution(self, *, ends_only: bool = False) -> Solution:
        frames = [self.frames[0], self.frames[-1]] if ends_only else self.frames
        data = np.array([frame for _, frame in frames])
        repose_line = self.problem.material.Sc * self.x
        return Solution(
            problem=self.problem,
            x=self.x,
            t=np.array([t for t, _ in frames]),
            h=data[:, 0] - repose_line,
            R=data[:, 1],
            outflow=data[:, 2, -1] * self.problem.length,
            steps=self.steps,
            evaluations=self.evaluations,
            wall_s=self.wall_s,
            step_error=self.step_error,
        )


def _initial_state(
    problem: Problem, equation: MarchedOnLine, grid: CartesianGrid
) -> FieldCollection:
    x = grid.cell_coords[:, 0]
    h, R = initial_layers(problem.initial(x), x.shape)
    h_foot, _ = initial_layers(problem.initial(np.array([problem.length])), (1,))
    Sc = problem.material.Sc
    return equation.state(grid, h + Sc * x, R, float(h_foot[0]) + Sc * problem.length)
