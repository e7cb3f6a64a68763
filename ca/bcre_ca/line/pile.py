"""The automaton's state on a line, and what makes a valid start."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bcre_ca.rule import Ends

Array = NDArray[np.float64]

DENORMAL = 1e-300
"""Below this the sign of a layer is decided by rounding among denormal numbers."""


@dataclass(frozen=True)
class Pile:
    """The automaton's state: layers h and R of shape (N,), time, and what happened on the way.

    ``outflow`` is the area that has left through the foot: ``d sum(h + R) + outflow`` does not
    change. ``steps`` counts the steps taken. ``lowered`` and ``raised`` count how often a step that
    follows its bounds became shorter or longer, ``redone`` how often a block of steps was repeated
    in shorter ones.
    """

    h: Array
    R: Array
    t: float = 0.0
    outflow: float = 0.0
    steps: int = 0
    lowered: int = 0
    raised: int = 0
    redone: int = 0

    def mass(self, d: float) -> float:
        """Area of sand in the pile, d sum(h + R)."""
        return d * (math.fsum(self.h) + math.fsum(self.R))


def whole(steps: Any) -> int:
    """The number of steps; ValueError where it is none."""
    if isinstance(steps, bool) or steps != int(steps) or steps < 0:
        raise ValueError(f"steps = {steps!r}: must be a whole number >= 0")
    return int(steps)


def require_ends(ends: str) -> None:
    """Raise ValueError for unknown ends."""
    if ends not in get_args(Ends):
        raise ValueError(f"ends = {ends!r}: must be one of {get_args(Ends)}")


def layers_of(h: ArrayLike, R: ArrayLike, rank: int) -> tuple[Array, Array]:
    """New arrays of the layers; ValueError where they make no pile, or no batch for ``rank`` 2."""
    both_single = all(getattr(layer, "dtype", None) == np.float32 for layer in (h, R))
    dtype: Any = np.float32 if both_single else float
    static, rolling = np.array(h, dtype=dtype, order="C"), np.array(R, dtype=dtype, order="C")
    if rank == 1 and static.ndim == 2:
        raise ValueError(
            f"h has shape {static.shape}: evolve takes one line of cells; evolve_many takes many "
            "piles, (piles, N), but a plane is not a batch of lines"
        )
    if static.ndim != rank or static.shape != rolling.shape or not static.size:
        shape = "(N,)" if rank == 1 else "(piles, N)"
        raise ValueError(
            f"h has shape {static.shape}, R {rolling.shape}: must be equal, {shape} with N >= 1"
        )
    if not (np.isfinite(static).all() and np.isfinite(rolling).all()):
        raise ValueError("h and R must be finite")
    if rolling.min() < -DENORMAL:
        raise ValueError(f"R = {float(rolling.min())!r}: must be >= 0")
    return static, rolling
