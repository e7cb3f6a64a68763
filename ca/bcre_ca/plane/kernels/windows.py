"""Where it is wet: the columns of each row in which the next steps can read or change anything.

A row's wet cells lie between its first and its last one, ``wet[0, i]`` and ``wet[1, i]`` (one past
it), and a step wets neighbours at most; so a row's window is the widest of its neighbours', widened
by as many cells as there are steps, and :data:`SEES` more, so that what is carried from row to
row is 0 where their windows differ.
"""

from __future__ import annotations

from bcre_ca.inner import inner
from bcre_ca.plane.kernels.storage import COLUMNS, PERIODIC, ROWS

SEES = 4

ALIGNED = 8
"""Windows begin and end at whole groups of so many columns, which a processor takes at once."""


@inner
def widen(f, wet, cells, is_pouring, steps, windows):
    """The windows of the next steps; the first row with one, and the row after the last."""
    by = steps + SEES
    for i in range(f.N):
        windows[0, i], windows[1, i] = f.M, 0
    for i in range(f.N):
        lo, hi = wet[0, i], wet[1, i]
        if is_pouring:
            for cell in range(cells.first[i], cells.first[i + 1]):
                lo, hi = min(lo, cells.column[cell]), max(hi, cells.column[cell] + 1)
        if lo < hi:
            _stretch(f, windows, i, lo - by, hi + by, by)
    top, foot = f.N, 0
    for i in range(f.N):
        lo, hi = windows[0, i], windows[1, i]
        if lo < hi:
            top, foot = min(top, i), i + 1
            if f.sides == PERIODIC and (lo < 0 or hi > f.M):
                lo, hi = 0, f.M
            windows[0, i] = max(lo, 0) // ALIGNED * ALIGNED
            windows[1, i] = min((hi + ALIGNED - 1) // ALIGNED * ALIGNED, f.M)
    return top, foot


@inner
def _stretch(f, windows, i, lo, hi, by):
    first, last = i - by, i + by + 1
    if f.ends == PERIODIC and (first < 0 or last > f.N):
        first, last = 0, f.N
    for k in range(max(first, 0), min(last, f.N)):
        windows[0, k] = min(windows[0, k], lo)
        windows[1, k] = max(windows[1, k], hi)


@inner
def look(f, windows, top, foot, wet):
    """The wet cells of the rows [top, foot), all within their windows."""
    for i in range(top, foot):
        R, lo, hi = f.R[i + ROWS, COLUMNS:], windows[0, i], windows[1, i]
        while lo < hi and R[lo] == 0:
            lo += 1
        while hi > lo and R[hi - 1] == 0:
            hi -= 1
        wet[0, i], wet[1, i] = (lo, hi) if lo < hi else (f.M, 0)


@inner
def cut(windows, top, foot, slabs, least, cuts):
    """Cut the rows [top, foot) into slabs of like area, none of fewer rows than ``least``.

    Returns how many there are; ``cuts`` holds the rows at which they begin and the last one ends,
    and in its last place their number.
    """
    cuts[-1] = 0
    if top >= foot:
        return 0
    area = 0
    for i in range(top, foot):
        area += max(windows[1, i] - windows[0, i], 0)
    number, passed = 0, 0
    cuts[0] = top
    for i in range(top, foot):
        share = area * (number + 1) // slabs
        if passed >= share and i - cuts[number] >= least and foot - i >= least:
            number += 1
            cuts[number] = i
        passed += max(windows[1, i] - windows[0, i], 0)
    cuts[number + 1], cuts[-1] = foot, number + 1
    return number + 1
