"""The synchronous rule, many steps a call, in place: one sweep downhill per step.

In place works for a synchronous rule because cell i needs the old cells i and i+1, which the sweep
has not touched yet, and the flux out of cell i-1, which is carried along. The edge values are taken
before the loop, and neighbours are read as ``h[i + 1]`` rather than through a shifted view, since
the compiler would otherwise not vectorise it.

Where h and R do not fit into the cache, the sweeps of several steps follow each other through
the cells in tiles skewed by one cell a step, so that memory is passed over once for all of them.

Every kernel changes h and R, views of shape (N,); ``account`` holds the outflow through the foot
(times d: an area) and what rounding has taken from it.
"""

from __future__ import annotations

import numba
import numpy as np

from bcre_ca.exchange import carried, eroded, settle
from bcre_ca.sums import add

TILE_FROM = 250_000
"""Cells from which tiles pay: h and R of this length fill a cache of 4 MB."""

TILE = 4096
TILE_STEPS = 32


@numba.njit(error_model="numpy")
def _sweep(h, R, cells, K, flux_in, before):  # type: ignore[no-untyped-def]
    """One step of the first ``cells`` cells of the views; each has a neighbour downhill.

    ``flux_in`` enters the first cell, whose neighbour uphill drops by ``before``.
    """
    _, b, q, k, s, a, m, u, dry = K
    for i in range(cells):
        R_i = R[i]
        flux_out = carried(R_i, R[i + 1], q, b)
        drop = (h[i] - h[i + 1]) - s
        exchange = eroded(R_i, drop, before - drop, k, a, m, u)
        h[i], R[i] = settle(h[i] - exchange, R_i + ((flux_in - flux_out) + exchange), dry)
        flux_in = flux_out
        before = drop


@numba.njit(error_model="numpy")
def _leave(h, R, last, K, flux_in, above, account):  # type: ignore[no-untyped-def]
    """One step of the cell at the open foot, into which the surface drops by ``above``."""
    foot = K.c * R[last]
    exchange = eroded(R[last], 0.0, above, K.k, K.a, K.m, None)
    h[last], R[last] = settle(h[last] - exchange, R[last] + ((flux_in - foot) + exchange), K.dry)
    add(account, foot)


@numba.njit(error_model="numpy")
def open_ends(h, R, K, steps, account):  # type: ignore[no-untyped-def]
    """``steps`` steps with a closed top and an open foot."""
    last = h.size - 1
    if last >= TILE_FROM:
        _tiled(h, R, K, steps, account)
        return
    for _ in range(steps):
        into_last, above = 0.0, 0.0
        if last > 0:
            into_last = carried(R[last - 1], R[last], K.q, K.b)
            above = (h[last - 1] - h[last]) - K.s
            _sweep(h, R, last, K, K.c - K.c, (h[0] - h[1]) - K.s)
        _leave(h, R, last, K, into_last, above, account)


@numba.njit(error_model="numpy")
def _tiled(h, R, K, steps, account):  # type: ignore[no-untyped-def]
    """:func:`open_ends` in tiles.

    Step t of tile j takes the cells from j TILE - t to (j + 1) TILE - t: there the step before has
    been taken one cell further, as it must. What a tile's sweeps carried out at their lower
    ends, the next tile's sweeps carry in.
    """
    last = h.size - 1
    carried_flux, carried_drop = np.empty(TILE_STEPS), np.empty(TILE_STEPS)
    for first_step in range(0, steps, TILE_STEPS):
        together = min(TILE_STEPS, steps - first_step)
        for tile in range((last + together) // TILE + 1):
            for t in range(together):
                upper = max(tile * TILE - t, 0)
                lower = min((tile + 1) * TILE - t, last)
                if upper == 0:
                    carried_flux[t] = 0.0
                    carried_drop[t] = (h[0] - h[1]) - K.s
                if upper < lower:
                    flux_out = carried(R[lower - 1], R[lower], K.q, K.b)
                    drop = (h[lower - 1] - h[lower]) - K.s
                    sweep = lower - upper
                    _sweep(h[upper:], R[upper:], sweep, K, carried_flux[t], carried_drop[t])
                    carried_flux[t] = flux_out
                    carried_drop[t] = drop
                if upper <= last < (tile + 1) * TILE - t:
                    _leave(h, R, last, K, carried_flux[t], carried_drop[t], account)


@numba.njit(error_model="numpy")
def periodic(h, R, K, steps, fall):  # type: ignore[no-untyped-def]
    """``steps`` steps with joined ends; ``fall`` is that of the repose line over the period."""
    last = h.size - 1
    for _ in range(steps):
        R_first, R_last, h_last = R[0], R[last], h[last]
        into_first = carried(R_last, R_first, K.q, K.b)
        into_last = carried(R[last - 1], R_last, K.q, K.b) if last > 0 else into_first
        drop_last = (h_last - (h[0] - fall)) - K.s
        drop_before = (h[last - 1] - h_last) - K.s if last > 0 else drop_last
        bend_last = drop_before - drop_last
        exchange = eroded(R_last, drop_last, bend_last, K.k, K.a, K.m, K.u)
        _sweep(h, R, last, K, into_first, drop_last)
        h[last], R[last] = settle(
            h_last - exchange, R_last + ((into_last - into_first) + exchange), K.dry
        )
