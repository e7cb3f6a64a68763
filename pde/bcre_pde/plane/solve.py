"""Solving an initial value problem for BCRE on a plane, recorded at given times."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from bcre_pde.gate import ascending, initial_layers, require_kind, require_tolerance, whole
from bcre_pde.plane.problem import Frame, Problem, Solution, checked_cells
from bcre_pde.solve import MOST_EVALUATIONS, TOLERANCE

if TYPE_CHECKING:
    from pde import CartesianGrid, FieldCollection

    from bcre_pde.plane.equation import BCRE


@dataclass
class Account:
    """What a march has cost so far: steps, right-hand sides, seconds."""

    steps: int = 0
    evaluations: int = 0
    wall_s: float = 0.0


def march(
    problem: Problem,
    times: Sequence[float],
    cells: tuple[int, int],
    tolerance: float = TOLERANCE,
    threads: int = 1,
    account: Account | None = None,
) -> Iterator[Frame]:
    """The layers at each of the ascending ``times``, one after the other; none is kept.

    Parameters
    ----------
    problem: what to solve.
    times: when to give the layers; 0 gives the start. py-pde is imported at the first call.
    cells: Nx >= 8 along and Ny >= 3 across.
    tolerance: local error per step of py-pde's adaptive Runge-Kutta-Fehlberg solver, kept below the
        stable step; relative to the largest rolling layer.
    threads: on how many the work is done, >= 1; the numbers are the same on any.
    account: is told what it cost.

    Raises
    ------
    SolveError
        where the solver gave up; ValueError, at once, for arguments that are not allowed.
    """
    ordered = ascending(times)
    require_kind("problem", problem, Problem)
    require_tolerance(tolerance)
    cells, threads = checked_cells(cells), whole("threads", threads, 1)
    from bcre_pde.plane.equation import BCRE

    joined = problem.ends == "periodic", problem.sides == "periodic"
    grid = BCRE.grid(problem.length, problem.width, cells, joined)
    state = _initial_state(problem, grid)
    bed = None
    if math.isfinite(problem.thickness):
        bed = state[0].data - problem.thickness, problem.grain or problem.thickness / 10
    equation = BCRE(problem.material, grid, MOST_EVALUATIONS, threads, bed)
    return _frames(problem, ordered, equation, state, tolerance, account or Account())


def _frames(
    problem: Problem,
    times: list[float],
    equation: BCRE,
    state: FieldCollection,
    tolerance: float,
    account: Account,
) -> Iterator[Frame]:
    from bcre_pde.advance import advance

    equation.compile(state)  # so that the clock sees the march alone
    repose = problem.material.Sc * state.grid.cell_coords[..., 0]
    now = 0.0
    for then in times:
        if then > now:
            began = time.perf_counter()
            state, steps = advance(equation, state, (now, then), "runge-kutta", tolerance)
            account.steps += steps
            account.evaluations = equation.evaluations
            account.wall_s += time.perf_counter() - began
            now = then
        u, R, ends = state.data
        outflow = float(ends[-1].sum()) * problem.length * equation.dy
        yield Frame(then, u - repose, R.copy(), outflow)


def solve(
    problem: Problem,
    times: Sequence[float],
    cells: tuple[int, int],
    tolerance: float = TOLERANCE,
    threads: int = 1,
    stop: Callable[[Solution], bool] | None = None,
) -> Solution:
    """Solve BCRE on a plane up to the last of the ascending ``times`` and keep every frame.

    Parameters
    ----------
    problem, times, cells, tolerance, threads: see :func:`march`.
    stop: asked after every recorded time with a solution of the first and the latest frame; True
        ends the solve there.

    Raises
    ------
    SolveError, ValueError
        as :func:`march`.
    """
    account, frames = Account(), []
    for frame in march(problem, times, cells, tolerance, threads, account):
        frames.append(frame)
        if stop is not None and stop(_solution(problem, cells, [frames[0], frame], account)):
            break
    return _solution(problem, cells, frames, account)


def _solution(
    problem: Problem, cells: tuple[int, int], frames: list[Frame], account: Account
) -> Solution:
    (rows, columns) = cells
    return Solution(
        problem=problem,
        x=np.asarray(np.arange(rows) + 0.5) * (problem.length / rows),
        y=np.asarray(np.arange(columns) + 0.5) * (problem.width / columns),
        t=np.array([frame.t for frame in frames]),
        h=np.array([frame.h for frame in frames]),
        R=np.array([frame.R for frame in frames]),
        outflow=np.array([frame.outflow for frame in frames]),
        steps=account.steps,
        evaluations=account.evaluations,
        wall_s=account.wall_s,
    )


def _initial_state(problem: Problem, grid: CartesianGrid) -> FieldCollection:
    from bcre_pde.plane.equation import BCRE

    x, y = grid.cell_coords[..., 0], grid.cell_coords[..., 1]
    h, R = initial_layers(problem.initial(x, y), x.shape)
    foot = np.full((1, y.shape[1]), problem.length)
    h_foot, _ = initial_layers(problem.initial(foot, y[:1]), foot.shape)
    Sc = problem.material.Sc
    return BCRE.state(grid, h + Sc * x, R, h_foot[0] + Sc * problem.length)
