r"""The exchange law and the flux of the rolling layer, each in one place.

    dt E   = X(R) (gamma dt (S - Sc) - kappa dt h_xx)         eroded from h and added to R in a step
    dt/d F = (v dt/d + D dt/d^2) R(i) - (D dt/d^2) R(i+1)     carried from cell i to cell i+1

In thick flows only the grains next to the static layer exchange, X(R) = R/(1 + gamma R/v_up)
instead of R (Boutreux, Raphaël and de Gennes 1998), and those above move faster, by Gamma a height:
the layer then carries v R + Gamma R^2/2 (Aradian, Raphaël and de Gennes 1999).

K stands for the :class:`bcre_ca.coefficients.Coefficients`. The plain step calls these functions
with arrays, the compiled one with single cells.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from bcre_ca.absent import minus, plus, times
from bcre_ca.inner import inner

if TYPE_CHECKING:
    from bcre_ca.coefficients import Coefficients


@inner
def exchanging(R: Any, saturation: float | None) -> Any:
    """X(R), the part of the layer that exchanges; ``saturation`` is gamma/v_up."""
    if saturation is None:
        return R
    return R / (1.0 + saturation * R)


@inner
def eroded(R: Any, drop: Any, bend: Any, K: Coefficients) -> Any:
    """dt E of cells with layer R.

    Parameters
    ----------
    R: rolling layer, a length.
    drop: fall to the next cell beyond that at repose, h(i) - h(i+1) - Sc d.
    bend: h(i-1) - 2 h(i) + h(i+1).
    """
    X = exchanging(R, K.saturation)
    correction = times(K.wave_correction, 1.0 - K.exchange * X)
    return X * plus(K.exchange * drop, times(minus(correction, K.curvature), bend))


@inner
def eroded_at_foot(R: Any, bend: Any, K: Coefficients) -> Any:
    """dt E of the last cell: the surface goes on at repose, so that only its curvature acts."""
    return exchanging(R, K.saturation) * minus(0.0, times(K.curvature, bend))


@inner
def carried(R: Any, R_next: Any, K: Coefficients) -> Any:
    """dt/d F, what leaves a cell of layer R for the next one downhill."""
    return _thickened(minus(K.outgoing * R, times(K.diffusion, R_next)), R, K.thickening)


@inner
def leaving(R: Any, K: Coefficients) -> Any:
    """dt/d F, what leaves the last cell through an open foot, beyond which R is the same."""
    return _thickened(K.courant * R, R, K.thickening)


@inner
def _thickened(flux: Any, R: Any, thickening: float | None) -> Any:
    if thickening is None:
        return flux
    return flux + thickening * (R * R)


@inner
def deposit_thin(
    h: Any, R: Any, R_before: Any, dry: float | None, emptying: float | None
) -> tuple[Any, Any]:
    """h and R after a thin layer has come to rest; mass stays.

    A layer comes to rest where it is thinner than ``dry``, and still would be if it went on
    changing as in this step for the time in which a cell empties. That time, 1/(v/d + 2 D/d^2), is
    no shorter than a stable step and does not depend on it: a cell that fills from a thick layer
    gains less than any ``dry`` in a short step, and must not be emptied after each of them.

    Parameters
    ----------
    h, R: the layers after a step, lengths.
    R_before: the rolling layer before it.
    dry: thickness, a length; None where no layer comes to rest.
    emptying: steps in which a cell empties.
    """
    if dry is None:
        return h, R
    coming = R_before + emptying * (R - R_before)
    # A factor, not a branch, so that arrays and cells are treated alike.
    thin = R * ((dry > R) & (dry > coming))
    return h + thin, R - thin
