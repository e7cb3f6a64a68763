r"""The exchange law, in one place: what a step erodes from h and adds to R; and the flux of R.

    dt E = X(R) (gamma dt (S - Sc) - kappa dt h_xx)

with X(R) = R, or X(R) = R/(1 + gamma R/v_up) for thick flows, in which only the grains next to the
static layer exchange (Boutreux, Raphaël and de Gennes 1998). A term that a scene does not need is
None, and the compiled code then does not hold it; the plain step calls the same lines with arrays.
"""

from __future__ import annotations

from typing import Any

from numba.extending import register_jitable


@register_jitable
def exchanging(R: Any, a: float | None) -> Any:
    """X(R), the part of the layer that exchanges; ``a`` is gamma/v_up or None."""
    if a is None:
        return R
    return R / (1.0 + a * R)


@register_jitable
def eroded(
    R: Any, drop: Any, bend: Any, k: float, a: float | None, m: float | None, u: float | None
) -> Any:
    """dt E of cells with layer R.

    Parameters
    ----------
    R: rolling layer, a length.
    drop: fall to the next cell beyond that at repose, h(i) - h(i+1) - Sc d.
    bend: h(i-1) - 2 h(i) + h(i+1).
    k: gamma dt/d.
    a: gamma/v_up, or None for the linear law.
    m: kappa dt/d^2, or None without curvature.
    u: k/2 to take the rule's own curvature (gamma d/2)(1 - k X) back, which makes the surface wave
        that of Lax and Wendroff; None to leave it.
    """
    X = exchanging(R, a)
    if u is None:
        if m is None:
            return X * (k * drop)
        return X * (k * drop - m * bend)
    if m is None:
        return X * (k * drop + (u * (1.0 - k * X)) * bend)
    return X * (k * drop + (u * (1.0 - k * X) - m) * bend)


@register_jitable
def carried(R: Any, R_next: Any, q: float, b: float | None) -> Any:
    """dt/d F, what leaves a cell of layer R for the next one; ``b`` is None without diffusion."""
    if b is None:
        return q * R
    return q * R - b * R_next


@register_jitable
def spread(difference: Any, b: float | None) -> Any:
    """b times a difference of layers; 0 without diffusion."""
    if b is None:
        return 0.0
    return b * difference


@register_jitable
def settle(h: Any, R: Any, dry: float | None) -> tuple[Any, Any]:
    """h and R after a layer thinner than ``dry`` has come to rest; mass stays.

    A truth value times a number rather than a branch, so that arrays and cells are treated alike.
    """
    if dry is None:
        return h, R
    left = R * (dry > R)
    return h + left, R - left
