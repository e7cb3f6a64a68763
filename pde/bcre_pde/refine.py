r"""How wrong a solution is: grid refinement and the grid convergence index.

On three grids, each ``ratio`` times finer than the one before, a measured quantity f gives the
observed order p = ln(|f3 - f2|/|f2 - f1|)/ln(ratio) and the error estimate of the finest

    GCI = Fs |f2 - f1|/(ratio^p - 1),   Fs = 1.25

(Roache 1994; Celik et al. 2008), as an absolute error here.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from bcre_pde.failure import SolveError
from bcre_pde.problem import Problem, Solution
from bcre_pde.solve import solve

SAFETY = 1.25
FORMAL_ORDER = 5.0
LEAST_ORDER = 0.5
"""Below this observed order the grids do not converge, and the larger change counts."""


class GridConvergence(NamedTuple):
    """The order as observed, and the error estimate of the finest grid, absolute."""

    order: float
    error: float


def grid_convergence_index(
    fine: ArrayLike, medium: ArrayLike, coarse: ArrayLike, ratio: float = 2.0
) -> GridConvergence:
    """Grid convergence index of a number, or of a profile in the mean absolute value.

    The order that enters the estimate is the observed one, clipped to 0.5 <= p <= 5. A higher one
    would promise more than the scheme can give; below, the grids are not converging.

    Parameters
    ----------
    fine, medium, coarse: the quantity on the three grids, numbers or arrays of one shape.
    ratio: refinement ratio, > 1.

    >>> found = grid_convergence_index(fine=1.01, medium=1.04, coarse=1.16)
    >>> round(found.order, 6), round(found.error, 6)
    (2.0, 0.0125)
    """
    values = [np.asarray(value, dtype=float) for value in (fine, medium, coarse)]
    last = float(np.mean(np.abs(values[1] - values[0])))
    before = float(np.mean(np.abs(values[2] - values[1])))
    if last == 0:
        return GridConvergence(math.inf, 0.0)
    order = math.log(before / last) / math.log(ratio) if before > 0 else -math.inf
    clipped = min(max(order, LEAST_ORDER), FORMAL_ORDER)
    change = last if order >= LEAST_ORDER else max(last, before)
    return GridConvergence(order, SAFETY * change / (ratio**clipped - 1))


@dataclass(frozen=True)
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
    """

    value: Any
    error: float
    order: float = math.nan
    allowed: float = 0.0
    cells: tuple[int, ...] = ()
    solution: Any = None

    @property
    def resolved(self) -> bool:
        """Whether the error is as small as was asked for."""
        return self.error <= self.allowed


def measure_refined(
    measure_on: Callable[[int], tuple[Any, Sequence[Any]]],
    grids: Iterable[int],
    allowed: Callable[[Sequence[Any]], Iterable[float]] | None = None,
) -> list[Measured]:
    """Measure quantities on ever finer grids, until the error of each is as small as allowed.

    Parameters
    ----------
    measure_on: function of a number of cells; returns a solution, and the quantities measured on
        it: numbers or profiles, as many on every grid.
    grids: numbers of cells, each twice the one before; at least three are needed for an error,
        which is infinite on fewer.
    allowed: function of the quantities on the finest grid so far; returns the error that is allowed
        for each. Left out, all grids are measured and a failure on one is an error.

    With ``allowed`` given, a grid on which the solver gives up ends the refinement; the first grid
    must be solved.
    """
    cells: list[int] = []
    history: list[Sequence[Any]] = []
    solution: Any = None
    measured: list[Measured] = []
    for grid in grids:
        try:
            solution, values = measure_on(grid)
        except SolveError:
            if not history or allowed is None:
                raise
            break
        cells.append(grid)
        history.append(values)
        limits: Iterable[float] = [0.0] * len(values)
        indices = [GridConvergence(-math.inf, math.inf)] * len(values)
        if len(history) >= 3:
            triples = zip(*history[:-4:-1], strict=True)
            indices = [grid_convergence_index(*triple) for triple in triples]
            if allowed is not None:
                limits = allowed(values)
        measured = [
            Measured(value, index.error, index.order, float(limit), tuple(cells), solution)
            for value, index, limit in zip(values, indices, limits, strict=True)
        ]
        if allowed is not None and all(quantity.resolved for quantity in measured):
            break
    return measured


def solve_refined_each(
    problem: Problem,
    times: Sequence[float],
    measure: Callable[[Solution], Sequence[Any]],
    allowed: Callable[[Sequence[Any]], Iterable[float]],
    coarsest: int = 100,
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

    def measure_on(cells: int) -> tuple[Solution, Sequence[Any]]:
        solution = solve(problem, times, cells, **options)
        return solution, measure(solution)

    return measure_refined(measure_on, _doubled(coarsest, finest), allowed)


def solve_refined(
    problem: Problem,
    times: Sequence[float],
    measure: Callable[[Solution], ArrayLike],
    allowed: Callable[[Any], float],
    coarsest: int = 100,
    finest: int = 1600,
    **options: Any,
) -> Measured:
    """:func:`solve_refined_each` of a single quantity."""
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
