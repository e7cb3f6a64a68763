r"""One step on a tilted plane, in plain NumPy: the executable definition of the rule there.

x runs downhill along i, y across along j. The rule of the line acts along x, diffusion alone
across:

    F(i,j) = v R(i,j) - D (R(i+1,j) - R(i,j))/d             flux from cell (i, j) to (i+1, j)
    G(i,j) = - D_across (R(i,j+1) - R(i,j))/d               flux from cell (i, j) to (i, j+1)
    E(i,j) = gamma R(i,j) ((h(i,j) - h(i+1,j))/d - Sc)      eroded from h, added to R
    R(i,j) += dt/d (F(i-1,j) - F(i,j) + G(i,j-1) - G(i,j)) + dt E(i,j)
    h(i,j) -= dt E(i,j)

everything read from the old state (the avalanches of Bouchaud and Cates 1998, in cells). Nothing
flows through a wall or a closed side, and the surface does not drop towards it. At an open foot R
leaves by advection and the surface goes on at the repose slope.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bcre_ca.plane.coefficients import Coefficients
from bcre_ca.plane.ghosts import BELOW, LEFT, RIGHT, around
from bcre_ca.plane.law import changed, eroded, gate_between, gated
from bcre_ca.plane.setting import Plane

Array = NDArray[np.float64]


def step(
    h: Array, R: Array, free: Array, base: Array, plane: Plane, K: Coefficients
) -> tuple[Array, Array, float]:
    """The new layers, and what left through the foot in units of R."""
    Q, Z = around(R, plane), around(free, plane)
    out_along = gated(K.outgoing * R - K.diffusion * Q[BELOW], gate_between(free, Z[BELOW]))
    if plane.ends != "periodic":
        out_along[-1] = K.courant * R[-1] * (plane.ends == "open")
    in_along, outflow = np.roll(out_along, 1, axis=0), 0.0
    if plane.ends != "periodic":
        in_along[0], outflow = 0, float(out_along[-1].sum(dtype=float))
    in_across = gated(K.across * (Q[LEFT] - R), gate_between(Z[LEFT], free))
    out_across = gated(K.across * (R - Q[RIGHT]), gate_between(free, Z[RIGHT]))

    erosion = eroded(R, excess(h, free, plane, K), h, base, K)
    h, R = changed(h, R, in_along - out_along, in_across - out_across, erosion, K)
    return h, R, outflow


def excess(h: Array, free: Array, plane: Plane, K: Coefficients) -> Array:
    """The drop to the next cell downhill beyond that at repose."""
    H, Z = around(h, plane, plane.fall_of(len(h))), around(free, plane)
    beyond: Array = gated(h - H[BELOW], gate_between(free, Z[BELOW])) - K.repose_drop
    if plane.ends != "periodic":
        beyond[-1] = 0 if plane.ends == "open" else -K.repose_drop
    return beyond
