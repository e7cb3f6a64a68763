"""The synchronous upwind rule on a frozen slope: the exchange sees drops that stay as they are."""

from __future__ import annotations

from bcre_ca.exchange import carried, deposit_thin, eroded
from bcre_ca.inner import inner
from bcre_ca.line.kernels.sweep import leave


@inner
def march(h, R, drop, K, steps, account, period_drop):
    """``steps`` steps with the given drop beyond repose from each cell to the next."""
    last = h.size - 1
    for _ in range(steps):
        first = R[0]
        flux_in, before = K.courant - K.courant, drop[0]
        if period_drop is not None:
            flux_in, before = carried(R[last], first, K), drop[last]
        for i in range(last):
            flux_out = carried(R[i], R[i + 1], K)
            exchange = eroded(R[i], drop[i], before - drop[i], K)
            h[i], R[i] = deposit_thin(
                h[i] - exchange, R[i] + ((flux_in - flux_out) + exchange), R[i], K.dry, K.emptying
            )
            flux_in = flux_out
            before = drop[i]
        if period_drop is None:
            leave(h, R, last, K, flux_in, before, account)
        else:
            flux_out = carried(R[last], first, K)
            exchange = eroded(R[last], drop[last], before - drop[last], K)
            h[last], R[last] = deposit_thin(
                h[last] - exchange,
                R[last] + ((flux_in - flux_out) + exchange),
                R[last],
                K.dry,
                K.emptying,
            )
