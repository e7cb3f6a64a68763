r"""Error of the finest of several grids, from the changes between them.

On grids each ``ratio`` r times finer than the one before, a quantity f changes by e_k = |f_k -
f_(k-1)|. Three grids give the observed order and the grid convergence index

    p_k = ln(e_(k-1)/e_k)/ln r        GCI = Fs e_k/(r^p_k - 1),   Fs = 1.25

(Roache 1994; Celik et al. 2008), as an absolute error here. One triple may pass by chance: e_k
vanishes where two grids err by the same amount. So :func:`error_of_finest` asks two triples in a
row, believes the lower of their orders, p, and takes the larger of the last two changes by it:

    error = Fs max(e_k, e_(k-1)/r^p)/(r^p - 1),   0.5 <= p <= 5

where Fs = 3, as for two grids alone (Roache 1994), unless both triples converge. Past a jump p is 1
at most and Fs = 3: a jump that is carried is smeared over ever less than one power of a cell, and
what stands beside it converges no faster (Banks, Aslam and Rider 2008).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from numbers import Real
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike

from bcre_pde.gate import is_finite
from bcre_pde.problem import Array

SAFETY, UNCONFIRMED_SAFETY = 1.25, 3.0
FORMAL_ORDER = 5.0
ORDER_AT_JUMP = 1.0
LEAST_ORDER = 0.5
"""Below this observed order the grids do not converge, and the larger change counts."""

TRIPLES = 2
"""Triples of grids in a row that have to agree."""

JUMP = 0.75
"""A jump: the largest fall from cell to cell stays by this part as the cells are halved."""

SEEN = 1e-3
"""Part of the range of a profile below which no fall is called a jump."""


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
    shapes = {np.shape(values) for values in (coarse, medium, fine)}
    if len(shapes) > 1:
        raise ValueError(f"fine, medium, coarse have the shapes {shapes}: must be of one")
    if not (is_finite(ratio) and ratio > 1):
        raise ValueError(f"ratio = {ratio!r}: must be a number > 1")
    before, last = changes([coarse, medium, fine])
    if last == 0:
        return GridConvergence(math.inf, 0.0)
    order = _order(before, last, ratio)
    clipped = min(max(order, LEAST_ORDER), FORMAL_ORDER)
    change = last if order >= LEAST_ORDER else max(last, before)
    return GridConvergence(order, SAFETY * change / (ratio**clipped - 1))


def changes(values: Sequence[ArrayLike]) -> list[float]:
    """Mean absolute changes of a number or profile from each grid to the next, coarsest first."""
    rows = [np.asarray(value, dtype=float) for value in values]
    return [float(np.mean(np.abs(b - a))) for a, b in itertools.pairwise(rows)]


def error_of_finest(
    changed: Sequence[float], *, jump: bool = False, ratio: float = 2.0
) -> GridConvergence:
    """Order of the last triple, and the error of the finest grid by the last two.

    Infinite, with an order of minus infinity, where there are less than three grids.

    Parameters
    ----------
    changed: changes from each grid to the next, coarsest first, >= 0.
    jump: whether a jump stands in the profile.
    ratio: refinement ratio, > 1.
    """
    if not all(isinstance(change, Real) for change in changed):
        raise ValueError(f"changed = {changed!r}: must be numbers")
    if len(changed) < 2:
        return GridConvergence(-math.inf, math.inf)
    last = list(changed[-TRIPLES - 1 :])
    orders = [_order(a, b, ratio) for a, b in itertools.pairwise(last)]
    highest = ORDER_AT_JUMP if jump else FORMAL_ORDER
    believed = min(max(min(orders), LEAST_ORDER), highest)
    confirmed = len(orders) == TRIPLES and min(orders) >= LEAST_ORDER and not jump
    change = max(last[-1], last[-2] / ratio**believed)
    safety = SAFETY if confirmed else UNCONFIRMED_SAFETY
    return GridConvergence(orders[-1], safety * change / (ratio**believed - 1))


def _order(before: float, last: float, ratio: float) -> float:
    """ln(before/last)/ln(ratio); infinite where the last change is none."""
    if last == 0:
        return math.inf
    return math.log(before / last) / math.log(ratio) if before > 0 else -math.inf


class Layers(Protocol):
    """u and R at times and cell centres, shape (T, N)."""

    @property
    def u(self) -> Array:
        """Height above the repose line."""

    @property
    def R(self) -> Array:
        """Rolling layer."""


def jump_stands(coarse: Layers, fine: Layers) -> bool:
    """Whether in some frame u or R falls or rises over one cell, whatever the cells: a jump.

    Only the frames of both are compared: either may have been stopped before the other.
    """
    both = slice(min(len(coarse.u), len(fine.u)))
    scale = SEEN * (np.ptp(fine.u[both], axis=1) + np.abs(fine.R[both]).max(axis=1))
    return any(
        bool(((ours > JUMP * theirs) & (ours > scale)).any())
        for theirs, ours in (
            (_steepest(coarse.u[both]), _steepest(fine.u[both])),
            (_steepest(coarse.R[both]), _steepest(fine.R[both])),
        )
    )


def _steepest(rows: Array) -> Array:
    return np.asarray(np.abs(np.diff(rows, axis=1)).max(axis=1))
