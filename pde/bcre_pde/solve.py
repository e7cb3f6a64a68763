"""Solving an initial value problem for BCRE, recorded at given times."""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray
from pde import CartesianGrid, FieldCollection

from bcre_pde.advance import Method as Method  # re-exported
from bcre_pde.advance import advance
from bcre_pde.equation import BCRE, Material
from bcre_pde.fluxes import SMALLEST_GRID

Array = NDArray[np.float64]
Ends = Literal["open", "periodic"]

TOLERANCE = 1e-6
"""Default local error per step, relative to the largest rolling layer."""


MOST_EVALUATIONS = 10**8
"""How often one solve may evaluate the right-hand side before it is taken to be endless."""


@dataclass(frozen=True)
class Problem:
    """An initial value problem for BCRE.

    Parameters
    ----------
    initial: function of positions x, shape (N,), that returns h and R there, lengths.
    material: the coefficients.
    length: the domain is 0 <= x <= length, x running downhill; finite, > 0.
    ends: ``"open"`` (closed top, open foot) or ``"periodic"`` (in h + Sc x and R).

    Raises
    ------
    ValueError
        naming the parameter, its value and what is allowed.
    """

    initial: Callable[[Array], tuple[Array, Array]]
    material: Material
    length: float
    ends: Ends = "open"

    def __post_init__(self) -> None:
        if not (math.isfinite(self.length) and self.length > 0):
            raise ValueError(f"length = {self.length!r}: must be a finite number > 0")
        if self.ends not in get_args(Ends):
            raise ValueError(f"ends = {self.ends!r}: must be one of {get_args(Ends)}")


@dataclass(frozen=True)
class Solution:
    """Layers at the cell centres ``x`` (N,) and times ``t`` (T,): ``h``, ``R`` of shape (T, N).

    ``outflow`` (T,) is the area that has left through the foot, so that
    ``dx sum(h + R) + outflow`` does not change; ``evaluations`` counts right-hand sides.
    """

    problem: Problem
    x: Array
    t: Array
    h: Array
    R: Array
    outflow: Array
    steps: int
    evaluations: int
    wall_s: float

    @property
    def dx(self) -> float:
        """Cell length."""
        return self.problem.length / self.x.size

    @property
    def u(self) -> Array:
        """Height above the repose line, h + Sc x, shape (T, N)."""
        return self.h + self.problem.material.Sc * self.x

    def mass(self) -> Array:
        """Area of sand in the domain at every time, shape (T,)."""
        rows = zip(self.h, self.R, strict=True)
        return np.array([self.dx * (math.fsum(h) + math.fsum(R)) for h, R in rows])


def solve(
    problem: Problem,
    times: Sequence[float],
    cells: int,
    method: Method = "runge-kutta",
    tolerance: float = TOLERANCE,
    stop: Callable[[Solution], bool] | None = None,
) -> Solution:
    """Solve BCRE up to the last of the ascending ``times``.

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

    Raises
    ------
    SolveError
        where the solver gave up, or would evaluate the right-hand side more often than
        ``MOST_EVALUATIONS``; ValueError for arguments that are not allowed.
    """
    times = ascending(times)
    if method not in get_args(Method):
        raise ValueError(f"method = {method!r}: must be one of {get_args(Method)}")
    if not 0 < tolerance < 1:
        raise ValueError(f"tolerance = {tolerance!r}: must lie between 0 and 1")
    if cells < SMALLEST_GRID:
        raise ValueError(f"cells = {cells!r}: must be at least {SMALLEST_GRID}")
    periodic = problem.ends == "periodic"
    grid = CartesianGrid([[0.0, problem.length]], cells, periodic=periodic)
    equation = BCRE(problem.material, grid, MOST_EVALUATIONS)
    state = _initial_state(problem, grid)
    record = _Recorder(problem, grid)
    equation.evolution_rate(state)  # compiles, so that the clock sees the solve alone
    began = time.perf_counter()
    now = 0.0
    for then in times:
        if then > now:
            counted = equation.evaluations
            state, steps = advance(equation, state, (now, then), method, tolerance)
            record.steps += steps
            record.evaluations += equation.evaluations - counted
            now = then
        record.add(state, then, time.perf_counter() - began)
        if stop is not None and stop(record.solution(ends_only=True)):
            break
    return record.solution()


class _Recorder:
    """Gathers frames and counts into a :class:`Solution`."""

    def __init__(self, problem: Problem, grid: CartesianGrid) -> None:
        self.problem = problem
        self.x: Array = grid.cell_coords[:, 0]
        self.frames: list[tuple[float, Array]] = []
        self.steps = 0
        self.evaluations = 0
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
        )


def _initial_state(problem: Problem, grid: CartesianGrid) -> FieldCollection:
    x = grid.cell_coords[:, 0]
    h, R = problem.initial(x)
    h_foot, _ = problem.initial(np.array([problem.length]))
    Sc = problem.material.Sc
    if not (np.isfinite(h).all() and np.isfinite(R).all()):
        raise ValueError("the initial h and R must be finite")
    return BCRE.state(grid, h + Sc * x, R, float(h_foot[0]) + Sc * problem.length)


def ascending(times: Sequence[float]) -> list[float]:
    """The times as numbers, refused unless they ascend from 0 or later."""
    ordered = [float(t) for t in times]
    if not ordered or ordered[0] < 0 or not all(map(math.isfinite, ordered)):
        raise ValueError(f"times = {ordered!r}: must be finite, >= 0 and not empty")
    if any(a >= b for a, b in itertools.pairwise(ordered)):
        raise ValueError(f"times = {ordered!r}: must ascend")
    return ordered
