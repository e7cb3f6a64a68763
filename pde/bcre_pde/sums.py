"""The weighted sums of a Runge-Kutta step, without allocation."""

from __future__ import annotations

from bcre_pde.kept import kept


@kept()
def weighted_sum(start, terms, weights, count, dt, out):
    """out = start + the first ``count`` weights times terms; weights of zero are skipped.

    The last of these terms arrives as a rate, and is first multiplied by ``dt`` in place.
    """
    rows, cells = out.shape
    for row in range(rows):
        if count > 0:
            for i in range(cells):
                terms[count - 1, row, i] *= dt
        for i in range(cells):
            out[row, i] = start[row, i]
        for term in range(count):
            weight = weights[term]
            if weight != 0.0:
                for i in range(cells):
                    out[row, i] += weight * terms[term, row, i]
