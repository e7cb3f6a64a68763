r"""The triangle that an avalanche leaves in an erodible layer on a rigid base, and how it opens.

Where a layer of thickness delta lies on a base, sand rolls on until the layer is gone, and the
avalanche leaves a triangle with straight edges. Its edge y(x) is a front that runs across as x
grows. It is pulled by its thin foot, where the slope is still S0. Such a front comes to its speed,
here tan(theta), slowly,

    y = x tan(theta) - (3/(2 n)) ln x + c0 + c1/sqrt(x) + ...

(Bramson 1983; Ebert and van Saarloos, Physica D 146 (2000) 1), where R falls as e^(-n y) across the
foot (:class:`bcre_ca.plane.theory.Edge`). A contour of a trace has 1/2 in place of 3/2. So the
angle at x is smaller than theta by (3/2) cos^2(theta)/(n x), whatever the pulse was.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

import bcre_ca
from bcre_ca.plane import Plane, Sand, frames
from bcre_ca.plane.theory import Edge, edge
from bcre_pde import Measured
from bcre_pde.plane import Material
from bcre_studies.scenes.domain import Array

THICKNESS = 0.2
WIDTH = 3.0
"""Of the pulse."""

ABOVE = 30
"""Rows above the pulse: as far as a wedge does not reach."""

HALF = 0.5
"""The edge is where so much of the layer has gone."""

BELOW = 40
"""Rows above the foot that are not looked at: in the last one nothing is eroded."""

SPENT = 1e-6
"""The run ends when no more than this is left of R: at the edges it is last."""

NEAREST = 100.0
"""From this distance on the edge is fitted."""


class Triangle(NamedTuple):
    """Half of a triangle below its pulse: depth eroded (N, M) at x (N,), y (M,); its edge y(x)."""

    x: Array
    y: Array
    eroded: Array
    side: Array


class Opening(NamedTuple):
    """The angle in degrees that a fit to the edge tends to, and the factor of (1/n) ln x in it."""

    theta: Measured
    slowness: float


def triangle(material: Material, excess: float, pulse: float, length: int) -> Triangle:
    """What a pulse leaves on so many rows of cells of side 1 below it."""
    m = material
    wave = _wave(m, excess)
    theta = math.radians(wave.theta)
    rows, columns = ABOVE + length + BELOW, int(1.05 * length * math.tan(theta)) + 30
    x, y = (np.asarray(np.arange(cells) + 0.5) for cells in (rows, columns))
    x = np.asarray(x - ABOVE)
    h = -(m.Sc + excess) * x[:, None] * np.ones(columns)
    R = pulse * np.exp(-(x[:, None] ** 2 + y**2) / WIDTH**2)
    plane = Plane(bcre_ca.Rule(m.v, m.D_x, m.gamma, m.Sc, 1.0, 1.0), base=h - THICKNESS)
    times = (length / m.v * np.arange(2, 40) / 2).tolist()
    for end in frames(Sand(h, R), plane, times, threads=1):
        if end.R.max() <= SPENT:
            break
    eroded = h - end.h
    side = np.array([_edge(y, row) for row in eroded / THICKNESS])
    return Triangle(x[:-BELOW], y, eroded[:-BELOW], side[:-BELOW])


def _edge(y: Array, gone: Array) -> float:
    """Where the part gone falls to a half, counted from the axis; 0 where it is less there."""
    outside = int(np.argmax(gone < HALF))
    if outside == 0:
        return 0.0
    inner, outer = gone[outside - 1], gone[outside]
    return float(y[outside - 1] + (inner - HALF) / (inner - outer) * (y[outside] - y[outside - 1]))


def opening(material: Material, excess: float, found: Triangle) -> Opening:
    """The fit of x, ln x, 1 and 1/sqrt(x) to the edge; its error is what the last one does."""
    x, y = found.x, found.side
    chosen = x >= NEAREST
    x, y = x[chosen], y[chosen]
    terms = np.stack([x, np.log(x), np.ones_like(x), 1 / np.sqrt(x)], axis=1)

    def fit(count: int) -> Array:
        return np.asarray(np.linalg.lstsq(terms[:, :count], y, rcond=None)[0])

    with_all, without = fit(4), fit(3)
    theta, other = (math.degrees(math.atan(found[0])) for found in (with_all, without))
    slowness = -with_all[1] * _wave(material, excess).across
    return Opening(Measured(theta, abs(theta - other)), float(slowness))


def angle_at(found: Triangle, x: float, over: int = 20) -> float:
    """Of the edge to the axis between x - ``over`` and x + ``over``, in degrees."""
    i = int(np.searchsorted(found.x, x))
    rise = found.side[i + over] - found.side[i - over]
    return math.degrees(math.atan2(rise, found.x[i + over] - found.x[i - over]))


def _wave(m: Material, excess: float) -> Edge:
    return edge(m.v, m.D_x, m.D_y, m.gamma * excess, 1.0)
