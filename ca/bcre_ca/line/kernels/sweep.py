r"""The synchronous upwind rule, many steps a call, in place: one sweep downhill per step.

In place works for a synchronous rule: cell i needs the old cells i and i+1, which the sweep has
not reached yet, and the flux out of cell i-1, which is carried along. The values at the ends are
taken before the loop. Neighbours are read as ``h[i + 1]`` rather than through a shifted view, or
the compiler would not vectorise the loop.

Where h and R do not fit into the cache, the sweeps of several steps follow each other through the
cells in tiles skewed by one cell a step. Memory is then passed over once for all of them.

Every kernel changes h and R, views of shape (N,). ``account`` holds the outflow through the foot
(times d: an area) and its rounding error.
"""

from __future__ import annotations

import numpy as np

from bcre_ca.exchange import carried, deposit_thin, eroded, eroded_at_foot, leaving
from bcre_ca.inner import inner
from bcre_ca.sums import add

TILE_FROM = 250_000
"""Cells from which on tiles pay: h and R of this length fill a cache of 4 MB."""

TILE = 4096
TILE_STEPS = 32


@inner
def _sweep(h, R, cells, K, flux_in, before):
    """One step of the first ``cells`` cells of the views; each has a neighbour downhill.

    ``flux_in`` enters the first cell, into which the surface drops by ``before``.
    """
    for i in range(cells):
        R_i = R[i]
        flux_out = carried(R_i, R[i + 1], K)
        drop = (h[i] - h[i + 1]) - K.repose_drop
        exchange = eroded(R_i, drop, before - drop, K)
        R_new = R_i + ((flux_in - flux_out) + exchange)
        h[i], R[i] = deposit_thin(h[i] - exchange, R_new, R_i, K.dry, K.emptying)
        flux_in = flux_out
        before = drop


@inner
def leave(h, R, last, K, flux_in, above, account):
    """One step of the cell at the open foot, into which the surface drops by ``above``."""
    foot = leaving(R[last], K)
    exchange = eroded_at_foot(R[last], above, K)
    h[last], R[last] = deposit_thin(
        h[last] - exchange, R[last] + ((flux_in - foot) + exchange), R[last], K.dry, K.emptying
    )
    add(account, foot)


@inner
def open_ends(h, R, K, steps, account):
    """``steps`` steps with a closed top and an open foot."""
    last = h.size - 1
    if last >= TILE_FROM:
        _tiled(h, R, K, steps, account)
        return
    for _ in range(steps):
        into_last, above = 0.0, 0.0
        if last > 0:
            into_last = carried(R[last - 1], R[last], K)
            above = (h[last - 1] - h[last]) - K.repose_drop
            _sweep(h, R, last, K, K.courant - K.courant, (h[0] - h[1]) - K.repose_drop)
        leave(h, R, last, K, into_last, above, account)


@inner
def _tiled(h, R, K, steps, account):
    """:func:`open_ends` in tiles.

    Step t of tile j takes the cells from j TILE - t to (j + 1) TILE - t: there the step before has
    been taken one cell further, as it must. What a tile's sweeps carry out at their lower ends,
    the next tile's sweeps carry in.
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
                    carried_drop[t] = (h[0] - h[1]) - K.repose_drop
                if upper < lower:
                    flux_out = carried(R[lower - 1], R[lower], K)
                    drop = (h[lower - 1] - h[lower]) - K.repose_drop
                    sweep = lower - upper
                    _sweep(h[upper:], R[upper:], sweep, K, carried_flux[t], carried_drop[t])
                    carried_flux[t] = flux_out
                    carried_drop[t] = drop
                if upper <= last < (tile + 1) * TILE - t:
                    leave(h, R, last, K, carried_flux[t], carried_drop[t], account)


@inner
def periodic(h, R, K, steps, period_drop):
    """``steps`` steps with joined ends; ``period_drop`` is the fall of the repose line."""
    last = h.size - 1
    for _ in range(steps):
        R_last, h_last = R[last], h[last]
        into_first = carried(R_last, R[0], K)
        into_last = carried(R[last - 1], R_last, K) if last > 0 else into_first
        drop_last = (h_last - (h[0] - period_drop)) - K.repose_drop
        drop_before = (h[last - 1] - h_last) - K.repose_drop if last > 0 else drop_last
        exchange = eroded(R_last, drop_last, drop_before - drop_last, K)
        _sweep(h, R, last, K, into_first, drop_last)
        h[last], R[last] = deposit_thin(
            h_last - exchange,
            R_last + ((into_last - into_first) + exchange),
            R_last,
            K.dry,
            K.emptying,
        )
