r"""Heaps that are poured, cones that collapse and silos that fill, on a quarter of the plane.

The axis is in a corner, whose two sides are mirrors. The reference is radially symmetric BCRE
(:mod:`bcre_pde.plane.radial`), and for a silo its closed form.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

import bcre_ca
from bcre_ca.plane import Plane, Sand, Source, frames
from bcre_ca.plane.setting import Flows
from bcre_pde import Material
from bcre_pde.plane import radial
from bcre_pde.plane.radial import theory
from bcre_studies.scenes.domain import Array

SOLVER_TOLERANCE = 1e-4


@dataclass(frozen=True)
class Heap:
    """What makes a heap: the sand at the start over r, and what is poured on a disc.

    ``radius`` is that of the closed disc, or half the side of the closed square, that holds it.
    """

    material: Material
    start: Callable[[Array], tuple[Array, Array]]
    radius: float
    until: float
    rate: float = 0.0
    disc: float = 0.0


def _level(r: Array) -> tuple[Array, Array]:
    return 0 * r, 0 * r


def _steep_cone(r: Array) -> tuple[Array, Array]:
    return np.maximum(1.2 * (20.0 - r), 0.0), 0.1 * np.exp(-((r / 3.0) ** 2))


POURED = Heap(Material(1.0, 0.2, 2.0, 0.5), _level, 30.0, 300.0, 20.0, 4.0)
COLLAPSE = Heap(Material(0.3, 0.1, 0.2, 0.5), _steep_cone, 60.0, 400.0)


SILO = Material(1.0, 0.0, 1.0, 0.5)
SILO_RADIUS, SILO_RISE, SILO_DISC, SILO_UNTIL = 12.0, 0.1, 2.0, 60.0


def heap(made: Heap, flow: Flows, d: float) -> Array:
    """h at the end on a quarter of the plane, shape (N, N), in the automaton."""
    r = radii(made.radius, d)
    poured = made.rate > 0
    sources = (Source(made.rate / 4, (0.0, 0.0), 2 * made.disc),) if poured else ()
    plane = Plane(_rule(made.material, d), flow, ends="closed", sources=sources)
    (end,) = frames(Sand(*made.start(r)), plane, [made.until], threads=1)
    return end.h


def reference(made: Heap, rings: int) -> tuple[Array, Array]:
    """r and h at the end in radially symmetric BCRE."""
    source = radial.Source(made.rate, made.disc) if made.rate > 0 else None
    problem = radial.Problem(made.start, made.material, made.radius, "closed", source)
    solution = radial.solve(problem, [made.until], rings, SOLVER_TOLERANCE)
    return solution.r, solution.h[-1]


def silo(flow: Flows, d: float) -> float:
    """Relative L1 error of R in a round silo that fills.

    Between the disc on which sand falls and where the closed form has a corner near the rim.
    """
    a, m = SILO_RADIUS, SILO
    r = radii(a, d)
    inside = r <= a
    source = Source(SILO_RISE * d * d * float(inside.sum()), (0.0, 0.0), 2 * SILO_DISC)
    plane = Plane(_rule(m, d), flow, ends="closed", walls=~inside, sources=(source,))
    (end,) = frames(Sand(0 * r, 0 * r), plane, [SILO_UNTIL], threads=1)
    looked_at = (r > 1.5 * SILO_DISC) & (r < 0.85 * theory.flat_from(a, m))
    expected = theory.filling_layer(r[looked_at], SILO_RISE, a, m)
    return float(np.abs(end.R[looked_at] - expected).sum() / expected.sum())


def difference(h: Array, d: float, r: Array, expected: Array) -> float:
    """Relative L1 difference of h on the quarter from a function of r."""
    own = np.interp(radii(len(h) * d, d), r, expected)
    return float(np.abs(h - own).sum() / own.sum())


def foot(h: Array, d: float, degrees: float, level: float) -> float:
    """Distance from the axis at which the surface falls to a level, in one direction."""
    from scipy.interpolate import RegularGridInterpolator

    places = (np.arange(len(h)) + 0.5) * d
    surface = RegularGridInterpolator((places, places), h)
    r = np.linspace(4 * d, places[-1], 40 * len(h))
    direction = np.array([math.cos(math.radians(degrees)), math.sin(math.radians(degrees))])
    along = surface(np.maximum(r[:, None] * direction, places[0]))
    return float(r[int(np.argmax(along < level))])


def radii(side: float, d: float) -> Array:
    """Distances of the cells of a quarter from its corner, shape (N, N)."""
    places = (np.arange(round(side / d)) + 0.5) * d
    return np.asarray(np.hypot(places[:, None], places))


def _rule(m: Material, d: float) -> bcre_ca.Rule:
    return bcre_ca.Rule(m.v, m.D, m.gamma, m.Sc, d, dt=0.1)
