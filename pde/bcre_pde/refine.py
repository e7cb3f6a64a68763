r"""How wrong a solution is: grid refinement and the grid convergence index.

On three grids, each ``ratio`` times finer than the one before, a measured quantity f gives the
observed order p = ln(|f3 - f2|/|f2 - f1|)/ln(ratio) and the error estimate of the finest

    GCI = Fs |f2 - f1|/(ratio^p - 1),   Fs = 1.25

(Roache 1994; Celik et al. 2008), as an absolute error here.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bcre_pde.failure import SolveError
from bcre_pde.solve import Problem, Solution, solve

Array = NDArray[np.float64]

SAFETY = 1.25
FORMAL_ORDER = 5.0
LEAST_ORDER = 0.5
"""Below this observed order the grids do not converge; the larger change is then what counts."""


class GridConvergence(NamedTuple):
    """Observed order (not limited) and the error estimate of the finest grid, absolute."""

    order: float
    error: float


def grid_convergence_index(
    fine: ArrayLike, medium: ArrayLike, coarse: ArrayLike, ratio: float = 2.0
) -> GridConvergence:
    """Grid convergence index of a number, or of a profile in the mean absolute value.

    The order that enters the estimate is the observed one, limited to 0.5 <= p <= 5: above, it
    would promise more than the scheme can give, below, the grids are not converging.

    Parameters
    ----------
    fine, medium, coarse: the quantity on the three grids, numbers or arrays of one shape.
    ratio: refinement ratio, > 1.
    """
    values = [np.asarray(value, dtype=float) for value in (fine, medium, coarse)]
    last = float(np.mean(np.abs(values[1] - values[0])))
    before = float(np.mean(np.abs(values[2] - values[1])))
    if last == 0:
        return GridConvergence(math.inf, 0.0)
    order = math.log(before / last) / math.log(ratio) if before > 0 else -math.inf
    limited = min(max(order, LEAST_ORDER), FORMAL_ORDER)
    change = last if order >= LEAST_ORDER else max(last, before)
    return GridConvergence(order, SAFETY * change / (ratio**limited - 1))


@dataclass(frozen=True)
class Refined:
    """The finest solution of a refinement, what was measured on it, and how sure that is.

    ``error`` is the grid convergence index in the measured unit (mean absolute value where the
    measure is a profile), ``allowed`` what was asked for, ``cells`` the grids in turn.
    """

    solution: Solution
    measured: Any
    cells: tuple[int, ...]
    order: float
    error: float
    allowed: float

    @property
    def resolved(self) -> bool:
        """Whether the error is as small as was asked for."""
        return self.error <= self.allowed


def solve_refined(
    problem: Problem,
    times: Sequence[float],
    measure: Callable[[Solution], ArrayLike],
    allowed: Callable[[Any], float],
    coarsest: int = 100,
    finest: int = 1600,
    **options: Any,
) -> Refined:
    """Double the grid until the error of what is measured is as small as allowed.

    Parameters
    ----------
    problem, times, options: as for :func:`bcre_pde.solve`.
    measure: what is wanted of a solution: a number, or a profile at fixed positions.
    allowed: the error allowed for a measured value, same unit, e.g. a tenth of the difference
        that is to be reported.
    coarsest, finest: smallest and largest number of cells; at least three grids are solved.

    A grid on which the solver gives up counts as the finest that can be had.
    """
    history: list[tuple[int, Solution, Any]] = []
    cells = coarsest
    order, error, limit = -math.inf, math.inf, 0.0
    while cells <= finest or len(history) < 3:
        try:
            solution = solve(problem, times, cells, **options)
        except SolveError:
            if not history:
                raise
            break
        history.append((cells, solution, measure(solution)))
        cells *= 2
        if len(history) >= 3:
            coarse, medium, fine = (value for _, _, value in history[-3:])
            order, error = grid_convergence_index(fine, medium, coarse)
            limit = allowed(fine)
            if error <= limit:
                break
    _, solution, measured = history[-1]
    return Refined(solution, measured, tuple(n for n, _, _ in history), order, error, limit)
