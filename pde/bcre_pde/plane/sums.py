"""The sums of Runge-Kutta stages on a plane: row by row, so that they stay in fast memory."""

from __future__ import annotations

import numba

from bcre_pde.inner import inner
from bcre_pde.kept import kept


@inner
def _sum_of_row(start, terms, field, i, weights, count, dt, out):
    sum_, first = out[field, i], start[field, i]
    for j in range(sum_.size):
        sum_[j] = first[j]
    for k in range(count):
        term, weight = terms[k, field, i], weights[k]
        if k == count - 1:
            for j in range(sum_.size):
                term[j] *= dt
        if weight != 0.0:
            for j in range(sum_.size):
                sum_[j] += weight * term[j]


@inner
def _sum_of_rows(start, terms, weights, count, dt, out, first, last):
    """The third field's rows between its first and last are zero and stay so."""
    rows = out.shape[1]
    for i in range(first, last):
        _sum_of_row(start, terms, 0, i, weights, count, dt, out)
        _sum_of_row(start, terms, 1, i, weights, count, dt, out)
        if i in (0, rows - 1):
            _sum_of_row(start, terms, 2, i, weights, count, dt, out)


@kept()
def weighted_sum(start, terms, weights, count, dt, out):
    """What :func:`bcre_pde.sums.weighted_sum` does, for fields of shape (3, rows, columns)."""
    _sum_of_rows(start, terms, weights, count, dt, out, 0, out.shape[1])


@kept(parallel=True)
def weighted_sum_on_threads(start, terms, weights, count, dt, out, threads):
    """The same numbers on at most ``threads`` threads."""
    rows = out.shape[1]
    for block in numba.prange(threads):
        first, last = block * rows // threads, (block + 1) * rows // threads
        _sum_of_rows(start, terms, weights, count, dt, out, first, last)
