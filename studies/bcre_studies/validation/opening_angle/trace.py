r"""The opening angle, measured from a trace of R that does not change the slope.

R = 1e-150 is released on an even slope S and all that ever passes a place is added up,

    N(x, y) = int R dt

until what is still to come is too little to count. The angle is that of the edge of N
(:mod:`bcre_pde.plane.opening`). Only the half y > 0 is run, since the axis is a mirror. What the
other ends send back fades by e^-12 on its way; how fast it fades follows from the steady wave at
the edge, e^(along x - across y) (:class:`bcre_ca.plane.theory.Edge`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import bcre_ca
from bcre_ca.plane import Plane, Run, Sand
from bcre_ca.plane.theory import Edge, edge
from bcre_pde.plane import Material, Problem, march, opening
from bcre_pde.plane.opening import OpeningAngle
from bcre_studies.scenes.domain import Array

TRACE = 1e-150
"""The rolling layer released: it changes no slope, and stays above the smallest numbers."""

FADED = 12.0
"""Echoes of the ends are weakened by e to this power."""

NEAREST_CELLS, NEAREST_UNITS = 12, 6.0
"""The nearest distance at which the automaton's N is read: so many cells and so many D_eff/v."""

NEAREST_IN_BCRE = 10.0
"""That of BCRE, in units of D_x/v."""

STILL_TO_COME = 1e-6
"""Largest part of N that may still be to come."""

PART_OF_BOUND = 0.9
"""The automaton's step; the angle does not depend on it."""

CONTINUOUS = 1e-3
"""Cells so small, in units of D_x/v, have BCRE's own edge to four digits."""

SOURCE_WIDTH = 2.0
"""Of the pulse in BCRE, in units of D_x/v."""

MOST_TIMES = 100_000


class Extent(NamedTuple):
    """Cells along and across, and those above the source."""

    rows: int
    columns: int
    above: int


def measured_in_automaton(
    material: Material, excess: float, d: float, part: float = PART_OF_BOUND
) -> OpeningAngle:
    """The angle on the slope Sc + ``excess`` in cells of side d; ``part`` is that of its bound."""
    m = material
    unit = m.D_x / m.v + d / 2
    wave = edge(m.v, m.D_x, m.D_y, m.gamma * excess, d)
    nearest = max(NEAREST_CELLS * d, NEAREST_UNITS * unit)
    rows, columns, above = extent(wave, nearest, d)
    dt = part / (m.v / d + 2 * (m.D_x + m.D_y) / d**2)
    rule = bcre_ca.Rule(m.v, m.D_x, m.gamma, m.Sc, d, dt)
    h = -(m.Sc + excess) * d * np.arange(rows)[:, None] * np.ones(columns)
    R = np.zeros_like(h)
    R[above, 0] = TRACE
    between = max(round(0.5 * unit / m.v / dt), 1)

    def layers() -> Iterator[tuple[float, Array]]:
        run = Run(Sand(h, R), Plane(rule, D_across=m.D_y), threads=1)
        while True:
            run.take(between)
            yield run.t, run.R

    place = (above + 0.5) * d
    return _angle(layers(), (rows, columns), d, place, nearest)


def measured_in_bcre(material: Material, excess: float) -> OpeningAngle:
    """The angle on the slope Sc + ``excess`` in BCRE, on cells of side D_x/v.

    The release is a Gaussian of width w. It is a release at a point that happened w^2/(4 D_x)
    earlier and has been carried since, from a place v w^2/(4 D_x) uphill of its centre.
    """
    m = material
    d = unit = m.D_x / m.v
    wave = edge(m.v, m.D_x, m.D_y, m.gamma * excess, CONTINUOUS * unit)
    rows, columns, above = extent(wave, NEAREST_IN_BCRE * unit, d)
    centre, width = above * d, SOURCE_WIDTH * unit

    def pulse(x: Array, y: Array) -> tuple[Array, Array]:
        away = (x - centre) ** 2 + y**2 * m.D_x / m.D_y
        return -(m.Sc + excess) * x, TRACE * np.exp(-away / width**2)

    problem = Problem(pulse, m, rows * d, columns * d, sides="closed")
    times = [count * unit / m.v for count in range(1, MOST_TIMES)]
    layers = ((frame.t, frame.R) for frame in march(problem, times, (rows, columns), 1e-4))
    place = centre - m.v * width**2 / (4 * m.D_x)
    return _angle(layers, (rows, columns), d, place, NEAREST_IN_BCRE * unit)


def extent(wave: Edge, nearest: float, d: float) -> Extent:
    """Room for N out to four times the nearest distance, and for echoes to fade."""
    theta = math.radians(wave.theta)
    farthest = opening.DISTANCES[-1] * nearest
    beyond = FADED / wave.parting
    along = 2 * beyond + farthest * math.cos(0.85 * theta)
    across = FADED / (2 * wave.across) + farthest * math.sin(min(1.1 * theta, math.pi / 2))
    return Extent(math.ceil(along / d), math.ceil(across / d), math.ceil(beyond / d))


def _angle(
    layers: Iterator[tuple[float, Array]],
    shape: tuple[int, int],
    d: float,
    place: float,
    nearest: float,
) -> OpeningAngle:
    x, y = (np.asarray(np.arange(cells) + 0.5) * d for cells in shape)
    N = passed_below(layers, x > place)
    return opening.opening_angle(N, x, y, (place, 0.0), nearest)


def passed_below(layers: Iterator[tuple[float, Array]], below: NDArray[np.bool_]) -> Array:
    """The sum of R over equal intervals, until hardly more is to come in the rows ``below``.

    R fades as e^(-sigma t)/t there, so that from t = 1/sigma on less than R t is to come.
    """
    total: Array = np.zeros(())
    last = 0.0
    for t, R in layers:
        total = total + R
        interval, last = t - last, t
        if (R[below] * t <= STILL_TO_COME * interval * total[below]).all() and total[below].all():
            break
    return total


def with_diffusion_of_cells(material: Material, d: float, across: bool = False) -> Material:
    """BCRE with what the cells add to D in the sum over time, v d/2: along, or across as well."""
    added = material.v * d / 2
    return replace(material, D_x=material.D_x + added, D_y=material.D_y + added * across)
