r"""Finite pulses on a plane and on a line: from which slope on do they bring the top down?

The scene is figure 1's (v = D = 0.1, gamma = 0.01, Sc = 0.5, L = 100, pulse of width 3 at x = 85,
until t = 3000), the automaton on cells of side 1. On a plane the pulse is round. On a line it is a
ridge across all of the plane, which one column of cells holds. The top has come down as
:func:`bcre_studies.observables.outcome.reached_the_top` says, on the axis.

BCRE's threshold is found on cells of side 2, and its bracket widened until it holds on cells of
side 4/3 too.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

import bcre_ca
from bcre_ca.plane import Plane, Sand, frames
from bcre_pde import Measured
from bcre_pde.plane import Material, Problem, march
from bcre_studies.observables.outcome import SPENT, reached_the_top, slope
from bcre_studies.scenes.domain import Array
from bcre_studies.validation.opening_angle.trace import with_diffusion_of_cells

LENGTH, CENTRE, WIDTH, UNTIL = 100.0, 85.0, 3.0, 3000.0
ROWS = 100
LINE, PLANE = 1, 100
"""Columns of the half y > 0 in the automaton."""

GRIDS, COLUMNS_OF_A_LINE, HALF_WIDTH = (50, 75), 3, 50.0
"""BCRE: cells along, cells across where it is a line, and the half y > 0 where it is a plane."""

SOLVER_TOLERANCE = 1e-4
TIMES = [float(t) for t in np.linspace(0.0, UNTIL, 31)]
LOWEST, HIGHEST = 0.4, 3.2
RATIO = 1.008
"""A threshold is bracketed to this ratio."""

Falls = Callable[[float], bool]
"""Does the top come down from this S0 - Sc?"""


def end_of(material: Material, excess: float, pulse: float, columns: int) -> tuple[bool, float]:
    """Whether the top came down, and S - Sc along the axis when that was decided."""
    m = material
    x = np.asarray(np.arange(ROWS) + 0.5)
    y = np.asarray(np.arange(columns) + 0.5 * (columns > LINE))
    h, R = _start(m, excess, pulse, x[:, None], y)
    plane = Plane(bcre_ca.Rule(m.v, m.D_x, m.gamma, m.Sc, 1.0, 1.0))
    layers = ((sand.h, sand.R) for sand in frames(Sand(h, R), plane, TIMES, threads=1))
    return _end(m, pulse, x, layers)


def end_in_bcre(
    material: Material, excess: float, pulse: float, is_line: bool, cells: int
) -> tuple[bool, float]:
    """The same in BCRE on so many cells along."""
    m, d = material, LENGTH / cells
    columns = COLUMNS_OF_A_LINE if is_line else round(HALF_WIDTH / d)

    def start(x: Array, y: Array) -> tuple[Array, Array]:
        return _start(m, excess, pulse, x, 0 * y if is_line else y)

    problem = Problem(start, m, LENGTH, columns * d, sides="closed")
    solved = march(problem, TIMES, (cells, columns), SOLVER_TOLERANCE)
    x = np.asarray(np.arange(cells) + 0.5) * d
    return _end(m, pulse, x, ((frame.h, frame.R) for frame in solved))


def _start(m: Material, excess: float, pulse: float, x: Array, y: Array) -> tuple[Array, Array]:
    h = (m.Sc + excess) * (LENGTH - x) + 0 * y
    return h, pulse * np.exp(-((x - CENTRE) ** 2 + y**2) / WIDTH**2)


def _end(
    m: Material, pulse: float, x: Array, layers: Iterator[tuple[Array, Array]]
) -> tuple[bool, float]:
    start, _ = next(layers)
    for h, R in layers:
        came_down = reached_the_top(x, *(layer[:, 0] + m.Sc * x for layer in (start, h)))
        if came_down or R.max() <= SPENT * pulse:
            break
    return came_down, slope(x, h[:, 0]) - m.Sc


def in_automaton(material: Material, pulse: float, columns: int) -> Measured:
    """The lowest S0 - Sc at which the top comes down, and half of its bracket."""
    return threshold([lambda excess: end_of(material, excess, pulse, columns)[0]])


def in_bcre(material: Material, pulse: float, is_line: bool) -> Measured:
    """The same in BCRE."""

    def falls(cells: int, excess: float) -> bool:
        return end_in_bcre(material, excess, pulse, is_line, cells)[0]

    return threshold([partial(falls, cells) for cells in GRIDS])


def threshold(falls_on: Sequence[Falls]) -> Measured:
    """Bisected on the first grid; widened on the further ones until it holds there too."""
    low, high = LOWEST, HIGHEST
    while high > RATIO * low:
        middle = math.sqrt(low * high)
        low, high = (low, middle) if falls_on[0](middle) else (middle, high)
    for falls in falls_on[1:]:
        while falls(low):
            low /= RATIO
        while not falls(high):
            high *= RATIO
    return Measured((low + high) / 2, (high - low) / 2)


def with_cells(material: Material) -> Material:
    """BCRE with what the automaton's cells of side 1 add: D_x + v d/2 and kappa_x = gamma d/2."""
    return replace(with_diffusion_of_cells(material, 1.0), kappa_x=material.gamma / 2)
