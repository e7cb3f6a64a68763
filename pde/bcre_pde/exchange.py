r"""The exchange law, in one place: what leaves the static layer and joins the rolling one.

    E = -X(R) (gamma u_x + kappa u_xx),   u = h + Sc x,   so that gamma R (S - Sc) = -gamma R u_x

with X(R) = R+ = max(R, 0), or X(R) = R+/(1 + gamma R+/v_up) for thick flows, in which only the
grains next to the static layer exchange (Bouchaud et al. 1994; Boutreux, Raphaël and de Gennes
1998). A layer that has undershot zero exchanges nothing: a negative one would grow on any slope
above repose.

A term that a material does not have is None. Numba compiles a version of the code without it,
instead of multiplying by zero.
"""

from __future__ import annotations

from typing import Any

from bcre_pde.inner import inner


@inner
def exchanging(R: Any, saturation: float | None) -> Any:
    """X(R), the part of the layer that exchanges; ``saturation`` is gamma/v_up or None."""
    wet = max(R, 0.0)
    if saturation is None:
        return wet
    return wet / (1.0 + saturation * wet)


@inner
def exchange(R, gradient, curvature, gamma, kappa, saturation):
    """E of one cell.

    Parameters
    ----------
    R: rolling layer, a length.
    gradient, curvature: u_x and u_xx there, in any unit in which ``gamma gradient`` and
        ``kappa curvature`` are rates, 1/time.
    gamma: exchange rate.
    kappa: curvature term, or None.
    saturation: gamma/v_up, 1/length, or None for the linear law.
    """
    if kappa is None:
        return -exchanging(R, saturation) * (gamma * gradient)
    return -exchanging(R, saturation) * (gamma * gradient + kappa * curvature)
