r"""One step of the limited scheme in plain NumPy: second order where the layers are smooth.

The printed rule takes a cell's own R as the layer that leaves it, and the drop to the next cell as
its slope. Both are of first order. Here every cell also has two limited slopes, r of R and g of the
drop beyond repose w(i) = h(i) - h(i+1) - Sc d, and the step is taken at mid-time (Hancock's form,
van Leer 1979):

    R*(i) = R(i) + (1/2) ( -(v dt/d) r(i) + (D dt/d^2) (R(i+1) - 2 R(i) + R(i-1)) + e(i) )
    h*(i) = h(i) - (1/2) e(i)                                   e(i) = (gamma dt/d) R(i) g(i)
    F(i)  = v (R*(i) + r(i)/2) - D (R*(i+1) - R*(i))/d          flux from cell i to cell i+1
    E(i)  = (gamma/d) R*(i) (h*(i) - h*(i+1) - Sc d + (g(i) - g(i+1))/2)
    R(i) += dt/d (F(i-1) - F(i)) + dt E(i)
    h(i) -= dt E(i)

The height at a face comes from downhill, as the surface wave does. A step reads two neighbours on
each side. R* and R* + r/2 are kept between 0 and 2 R(i), which changes no smooth layer in a stable
step and keeps R >= 0 while 2 (v dt/d + 2 D dt/d^2 + sink dt) <= 1.

The functions of one cell are those that the compiled kernel calls; here they take whole layers.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba.extending import overload
from numpy.typing import NDArray

from bcre_ca.absent import minus, times
from bcre_ca.coefficients import Coefficients
from bcre_ca.exchange import deposit_thin, eroded
from bcre_ca.inner import inner
from bcre_ca.line.drops import drops

Array = NDArray[np.float64]


def step(
    h: Array, R: Array, K: Coefficients, period_drop: float | None
) -> tuple[Array, Array, float]:
    """The layers after one step and what left through the foot.

    Parameters
    ----------
    h, R: static and rolling layer, lengths, shape (N,).
    K: the rule's coefficients.
    period_drop: see :func:`bcre_ca.line.drops.period_drop`; None for open ends.
    """
    periodic = period_drop is not None
    R_above, R_below = _differences(R, periodic)
    h_mid, R_mid, R_face, g = predicted(
        h, R, *drops(h, K.repose_drop, period_drop), R_above, R_below, K
    )
    above, below = drops(h_mid, K.repose_drop, period_drop)
    flux_out = face_flux(R_face, _differences(R_mid, periodic)[1], K)
    flux_in = np.append(flux_out[-1], flux_out[:-1])
    face_drop = below + 0.5 * (g - np.append(g[1:], g[0]))
    outflow = 0.0
    if not periodic:
        outflow, face_drop[-1], flux_in[0] = float(flux_out[-1]), 0.0, 0.0
    h, R = corrected(h, R, R_mid, flux_in, flux_out, face_drop, above - below, K)
    return h, R, outflow


def _differences(R: Array, periodic: bool) -> tuple[Array, Array]:
    """R(i) - R(i-1) and R(i+1) - R(i); 0 across open ends."""
    between = R[1:] - R[:-1]
    across = R[0] - R[-1] if periodic else 0.0
    return np.append(across, between), np.append(between, across)


@inner
def predicted(
    h: Any, R: Any, above: Any, below: Any, R_above: Any, R_below: Any, K: Coefficients
) -> tuple[Any, Any, Any, Any]:
    """h* and R*, the layer R* + r/2 at the face downhill, and g."""
    r = limited_slope(R_above, R_below)
    g = limited_slope(above, below)
    change = eroded(R, g, above - below, K)
    drifted = -face_flux(r, R_below - R_above, K)
    R_mid = _within(R + 0.5 * (drifted + change), 2.0 * R)
    return h - 0.5 * change, R_mid, _within(R_mid + 0.5 * r, 2.0 * R), g


@inner
def face_flux(R_face: Any, rise: Any, K: Coefficients) -> Any:
    """dt/d F through a face with the layer R_face, across which R rises."""
    return minus(K.courant * R_face, times(K.diffusion, rise))


@inner
def corrected(
    h: Any, R: Any, R_mid: Any, flux_in: Any, flux_out: Any, drop: Any, bend: Any, K: Coefficients
) -> Any:
    """The new layers, from fluxes and slopes at mid-time."""
    change = eroded(R_mid, drop, bend, K)
    return deposit_thin(h - change, R + ((flux_in - flux_out) + change), R, K.dry, K.emptying)


@inner
def limited_slope(a: Any, b: Any) -> Any:
    """Mean of two neighbouring differences, at most twice the smaller one, and 0 where their signs
    differ (monotonized central, van Leer 1977)."""
    mean = 0.5 * (a + b)
    rising = larger(smaller(2.0 * smaller(a, b), mean), 0.0)
    return rising + smaller(larger(2.0 * larger(a, b), mean), 0.0)


@inner
def _within(value: Any, highest: Any) -> Any:
    return larger(smaller(value, highest), 0.0)


def _minimum(a, b):
    return np.minimum(a, b)


def _maximum(a, b):
    return np.maximum(a, b)


@overload(_minimum)
def _minimum_of_cells(a, b):
    # NumPy's own also looks for NaN, which costs a third of the speed.
    return lambda a, b: min(a, b)


@overload(_maximum)
def _maximum_of_cells(a, b):
    return lambda a, b: max(a, b)


smaller: Any = _minimum
larger: Any = _maximum
