r"""Finite pulses on a plane and on a line: from which slope on do they bring the top down?

The scene is figure 1's (v = D = 0.1, gamma = 0.01, Sc = 0.5, L = 100, pulse of width 3 at x = 85,
until t = 3000) on cells of side 1. On a plane the pulse is round. On a line it is a ridge across
all of the plane, which one column of cells holds. The top has come down as
:func:`bcre_studies.observables.outcome.reached_the_top` says, on the axis.
"""

from __future__ import annotations

import math

import numpy as np

import bcre_ca
from bcre_ca.plane import Plane, Sand, frames
from bcre_pde import Measured
from bcre_pde.plane import Material
from bcre_studies.observables.outcome import SPENT, reached_the_top, slope
from bcre_studies.scenes.domain import Array

ROWS, CENTRE, WIDTH, UNTIL = 100, 85.0, 3.0, 3000.0
LINE, PLANE = 1, 100
"""Columns of the half y > 0."""

TIMES = [float(t) for t in np.linspace(0.0, UNTIL, 31)]
LOWEST, HIGHEST = 0.4, 3.2
RATIO = 1.008
"""A threshold is bracketed to this ratio."""


def end_of(material: Material, excess: float, pulse: float, columns: int) -> tuple[bool, float]:
    """Whether the top came down, and S - Sc along the axis when that was decided."""
    m = material
    x, y = np.arange(ROWS) + 0.5, np.arange(columns) + 0.5 * (columns > LINE)
    h = (m.Sc + excess) * (ROWS - x)[:, None] * np.ones(columns)
    R = pulse * np.exp(-((x[:, None] - CENTRE) ** 2 + y**2) / WIDTH**2)
    plane = Plane(bcre_ca.Rule(m.v, m.D_x, m.gamma, m.Sc, 1.0, 1.0))

    def above_repose(layer: Array) -> Array:
        return np.asarray(layer[:, 0] + m.Sc * x)

    came_down = False
    for sand in frames(Sand(h, R), plane, TIMES, threads=1):
        came_down = reached_the_top(x, above_repose(h), above_repose(sand.h))
        if came_down or sand.R.max() <= SPENT * pulse:
            break
    return came_down, slope(x, sand.h[:, 0]) - m.Sc


def threshold(material: Material, pulse: float, columns: int) -> Measured:
    """The lowest S0 - Sc at which the top comes down, and half of its bracket."""
    low, high = LOWEST, HIGHEST
    while high > RATIO * low:
        middle = math.sqrt(low * high)
        came_down, _ = end_of(material, middle, pulse, columns)
        low, high = (low, middle) if came_down else (middle, high)
    return Measured((low + high) / 2, (high - low) / 2)
