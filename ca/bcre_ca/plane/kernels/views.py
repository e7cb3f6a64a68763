"""Reading arrays that may be absent, filling and copying rows.

Plain loops: an assignment between slices takes the compiler a hundred times longer.
"""

from __future__ import annotations

from typing import Any

import numba
from numba.extending import register_jitable


@register_jitable
def part(array: Any, row: int, lo: int, hi: int) -> Any:
    """A piece of a row."""
    if array is None:
        return None
    return array[row, lo:hi]


@register_jitable
def at(row: Any, j: int) -> Any:
    """An element of a piece."""
    if row is None:
        return None
    return row[j]


@numba.njit(error_model="numpy")
def fill(row, lo, hi, value):  # type: ignore[no-untyped-def]
    """``value`` into the elements [lo, hi)."""
    for j in range(lo, hi):
        row[j] = value


@numba.njit(error_model="numpy")
def copy(row, to):  # type: ignore[no-untyped-def]
    """All elements of a row into another one."""
    for j in range(row.size):
        to[j] = row[j]
