"""Whole lines with sources, whatever their ends, many steps a call.

The steps are those of :mod:`bcre_ca.line.container` and :mod:`bcre_ca.line.slope_driven`. What
crosses each face is found first, then every cell changes.
"""

from __future__ import annotations

import numpy as np

from bcre_ca.exchange import carried, deposit_thin, eroded, leaving
from bcre_ca.inner import inner
from bcre_ca.line import slope_driven as law
from bcre_ca.schemes import JOINED, WALLED
from bcre_ca.sums import add

LEAST = 2.5
"""By von Neumann's analysis on even slopes; with less than 2.3 small waves grow under a thick layer
on a slope that is all but level."""


@inner
def upwind(h, R, K, steps, account):
    """``steps`` steps of the upwind rule."""
    cells = h.size
    flux, drop = np.zeros(cells + 1), np.zeros(cells + 1)
    for _ in range(steps):
        for i in range(cells - 1):
            flux[i + 1] = carried(R[i], R[i + 1], K)
            drop[i + 1] = (h[i] - h[i + 1]) - K.repose_drop
        if K.scheme.ends == JOINED:
            flux[cells] = carried(R[cells - 1], R[0], K)
            drop[cells] = (h[cells - 1] - (h[0] - K.repose_drop * cells)) - K.repose_drop
            flux[0], drop[0] = flux[cells], drop[cells]
        elif K.scheme.ends == WALLED:
            flux[cells], drop[cells] = 0.0, -K.repose_drop
            drop[0] = drop[1]
        else:
            flux[cells], drop[cells] = leaving(R[cells - 1], K), 0.0
            drop[0] = drop[1]
        for i in range(cells):
            exchange = eroded(R[i], drop[i + 1], drop[i] - drop[i + 1], K)
            R_new = (R[i] + ((flux[i] - flux[i + 1]) + exchange)) + K.scheme.supply[i]
            h[i], R[i] = deposit_thin(h[i] - exchange, R_new, R[i], K.dry, K.emptying)
        add(account, flux[cells] - flux[0])


@inner
def slope_driven(h, R, K, steps, account):
    """``steps`` steps of the rule whose layer is driven by the slope."""
    cells, d = h.size, K.scheme.d
    flux, fall = np.zeros(cells + 1), np.zeros(cells + 1)
    for _ in range(steps):
        for i in range(cells - 1):
            fall[i + 1] = h[i] - h[i + 1]
            flux[i + 1] = law.carried(R[i], R[i + 1], fall[i + 1], d, K)
        if K.scheme.ends != WALLED:
            beyond = R[cells - 1]
            fall[cells] = K.repose_drop
            if K.scheme.ends == JOINED:
                beyond = R[0]
                fall[cells] = h[cells - 1] - (h[0] - K.repose_drop * cells)
                fall[0] = fall[cells]
            flux[cells] = law.carried(R[cells - 1], beyond, fall[cells], d, K)
            if K.scheme.ends == JOINED:
                flux[0] = flux[cells]
        for i in range(cells):
            exchange = law.eroded(R[i], fall[i], fall[i + 1], K)
            h[i] -= exchange
            R[i] = (R[i] + ((flux[i] - flux[i + 1]) + exchange)) + K.scheme.supply[i]
        add(account, flux[cells] - flux[0])


@inner
def sink_at_wall(h, p):
    """Loss per unit of layer in the cell at a wall, against which the surface is level; or 0."""
    if p.scheme.ends != WALLED:
        return 0.0
    bend = max(h[h.size - 2] - h[h.size - 1], 0.0) if h.size > 1 else 0.0
    return p.gamma * max(p.repose_slope, 0.0) + p.kappa * bend / p.d**2


@inner
def sink_on_slopes(h, p):
    """gamma Sc + (beta/d) S: fastest loss per unit of layer, S no less than LEAST Sc.

    S is the sum of what a cell falls to both sides, which only a ridge does.
    """
    repose, last = p.repose_slope * p.d, h.size - 1
    across = h[last] - (h[0] - repose * h.size) if p.scheme.ends == JOINED else 0.0
    steepest, before = LEAST * repose, across
    for i in range(h.size):
        after = h[i] - h[i + 1] if i < last else across
        steepest = max(steepest, max(after, 0.0) + max(-before, 0.0))
        before = after
    return p.gamma * p.repose_slope + p.v * steepest / p.d**2
