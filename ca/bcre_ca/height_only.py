"""An automaton of the height alone (Bak, Tang and Wiesenfeld 1988, for a continuous height).

    f(i) = (1/4) max(0, h(i) - h(i+1) - Sc d)        h(i) += f(i-1) - f(i)

with a closed top and the last cell held, where sand leaves; or periodic in h + Sc x.
"""

from __future__ import annotations

import numpy as np

from bcre_ca.kept import kept

SHARE = 0.25
SETTLED = 1e-9
"""The pile has settled when no cell sheds more than this in a step (a length)."""


@kept
def settled(h, fall, periodic):  # type: ignore[no-untyped-def]
    """The height once no cell sheds more than :data:`SETTLED`, what left, and after how many steps.

    Parameters
    ----------
    h: height at the cell centres, shape (N,).
    fall: Sc d, the largest fall from cell to cell that stands.
    periodic: joined ends; otherwise a closed top and a last cell that is held.
    """
    h = h.copy()
    last = h.size - 1
    flux = np.zeros(h.size)
    left = 0.0
    steps = 0
    while True:
        for i in range(last):
            flux[i] = SHARE * max(h[i] - h[i + 1] - fall, 0.0)
        if periodic:
            flux[last] = SHARE * max(h[last] - h[0] + fall * last, 0.0)
        if flux.max() <= SETTLED:
            return h, left, steps
        steps += 1
        for i in range(last):
            h[i] += flux[i - 1] - flux[i] if i > 0 or periodic else -flux[i]
        if periodic:
            h[last] += flux[last - 1] - flux[last]
        elif last > 0:
            left += flux[last - 1]
