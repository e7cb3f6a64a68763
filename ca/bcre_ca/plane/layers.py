"""The sand on a plane, and what is asked of its layers wherever they enter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from bcre_ca.gate import DENORMAL, numbers_of, require, require_kind
from bcre_ca.plane.setting import Plane

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Sand:
    """The automaton's state: layers h and R of shape (N, M), time, and the history of mass.

    ``inflow`` is the volume that the sources have poured and ``outflow`` what has left through the
    foot, so that ``volume(plane) + outflow - inflow`` does not change. ``steps`` counts those
    taken; ``lowered`` and ``raised`` how often a step that follows its bounds became shorter or
    longer, ``redone`` how often a block of steps was taken back and repeated in shorter ones.
    """

    h: Array
    R: Array
    t: float = 0.0
    inflow: float = 0.0
    outflow: float = 0.0
    steps: int = 0
    lowered: int = 0
    raised: int = 0
    redone: int = 0

    def volume(self, plane: Plane) -> float:
        """Volume of the sand, d^2 sum(h + R) over the cells that hold any."""
        free = plane.free(self.h.shape)
        total = self.h.sum(where=free, dtype=float) + self.R.sum(where=free, dtype=float)
        return plane.rule.d**2 * float(total)


def checked(h: Any, R: Any, plane: Plane) -> tuple[Array, Array]:
    """New layers, contiguous and of one number type.

    Raises
    ------
    ValueError
        naming the layer, what it is and what is allowed; and the cell (i, j), where it is one.
    """
    require_kind("plane", plane, Plane)
    h, R = (_layer(name, layer) for name, layer in (("h", h), ("R", R)))
    if h.shape != R.shape:
        raise ValueError(f"R has the shape {R.shape}: must be that of h, {h.shape}")
    if h.dtype != R.dtype:
        raise ValueError(f"R has the type {R.dtype}: must be that of h, {h.dtype}")
    for name in ("walls", "base"):
        shape = np.shape(getattr(plane, name))
        if shape not in ((), h.shape):
            raise ValueError(f"{name} has the shape {shape}: must be that of h, {h.shape}")
    free = plane.free(h.shape)
    require("R", R, R >= -DENORMAL, "must be >= 0")
    require("R", R, (R == 0) | free, "must be 0 at a wall")
    if plane.base is not None:
        lowest = base_of(plane, h.shape, h.dtype)
        require("h", h, (h >= lowest) | ~free, "must not lie below the base")
    # Adding 0 makes -0.0 to 0.0, which a cell that stays dry would otherwise keep.
    return h + h.dtype.type(0), R + R.dtype.type(0)


def base_of(plane: Plane, shape: tuple[int, ...], dtype: DTypeLike) -> Array:
    """The rigid ground under each cell, minus infinity where there is none."""
    lowest = -np.inf if plane.base is None else np.asarray(plane.base)
    return np.broadcast_to(lowest, shape).astype(dtype)


def _layer(name: str, values: Any) -> Array:
    array = numbers_of(name, values)
    if array.dtype not in (np.float64, np.float32):
        raise ValueError(f"{name} has the type {array.dtype}: must be float64 or float32")
    if array.ndim != 2 or not array.size:
        raise ValueError(f"{name} has the shape {array.shape}: must be (N, M) with N, M >= 1")
    require(name, array, np.isfinite(array), "must be finite")
    return np.ascontiguousarray(array)
