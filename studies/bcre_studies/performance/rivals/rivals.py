"""What the rivals of the automaton share: the problem they take and the state they return.

Every rival is a module with ``prepare(problem, until, cells, ...)``, which returns a function
without arguments that solves the problem from its start. The first call of that function is a
first use, everything included; later calls reuse what a careful user would keep.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bcre_pde import Problem

Array = NDArray[np.float64]


@dataclass(frozen=True)
class EndState:
    """h and R at the cell centres x, all of shape (N,), at the end; and what it took.

    ``evaluations`` counts right-hand sides, or linear systems where a step solves such.
    """

    x: Array
    h: Array
    R: Array
    steps: int
    evaluations: int


Solve = Callable[[], EndState]


def centres(problem: Problem, cells: int) -> Array:
    """Cell centres of ``cells`` equal cells on the problem's domain."""
    return np.asarray((np.arange(cells) + 0.5) * (problem.length / cells))


def start(problem: Problem, x: Array) -> tuple[Array, Array]:
    """h and R at the start, new arrays of shape (N,).

    Raises
    ------
    ValueError
        for thick flows, walls and sources, which no rival is written for.
    """
    if problem.ends == "wall" or problem.sources or problem.material.Gamma:
        raise ValueError("walls, sources and Gamma: must be absent, no rival has them")
    if math.isfinite(problem.material.v_up):
        raise ValueError(f"v_up = {problem.material.v_up!r}: must be infinite, the linear law")
    h, R = problem.initial(x)
    return np.array(h, dtype=float), np.array(R, dtype=float)


def start_above_repose(problem: Problem, x: Array) -> tuple[Array, Array]:
    """u = h + Sc x and R at the start, new arrays of shape (N,)."""
    h, R = start(problem, x)
    return h + problem.material.Sc * x, R


def whole_steps(until: float, dt: float) -> int:
    """Number of steps of dt to ``until``.

    Raises
    ------
    ValueError
        where it is not a whole number, as the rivals would end at different times.
    """
    steps = round(until / dt)
    if steps < 1 or abs(steps * dt - until) > 1e-9 * until:
        raise ValueError(f"dt = {dt!r}: must divide until = {until!r}")
    return steps
