"""Solving a radially symmetric problem, recorded at given times."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

import numpy as np

from bcre_pde.gate import ascending, require_kind, require_tolerance, whole
from bcre_pde.plane.radial.problem import Problem, Solution, ring_means
from bcre_pde.problem import SMALLEST_GRID, Array
from bcre_pde.solve import MOST_EVALUATIONS, TOLERANCE


def solve(
    problem: Problem,
    times: Sequence[float],
    cells: int,
    tolerance: float = TOLERANCE,
    stop: Callable[[Solution], bool] | None = None,
) -> Solution:
    """Solve radially symmetric BCRE up to the last of the ascending ``times``.

    Parameters
    ----------
    problem: what to solve.
    times: when to record the layers; 0 records the start. py-pde is imported at the first call.
    cells: number N of rings, >= 8.
    tolerance: local error per step of py-pde's adaptive Runge-Kutta-Fehlberg solver, kept below the
        stable step; relative to the largest rolling layer.
    stop: asked after every recorded time with a solution of the first and the latest frame; True
        ends the solve there.

    Raises
    ------
    SolveError
        where the solver gave up; ValueError for arguments that are not allowed.
    """
    ordered = ascending(times)
    require_kind("problem", problem, Problem)
    require_tolerance(tolerance)
    cells = whole("cells", cells, SMALLEST_GRID)
    h, R = ring_means(problem.initial, problem.radius, cells)
    from pde import PolarSymGrid

    from bcre_pde.advance import advance
    from bcre_pde.plane.radial.equation import BCRE

    grid = PolarSymGrid(problem.radius, cells)
    closed = problem.rim == "closed"
    equation = BCRE(problem.material, grid, problem.turning, closed, MOST_EVALUATIONS)
    state = BCRE.state(grid, h, R)
    equation.pour(problem.source)
    equation.rate(np.array(state.data), np.zeros(state.data.shape))  # compiles, before the clock
    frames: list[tuple[float, Array]] = []
    steps, now, began = 0, 0.0, time.perf_counter()

    def solution(kept: list[tuple[float, Array]]) -> Solution:
        data = np.array([frame for _, frame in kept])
        disc = np.pi * problem.radius**2
        return Solution(
            problem=problem,
            r=np.asarray(grid.cell_coords[:, 0]),
            t=np.array([t for t, _ in kept]),
            h=data[:, 0],
            R=data[:, 1],
            supplied=data[:, 2, 0] * disc,
            outflow=data[:, 2, -1] * disc,
            steps=steps,
            evaluations=equation.evaluations,
            wall_s=time.perf_counter() - began,
        )

    ends = np.inf if problem.source is None else problem.source.until
    for then in ordered:
        while now < then:
            if now >= ends:
                equation.pour(None)
            until = ends if now < ends < then else then
            state, taken = advance(equation, state, (now, until), "runge-kutta", tolerance)
            steps, now = steps + taken, until
        frames.append((then, state.data.copy()))
        if stop is not None and stop(solution([frames[0], frames[-1]])):
            break
    return solution(frames)
