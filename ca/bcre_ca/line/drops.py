"""Drops between neighbouring cells, and how they go on beyond either end of the line."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bcre_ca.rule import Ends, Rule

Array = NDArray[np.float64]


def period_drop(rule: Rule, cells: int, ends: Ends) -> float | None:
    """Fall of the repose line over one period, Sc N d; None where the ends are not joined.

    Periodic ends join h up to this fall.
    """
    return rule.Sc * rule.d * cells if ends == "periodic" else None


def drops(h: Array, repose_drop: float, period_drop: float | None) -> tuple[Array, Array]:
    """Drop beyond repose from the cell above into each cell, and from it into the one below.

    Above a closed top the surface goes on evenly, beyond an open foot at repose.
    """
    beyond = h[-1] - repose_drop if period_drop is None else h[0] - period_drop
    below = (h - np.append(h[1:], beyond)) - repose_drop
    if period_drop is None:
        below[-1] = 0.0
        return np.append(below[0], below[:-1]), below
    return np.append(below[-1], below[:-1]), below
