"""Many steps together, where it is wet, in one thread or several.

Several steps follow each other down the rows, each as many rows behind the one before as a step
reads, so that memory is passed over once for all of them. For several threads the rows are cut into
slabs. Near a cut, step t leaves out a wedge of rows that widens with t, so that no slab reads what
another one changes; the wedges are made up afterwards. For that the rows beside each step's part of
a wedge are kept as that step found them, and put back while it is taken.

Every function changes the layers in place; all equal the plain step to the bit, however the rows
are cut and however many steps are taken together. ``heights`` holds what each source pours into a
cell, a row a step.
"""

from __future__ import annotations

from bcre_ca.inner import inner
from bcre_ca.plane.coefficients import Facets, Split4, Tilted, by_flow
from bcre_ca.plane.kernels import facets, split4, tilted
from bcre_ca.plane.kernels.edges import join, mirror
from bcre_ca.plane.kernels.storage import COLUMNS, OPEN, PERIODIC, ROWS, Field
from bcre_ca.plane.kernels.views import borrowed, copy, fill
from bcre_ca.plane.kernels.windows import cut, look, widen
from bcre_ca.plane.kernels.work import Work
from bcre_ca.plane.sources import Cells
from bcre_ca.sums import add

_begin = by_flow({Tilted: tilted.begin, Split4: split4.begin, Facets: facets.begin})
_take = by_flow({Tilted: tilted.take, Split4: split4.take, Facets: facets.take})

WHOLE, BEGIN, SLAB, WEDGE, END = range(5)


@inner
def _is_positive(heights):
    for t in range(heights.shape[0]):
        for source in range(heights.shape[1]):
            if heights[t, source] > 0:
                return True
    return False


@inner
def _begin_steps(f, cells, heights, w, most):
    """Make ready for so many steps: what lies beyond the ends, the windows, ``most`` slabs."""
    if f.ends == PERIODIC:
        join(f)
    top, foot = widen(f, w.wet, cells, _is_positive(heights), len(heights), w.windows)
    return cut(w.windows, top, foot, most, 2 * w.reach * (len(heights) + 2), w.cuts)


@inner
def _row(f, K, cells, heights, windows, carry, sums, i, is_first):
    """One step of row i: the rule, what is poured, and what lies beyond its ends."""
    lo, hi = windows[0, i] + COLUMNS, windows[1, i] + COLUMNS
    if lo >= hi:
        return
    if is_first:
        _begin(f, carry, i, lo, hi, K, K.flow)
    _take(f, carry, i, lo, hi, K, K.flow)
    if i == f.N - 1 and f.ends == OPEN:
        for j in range(lo, hi):
            add(sums, carry[0, j])
    for cell in range(cells.first[i], cells.first[i + 1]):
        f.R[i + ROWS, cells.column[cell] + COLUMNS] += heights[cells.source[cell]]
    mirror(f, i, K.foot_drop)


@inner
def _clear(carry):
    for t in range(carry.shape[0]):
        for k in range(carry.shape[1]):
            fill(carry[t, k], 0, carry.shape[2], 0)


@inner
def _keep(f, i, kept, place):
    copy(f.h[i + ROWS], kept[0, place])
    copy(f.R[i + ROWS], kept[1, place])


@inner
def _slab(s, f, K, cells, heights, w):
    """The rows of slab s but for the wedges at its cuts, through so many steps."""
    top, foot, steps, reach = w.cuts[s], w.cuts[s + 1], len(heights), w.reach
    is_cut_above, is_cut_below = s > 0, s < w.cuts[-1] - 1
    carry = w.carry[s]
    _clear(carry)
    for place in range(top, foot + reach * (steps - 1)):
        for t in range(steps):
            i = place - reach * t
            first = top + reach * (t + 1) if is_cut_above else top
            last = foot - reach * (t + 1) if is_cut_below else foot
            if first <= i < last:
                if is_cut_above and i < first + reach:
                    _keep(f, i, w.kept[s - 1, 1], i - (top + reach))
                if is_cut_below and i >= last - reach:
                    _keep(f, i, w.kept[s, 0], foot - reach - 1 - i)
                _row(f, K, cells, heights[t], w.windows, carry[t], w.sums[s], i, i == first)


@inner
def _swap(f, i, kept, place):
    for j in range(f.h.shape[1]):
        f.h[i + ROWS, j], kept[0, place, j] = kept[0, place, j], f.h[i + ROWS, j]
        f.R[i + ROWS, j], kept[1, place, j] = kept[1, place, j], f.R[i + ROWS, j]


@inner
def _swap_beside(f, middle, half, kept, t, reach):
    """Exchange the rows beside the part of a wedge that step t takes with those that are kept."""
    for k in range(reach):
        _swap(f, middle - half - 1 - k, kept[0], reach * t + k)
        _swap(f, middle + half + k, kept[1], reach * t + k)


@inner
def _wedge(s, f, K, cells, heights, w):
    """The rows about the cut below slab s that the slabs above and below it have left out."""
    middle, carry = w.cuts[s + 1], w.carry[s]
    _clear(carry)
    for t in range(len(heights)):
        half = w.reach * (t + 1)
        _swap_beside(f, middle, half, w.kept[s], t, w.reach)
        first = middle - half
        for i in range(first, middle + half):
            _row(f, K, cells, heights[t], w.windows, carry[t], w.sums[s], i, i == first)
        _swap_beside(f, middle, half, w.kept[s], t, w.reach)


@inner
def _borrowed_field(f):
    layers = borrowed(f.h), borrowed(f.R), borrowed(f.free), borrowed(f.base)
    return Field(layers[0], layers[1], layers[2], layers[3], f.N, f.M, f.ends, f.sides, f.fall)


@inner
def _borrowed_cells(cells):
    return Cells(
        borrowed(cells.first),
        borrowed(cells.column),
        borrowed(cells.source),
        borrowed(cells.height),
    )


@inner
def _borrowed_work(w):
    return Work(
        borrowed(w.wet),
        borrowed(w.windows),
        borrowed(w.cuts),
        borrowed(w.carry),
        borrowed(w.kept),
        borrowed(w.sums),
        w.reach,
        w.together,
    )


def take_steps(part, s, f, K, cells, heights, w):
    """All steps as a WHOLE (s = 0), or a part of those together, which several threads share out.

    BEGIN returns the number of slabs, of which SLAB takes one; then WEDGE makes up for what is left
    out at the cut below slab s, and END looks where it is wet now. Compiled by
    :func:`bcre_ca.kept.kept`.
    """
    f, cells, w = _borrowed_field(f), _borrowed_cells(cells), _borrowed_work(w)
    if part == WHOLE:
        for done in range(0, len(heights), w.together):
            some = heights[done : done + w.together]
            if _begin_steps(f, cells, some, w, s + 1) > 0:
                _slab(s, f, K, cells, some, w)
                look(f, w.windows, w.cuts[0], w.cuts[1], w.wet)
            elif heights.shape[1] == 0:
                break
    elif part == BEGIN:
        _begin_steps(f, cells, heights, w, len(w.carry))
    elif part == SLAB:
        _slab(s, f, K, cells, heights, w)
    elif part == WEDGE:
        _wedge(s, f, K, cells, heights, w)
    else:
        look(f, w.windows, w.cuts[0], w.cuts[w.cuts[-1]], w.wet)
    return w.cuts[-1]
