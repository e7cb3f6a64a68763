r"""One step on a free surface, down the steepest of eight facets: the executable definition.

A cell, a neighbour along an axis and the diagonal one next to it span a facet. With the drops
a to the former and b from the former to the latter it dips at the angle tan alpha = b/a from the
axis, kept between 0 and 45 degrees, with the slope S = sqrt(a^2 + b^2)/d. On the steepest facet

    F(axis) = v R (cos alpha - sin alpha),  F(diagonal) = v R sin alpha,  less the diffusion
    E       = gamma R (S - Sc)

(Tarboton's D-infinity, 1997, with v along the dip); the first of equally steep facets counts.
``d8`` goes straight: alpha is 0 or 45 degrees. A wall and a closed side are as high as the cell
before them, and a facet with a wall at its axis carries nothing.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from bcre_ca.inner import inner
from bcre_ca.plane.coefficients import FLOWS, Coefficients
from bcre_ca.plane.ghosts import around
from bcre_ca.plane.law import changed, either, eroded, gate_between, gated, larger
from bcre_ca.plane.setting import Plane

Array = NDArray[np.float64]
Offset = tuple[int, int]

FACETS: tuple[tuple[Offset, Offset], ...] = (
    ((-1, 0), (-1, -1)),
    ((-1, 0), (-1, 1)),
    ((1, 0), (1, -1)),
    ((1, 0), (1, 1)),
    ((0, -1), (-1, -1)),
    ((0, -1), (1, -1)),
    ((0, 1), (-1, 1)),
    ((0, 1), (1, 1)),
)
"""Steps (i, j) to the neighbour along the axis and to the diagonal one."""

NEIGHBOURS = ((-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1))
"""In the order in which what they send is added."""


@inner
def dip(along: Any, diagonal: Any, gate: Any, half: Any, is_straight: bool) -> tuple[Any, Any, Any]:
    """Squared slope times d^2 of a facet, and the drops a and b along its dip.

    ``along`` and ``diagonal`` are the drops to the two neighbours; ``gate`` is 0 where no sand can
    go to the diagonal one; ``half`` is 1/2 in their number type.
    """
    nothing = along - along
    lower = gated(diagonal, gate)
    middle = half * lower
    beyond = gated(lower - along, gate)
    axis, corner = larger(along, nothing), larger(lower, nothing)
    is_diagonal = either(is_straight, half * (corner * corner) > axis * axis, beyond >= along)
    beyond = either(is_straight, nothing, larger(beyond, nothing))
    a, b = either(is_diagonal, middle, along), either(is_diagonal, middle, beyond)
    return either(a > nothing, a * a + b * b, nothing), a, b


def step(
    h: Array, R: Array, free: Array, base: Array, plane: Plane, K: Coefficients
) -> tuple[Array, Array, float]:
    """The new layers, and what left through the foot in units of R."""
    steepness, a, b, facet = _steepest(h, free, plane, K)
    is_steep = steepness > K.least_drop
    speed = np.where(is_steep, K.courant * R / np.where(is_steep, steepness, 1), 0)
    parts = (speed * (a - b)).astype(h.dtype), (speed * b).astype(h.dtype)

    inflow, outflow = np.zeros_like(R), 0.0
    for i, j in NEIGHBOURS:
        sent = _sent((-i, -j), facet, parts)
        inflow = inflow + _seen(_with_nothing_around(sent, plane), (i, j))
        if i == -1 and plane.ends != "periodic":
            outflow += float(sent[-1].sum(dtype=float))
    Q, Z = around(R, plane), around(free, plane)
    diffused = _diffused(Q, Z, (1, 0), K.diffusion) + _diffused(Q, Z, (0, 1), K.across)

    erosion = eroded(R, steepness - K.repose_drop, h, base, K)
    h, R = changed(h, R, inflow - (parts[0] + parts[1]), diffused, erosion, K)
    return h, R, outflow


def excess(h: Array, free: Array, plane: Plane, K: Coefficients) -> Array:
    """S d beyond that at repose."""
    beyond: Array = _steepest(h, free, plane, K)[0] - K.repose_drop
    return beyond


def _steepest(h: Array, free: Array, plane: Plane, K: Coefficients) -> tuple[Array, ...]:
    """S d of the steepest facet, the drops a and b along its dip, and its number."""
    H, Z = around(h, plane, plane.fall_of(len(h)), K.foot_drop), around(free, plane)
    squared, a, b, facet = (np.zeros_like(h) for _ in range(4))
    for number, (axis, corner) in enumerate(FACETS):
        gate = gate_between(free, _seen(Z, axis))
        along, diagonal = gated(h - _seen(H, axis), gate), h - _seen(H, corner)
        gate = gate_between(gate, _seen(Z, corner))
        found = dip(along, diagonal, gate, K.half, K.flow == FLOWS["d8"])
        is_better = found[0] > squared
        squared, a, b, facet = (
            np.where(is_better, new, old)
            for new, old in zip((*found, number), (squared, a, b, facet), strict=True)
        )
    return np.sqrt(squared), a, b, facet


def _seen(padded: Array, offset: Offset) -> Array:
    """What each cell sees at this offset."""
    (i, j), (rows, columns) = offset, padded.shape
    return padded[1 + i : rows - 1 + i, 1 + j : columns - 1 + j]


def _sent(to: Offset, facet: Array, parts: tuple[Array, Array]) -> Array:
    """What each cell sends in one direction."""
    sent = np.zeros_like(parts[0])
    for number, directions in enumerate(FACETS):
        for direction, part in zip(directions, parts, strict=True):
            if direction == to:
                sent = np.where(facet == number, part, sent)
    return sent


def _with_nothing_around(sent: Array, plane: Plane) -> Array:
    padded = around(sent, plane)
    if plane.ends != "periodic":
        padded[[0, -1]] = 0
    if plane.sides != "periodic":
        padded[:, [0, -1]] = 0
    return padded


def _diffused(Q: Array, Z: Array, to: Offset, diffusion: float) -> Array:
    """What diffuses into each cell along one axis."""

    def through(one: Offset, other: Offset) -> Array:
        gate = gate_between(_seen(Z, one), _seen(Z, other))
        flux: Array = gated(diffusion * (_seen(Q, one) - _seen(Q, other)), gate)
        return flux

    return through((-to[0], -to[1]), (0, 0)) - through((0, 0), to)
