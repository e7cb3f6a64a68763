"""The sums of Runge-Kutta stages, without allocation."""

from __future__ import annotations

import numba


@numba.njit(cache=True, error_model="numpy")
def weighted_sum(start, terms, weights, count, dt, out):  # type: ignore[no-untyped-def]
    """out = start + sum of the first ``count`` weights times terms, but for weights of zero.

    The last of the terms arrives as a rate and is multiplied by ``dt``, in place, first.
    """
    rows, cells = out.shape
    for row in range(rows):
        if count > 0:
            for i in range(cells):
                terms[count - 1, row, i] *= dt
        for i in range(cells):
            out[row, i] = start[row, i]
        for k in range(count):
            weight = weights[k]
            if weight != 0.0:
                for i in range(cells):
                    out[row, i] += weight * terms[k, row, i]
