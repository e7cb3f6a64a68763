"""The in-place readings of the printed rule: cells visited one after the other."""

from __future__ import annotations

import numba

from bcre_ca.exchange import carried, eroded, settle
from bcre_ca.sums import add


@numba.njit(error_model="numpy")
def sweep(h, R, K, steps, account, fall, rightwards):  # type: ignore[no-untyped-def]
    """``steps`` sweeps, downhill or uphill; ``fall`` is None for open ends."""
    for _ in range(steps):
        for visit in range(h.size):
            i = visit if rightwards else h.size - 1 - visit
            add(account, _visit(h, R, i, K, fall))
        for i in range(h.size):
            h[i], R[i] = settle(h[i], R[i], K.dry)


@numba.njit(error_model="numpy")
def _visit(h, R, i, K, fall):  # type: ignore[no-untyped-def]
    """Update cell i from what is found; return what leaves through the foot."""
    if i < h.size - 1:
        flux = carried(R[i], R[i + 1], K.q, K.b)
        exchange = eroded(R[i], (h[i] - h[i + 1]) - K.s, 0.0, K.k, None, None, None)
        R[i + 1] += flux
        outflow = 0.0
    else:
        flux, exchange, outflow = _visit_last(h, R, K, fall)
    R[i] += exchange - flux
    h[i] -= exchange
    return outflow


@numba.njit(error_model="numpy")
def _visit_last(h, R, K, fall):  # type: ignore[no-untyped-def]
    """Flux out of the last cell, its exchange, and what leaves through the foot."""
    last = h.size - 1
    if fall is None:
        foot = K.c * R[last]
        return foot, 0.0, foot
    flux = carried(R[last], R[0], K.q, K.b)
    exchange = eroded(R[last], (h[last] - (h[0] - fall)) - K.s, 0.0, K.k, None, None, None)
    R[0] += flux
    return flux, exchange, 0.0
