"""An automaton of the height alone (Bak, Tang and Wiesenfeld 1988, for a continuous height).

    f(i) = (1/4) max(0, h(i) - h(i+1) - Sc d)        h(i) += f(i-1) - f(i)

with a closed top and the last cell held, where sand leaves; or periodic in h + Sc x. With angles of
start and of stop a cell sheds nothing until it falls by more than a larger amount to the next, and
from then on until it falls by Sc d.
"""

from __future__ import annotations

import numpy as np

from bcre_ca.kept import kept

SHARE = 0.25
SETTLED = 1e-9
"""The pile has settled when no cell sheds more than this in a step (a length)."""


@kept
def settled(h, fall, periodic, start=0.0):
    """The height once no cell sheds more than :data:`SETTLED`, what left, and after how many steps.

    Parameters
    ----------
    h: height at the cell centres, shape (N,).
    fall: Sc d, the largest fall from cell to cell that stands.
    periodic: joined ends; otherwise a closed top and a last cell that is held.
    start: fall at which a cell begins to shed; no less than ``fall``.
    """
    h = h.copy()
    last = h.size - 1
    flux, moves = np.zeros(h.size), np.zeros(h.size, np.bool_)
    margin = max(start - fall, 0.0)
    left = 0.0
    steps = 0
    while True:
        for i in range(last):
            excess = max(h[i] - h[i + 1] - fall, 0.0)
            moves[i] = excess > margin or (moves[i] and excess > 0)
            flux[i] = SHARE * excess if moves[i] else 0.0
        if periodic:
            excess = max(h[last] - h[0] + fall * last, 0.0)
            moves[last] = excess > margin or (moves[last] and excess > 0)
            flux[last] = SHARE * excess if moves[last] else 0.0
        if flux.max() <= SETTLED:
            return h, left, steps
        steps += 1
        for i in range(last):
            h[i] += flux[i - 1] - flux[i] if i > 0 or periodic else -flux[i]
        if periodic:
            h[last] += flux[last - 1] - flux[last]
        elif last > 0:
            left += flux[last - 1]
