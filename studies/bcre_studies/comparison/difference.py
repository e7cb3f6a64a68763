"""How far apart two numbers or profiles are."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike


def size(value: ArrayLike) -> float:
    """mean|value|: of a profile the area under it, divided by its length."""
    return float(np.mean(np.abs(value)))


def difference(one: ArrayLike, other: ArrayLike) -> float:
    """mean|one - other|: of profiles the L1 difference, divided by their length."""
    return size(np.asarray(one) - np.asarray(other))


def relative_difference(automaton: ArrayLike, pde: ArrayLike, scale: float | None = None) -> float:
    """mean|automaton - pde| / mean|pde|: for profiles the relative L1 difference.

    Numbers that may vanish are compared relative to ``scale`` instead.
    """
    whole = size(pde) if scale is None else scale
    gap = difference(automaton, pde)
    return gap / whole if whole > 0 else (0.0 if gap == 0 else math.inf)
