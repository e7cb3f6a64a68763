"""The in-place readings of the printed rule: cells visited one after the other."""

from __future__ import annotations

import numpy as np

from bcre_ca.exchange import carried, deposit_thin, eroded
from bcre_ca.inner import inner
from bcre_ca.sums import add


@inner
def sweep(h, R, K, steps, account, period_drop):
    """``steps`` sweeps, downhill or uphill; ``period_drop`` is None for open ends."""
    R_before = np.empty_like(R)
    for _ in range(steps):
        for i in range(R.size):
            R_before[i] = R[i]
        for visit in range(h.size):
            i = visit if K.scheme.downhill else h.size - 1 - visit
            add(account, _visit(h, R, i, K, period_drop))
        for i in range(h.size):
            h[i], R[i] = deposit_thin(h[i], R[i], R_before[i], K.dry, K.emptying)


@inner
def _visit(h, R, i, K, period_drop):
    """Update cell i from what is found there; return what leaves through the foot."""
    if i < h.size - 1:
        return _pass_on(h, R, i, i + 1, h[i + 1], K)
    if period_drop is not None:
        return _pass_on(h, R, i, 0, h[0] - period_drop, K)
    foot = K.courant * R[i]
    R[i] -= foot
    return foot


@inner
def _pass_on(h, R, i, below, h_below, K):
    """Update cell i and the rolling layer of the cell below; nothing leaves the line."""
    flux = carried(R[i], R[below], K)
    exchange = eroded(R[i], (h[i] - h_below) - K.repose_drop, 0.0, K)
    R[below] += flux
    R[i] += exchange - flux
    h[i] -= exchange
    return 0.0
