"""Reading arrays that may be absent, filling and copying rows.

Absence is seen by the type, so that the compiler leaves out what is absent. Filling and copying are
plain loops: an assignment between slices takes the compiler a hundred times longer.
"""

from __future__ import annotations

from typing import Any

from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, overload

from bcre_ca.inner import inner


def part(array: Any, row: int, lo: int, hi: int) -> Any:
    """A piece of a row."""
    return None if array is None else array[row, lo:hi]


@overload(part)
def _part(array, row, lo, hi):
    if isinstance(array, types.NoneType):
        return lambda array, row, lo, hi: None
    return lambda array, row, lo, hi: array[row, lo:hi]


def at(row: Any, j: int) -> Any:
    """An element of a piece."""
    return None if row is None else row[j]


@overload(at)
def _at(row, j):
    if isinstance(row, types.NoneType):
        return lambda row, j: None
    return lambda row, j: row[j]


@inner
def fill(row, lo, hi, value):
    """``value`` into the elements [lo, hi)."""
    for j in range(lo, hi):
        row[j] = value


@inner
def copy(row, to):
    """All elements of a row into another one."""
    for j in range(row.size):
        to[j] = row[j]


@intrinsic
def _without_owner(typing, array):
    def body(context, builder, signature, arguments):
        copy = context.make_array(array)(context, builder, value=arguments[0])
        copy.meminfo = cgutils.get_null_value(copy.meminfo.type)
        copy.parent = cgutils.get_null_value(copy.parent.type)
        return copy._getvalue()

    return array(array), body


def borrowed(array: Any) -> Any:
    """The array without its count of references, which threads would fight over at every row; the
    caller keeps it alive."""
    return array


@overload(borrowed)
def _borrowed(array):
    if isinstance(array, types.NoneType):
        return lambda array: None
    return lambda array: _without_owner(array)
