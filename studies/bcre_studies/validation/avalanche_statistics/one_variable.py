"""Slow tilting of piles of the height alone: one that stands at repose, one that sticks.

    f(i) = (1/4) max(0, h(i) - h(i+1) - S_stop d)  where cell i moves        h(i) += f(i-1) - f(i)

A cell begins to move where it falls by more than S_start d to the next, and stops where it falls
by S_stop d: angles of start and of stop. With S_start = S_stop it is the plain control
(``bcre_ca.height_only``). The top is closed; the last cell is held, and sand leaves there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bcre_ca.kept import kept
from bcre_studies.observables.outcome import slope
from bcre_studies.validation.avalanche_statistics.drives import TILT, Events

SHARE = 0.25
SETTLED = 1e-9
"""A cell that sheds no more than this in a step (a length) stops."""


@dataclass(frozen=True)
class Sticking:
    """Slow tilting of a pile that starts at S_start and stops at S_stop = 0, d = 1.

    Parameters
    ----------
    trigger: height laid on one cell at a time.
    start: S_start - S_stop, a slope; 0 for the plain control.
    """

    cells: int
    trigger: float
    start: float
    tilts: int
    seed: int


def stuck(drive: Sticking) -> Events:
    """What followed each tilt; durations are steps of the rule."""
    x, chance = np.arange(drive.cells) + 0.5, np.random.default_rng(drive.seed)
    h, rows = np.zeros(drive.cells), []
    for _ in range(drive.tilts):
        h = h + TILT * (drive.cells - x)
        steepness = slope(x, h)
        place = int(chance.integers(drive.cells - 1))
        h[place] += drive.trigger
        left, steps = _settle(h, drive.start)
        rows.append((steepness, left, float(steps), float(place)))
    return Events(*np.array(rows).T)


@kept
def _settle(h, start):  # type: ignore[no-untyped-def]
    """Let the pile come to rest in place; what left, and after how many steps."""
    last = h.size - 1
    moving = np.zeros(h.size, np.bool_)
    flux = np.zeros(h.size)
    foot = h[last]
    left, steps = 0.0, 0
    while True:
        active = False
        for i in range(last):
            drop = h[i] - h[i + 1]
            if drop > start:
                moving[i] = True
            flux[i] = SHARE * max(drop, 0.0) if moving[i] else 0.0
            if flux[i] <= SETTLED:
                moving[i] = False
                flux[i] = 0.0
            else:
                active = True
        if not active:
            return left, steps
        steps += 1
        for i in range(last):
            h[i] += (flux[i - 1] if i > 0 else 0.0) - flux[i]
        h[last] = foot
        left += flux[last - 1]
