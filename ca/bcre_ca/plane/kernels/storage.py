"""The layers as compiled code holds them: with cells all round for what lies beyond the ends.

A row begins at a cache line and is an odd number of lines long, so that cells below each other do
not compete for one place in the cache.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import DTypeLike, NDArray

from bcre_ca.plane.layers import base_of
from bcre_ca.plane.setting import Plane

Array = NDArray[np.float64]

ROWS, COLUMNS = 1, 16
"""Cells beyond each end and each side; so many columns that row and column 0 begin a line."""

LINE = 64

CLOSED, OPEN, PERIODIC = 0, 1, 2


class Field(NamedTuple):
    """Layers of N rows and M columns, cell (i, j) at [i + ROWS, j + COLUMNS].

    ``free`` (1 where a cell can hold sand, 0 at a wall) and ``base`` are None on a tilted plane
    without walls and base, which gains by it; a free surface is compiled once, with both.
    ``ends`` and ``sides`` are CLOSED, OPEN or PERIODIC.
    """

    h: Array
    R: Array
    free: Array | None
    base: Array | None
    N: int
    M: int
    ends: int
    sides: int
    fall: float


def stored(h: Array, R: Array, plane: Plane) -> Field:
    """Copies of the layers with all that is beyond their ends."""
    N, M = h.shape
    free, base = None, None
    if plane.flow != "tilted" or plane.walls is not None or plane.base is not None:
        free = _padded(plane.free(h.shape), plane, h.dtype)
        base = _padded(base_of(plane, h.shape, h.dtype), plane, h.dtype)
    codes = {"closed": CLOSED, "open": OPEN, "periodic": PERIODIC}
    fall = h.dtype.type(plane.fall_of(N))
    ends, sides = codes[plane.ends], codes[plane.sides]
    surface, rolling = _padded(h, plane, h.dtype), _padded(R, plane, h.dtype)
    if plane.ends == "open":
        surface[N + ROWS] -= plane.coefficients(h.dtype).foot_drop
    return Field(surface, rolling, free, base, N, M, ends, sides, fall)


def inside(layer: Array, field: Field) -> Array:
    """The N x M cells of a stored layer, as a view to look at."""
    view = layer[ROWS : ROWS + field.N, COLUMNS : COLUMNS + field.M]
    view.flags.writeable = False
    return view


def _padded(layer: Any, plane: Plane, dtype: DTypeLike) -> Array:
    along = "wrap" if plane.ends == "periodic" else "edge"
    across = "wrap" if plane.sides == "periodic" else "edge"
    rows = np.pad(layer, ((ROWS, ROWS), (0, 0)), mode=along)  # type: ignore[call-overload]
    padded = np.pad(rows, ((0, 0), (1, 1)), mode=across)  # type: ignore[call-overload]
    cells = aligned(len(padded), layer.shape[1] + 2 * COLUMNS, dtype)
    cells[:, COLUMNS - 1 : COLUMNS + layer.shape[1] + 1] = padded
    return cells


def rows_like(layer: Array, *shape: int) -> Array:
    """Rows of zeros as long as those of a stored layer, of shape (*shape, length)."""
    return aligned(math.prod(shape), layer.shape[1], layer.dtype).reshape(*shape, -1)


def aligned(rows: int, columns: int, dtype: DTypeLike) -> Array:
    """Zeros of at least so many columns, each row beginning at a cache line."""
    size = np.dtype(dtype).itemsize
    lines = -(-columns * size // LINE) | 1
    memory = np.zeros((rows * lines + 1) * LINE, np.uint8)
    start = -memory.ctypes.data % LINE
    return memory[start : start + rows * lines * LINE].view(dtype).reshape(rows, -1)
