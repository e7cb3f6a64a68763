r"""Grids twice as fine, and as fine again, until a solution's own error is small enough.

The error of each measured quantity is that of :mod:`bcre_pde.convergence`, from the changes between
the last four grids. What the steps in time add is in the solution, its ``step_error``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from numpy.typing import ArrayLike

from bcre_pde.convergence import TRIPLES, changes, error_of_finest, jump_stands
from bcre_pde.failure import SolveError
from bcre_pde.gate import require_callable
from bcre_pde.problem import Problem, Solution
from bcre_pde.solve import solve

COARSEST = 50
LEAST_GRIDS = TRIPLES + 2

Allowed = Callable[[Sequence[Any]], Iterable[float]]


@dataclass(frozen=True, eq=False)
class Measured:
    """A measured quantity with its error; ``order`` and what follows where grids were refined.

    Parameters
    ----------
    value: a number, or a profile.
    error: absolute error, same unit; of a profile the mean absolute one.
    order: observed order of convergence.
    allowed: the error that was asked for.
    cells: the grids in turn.
    solution: on the finest of them.
    jump: whether a jump stands, past which no more than first order is believed.
    """

    value: Any
    error: float
    order: float = math.nan
    allowed: float = 0.0
    cells: tuple[int, ...] = ()
    solution: Any = None
    jump: bool = False

    @property
    def resolved(self) -> bool:
        """Whether the error is as small as was asked for."""
        return self.error <= self.allowed


def measure_refined(
    measure_on: Callable[[int], tuple[Any, Sequence[Any]]],
    grids: Iterable[int],
    allowed: Allowed | None = None,
) -> list[Measured]:
    """Measure quantities on ever finer grids, until the error of each is as small as allowed.

    Parameters
    ----------
    measure_on: function of a number of cells; returns a solution, and the quantities measured on
        it: numbers or profiles, as many on every grid.
    grids: numbers of cells, each twice the one before. At least three are needed for an error,
        which is infinite on fewer; before the last, refinement ends on the fourth at the earliest.
    allowed: function of the quantities on the finest grid so far; returns the error that is allowed
        for each. Left out, all grids are measured and a failure on one is an error.

    With ``allowed`` given, a grid on which the solver gives up ends the refinement; the first grid
    must be solved.
    """
    ladder = _Ladder()
    measured: list[Measured] = []
    for grid in grids:
        try:
            solution, values = measure_on(grid)
        except SolveError:
            if not ladder.cells or allowed is None:
                raise
            break
        ladder.add(grid, solution, values)
        measured = ladder.measured(allowed if len(ladder.cells) > 2 else None)
        enough = allowed is not None and len(ladder.cells) >= LEAST_GRIDS
        if enough and all(quantity.resolved for quantity in measured):
            break
    return measured


class _Ladder:
    """The grids so far, with what was measured on each."""

    def __init__(self) -> None:
        self.cells: list[int] = []
        self._history: list[Sequence[Any]] = []
        self._solution: Any = None
        self._jump = False

    def add(self, cells: int, solution: Any, values: Sequence[Any]) -> None:
        if isinstance(self._solution, Solution) and isinstance(solution, Solution):
            self._jump = jump_stands(self._solution, solution)
        self._solution = solution
        self.cells.append(cells)
        self._history.append(values)

    def measured(self, allowed: Allowed | None) -> list[Measured]:
        """The quantities on the finest grid with their errors."""
        values = self._history[-1]
        limits = [0.0] * len(values) if allowed is None else allowed(values)
        quantities = zip(*self._history[-LEAST_GRIDS:], strict=True)
        return [
            self._of(list(on_grids), float(limit))
            for on_grids, limit in zip(quantities, limits, strict=True)
        ]

    def _of(self, on_grids: list[Any], limit: float) -> Measured:
        order, error = error_of_finest(changes(on_grids), jump=self._jump)
        cells = tuple(self.cells)
        return Measured(on_grids[-1], error, order, limit, cells, self._solution, self._jump)


def solve_refined_each(
    problem: Problem,
    times: Sequence[float],
    measure: Callable[[Solution], Sequence[Any]],
    allowed: Allowed,
    coarsest: int = COARSEST,
    finest: int = 1600,
    **options: Any,
) -> list[Measured]:
    """Double the grid until the error of each of several measured quantities is small enough.

    Parameters
    ----------
    problem, times, options: as for :func:`bcre_pde.solve`.
    measure: what is wanted of a solution: numbers, or profiles at fixed positions.
    allowed: see :func:`measure_refined`; e.g. a tenth of the difference that is to be reported.
    coarsest, finest: smallest and largest number of cells; at least three grids are solved.
    """
    require_callable(measure=measure, allowed=allowed)

    def measure_on(cells: int) -> tuple[Solution, Sequence[Any]]:
        solution = solve(problem, times, cells, **options)
        return solution, measure(solution)

    return measure_refined(measure_on, _doubled(coarsest, finest), allowed)


def solve_refined(
    problem: Problem,
    times: Sequence[float],
    measure: Callable[[Solution], ArrayLike],
    allowed: Callable[[Any], float],
    coarsest: int = COARSEST,
    finest: int = 1600,
    **options: Any,
) -> Measured:
    """:func:`solve_refined_each` of a single quantity."""
    require_callable(measure=measure, allowed=allowed)
    (measured,) = solve_refined_each(
        problem,
        times,
        lambda solution: [measure(solution)],
        lambda values: [allowed(values[0])],
        coarsest,
        finest,
        **options,
    )
    return measured


def _doubled(coarsest: int, finest: int) -> Iterator[int]:
    """``coarsest`` doubled up to ``finest``, and at least three numbers."""
    cells, count = coarsest, 0
    while cells <= finest or count < 3:
        yield cells
        cells, count = 2 * cells, count + 1
