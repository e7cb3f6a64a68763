r"""One step on a free surface, shared out among four neighbours: the executable definition.

With q(k) = max(h - h(k), 0)/d the drop to neighbour k, S = sqrt(sum q^2) the slope,

    F(k) = v R q(k)/S - D (R(k) - R)/d         flux to neighbour k, less the like one from there
    E    = gamma R (S - Sc)                    eroded from h, added to R
    R   += dt E - dt/d sum F(k)                h -= dt E

everything read from the old state. Between two cells sand runs from the higher one only, so that
each face carries one flux. A wall and a closed side are as high as the cell before them; beyond an
open foot the surface goes on at the repose slope.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bcre_ca.plane.coefficients import Coefficients
from bcre_ca.plane.ghosts import ABOVE, BELOW, HERE, LEFT, RIGHT, around
from bcre_ca.plane.law import changed, eroded, gate_between, gated, larger
from bcre_ca.plane.setting import Plane

Array = NDArray[np.float64]


def step(
    h: Array, R: Array, free: Array, base: Array, plane: Plane, K: Coefficients
) -> tuple[Array, Array, float]:
    """The new layers, and what left through the foot in units of R."""
    H, Q, Z = _surface(h, plane, K), around(R, plane), around(free, plane)
    steepness = _steepness(H, Z)
    is_steep = steepness > K.least_drop
    speed = np.where(is_steep, K.courant * R / np.where(is_steep, steepness, 1), 0)
    W = around(speed.astype(h.dtype), plane)

    def flux(one: tuple[slice, slice], other: tuple[slice, slice], diffusion: float) -> Array:
        """From the cells ``one`` to the cells ``other`` of the padded plane."""
        gate = gate_between(Z[one], Z[other])
        drop = gated(H[one] - H[other], gate)
        total: Array = drop * np.where(drop > 0, W[one], W[other])
        total += gated(diffusion * (Q[one] - Q[other]), gate)
        return total

    out_along = flux(HERE, BELOW, K.diffusion)
    in_along, outflow = np.roll(out_along, 1, axis=0), 0.0
    if plane.ends != "periodic":
        in_along[0], outflow = 0, float(out_along[-1].sum(dtype=float))
    net_across = flux(LEFT, HERE, K.across) - flux(HERE, RIGHT, K.across)

    erosion = eroded(R, steepness - K.repose_drop, h, base, K)
    h, R = changed(h, R, in_along - out_along, net_across, erosion, K)
    return h, R, outflow


def excess(h: Array, free: Array, plane: Plane, K: Coefficients) -> Array:
    """S d beyond that at repose."""
    return _steepness(_surface(h, plane, K), around(free, plane)) - K.repose_drop


def _surface(h: Array, plane: Plane, K: Coefficients) -> Array:
    return around(h, plane, plane.fall_of(len(h)), K.foot_drop)


def _steepness(H: Array, Z: Array) -> Array:
    """S d, the root of the squared drops to lower neighbours."""

    def squared(to: tuple[slice, slice]) -> Array:
        drop = larger(gated(H[HERE] - H[to], gate_between(Z[HERE], Z[to])), 0)
        product: Array = drop * drop
        return product

    root: Array = np.sqrt((squared(ABOVE) + squared(BELOW)) + (squared(LEFT) + squared(RIGHT)))
    return root
