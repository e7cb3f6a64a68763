"""The rule's constants, folded per step and cell: what every path of the automaton computes with.

An absent term is None rather than 0: the type of None tells the compiler to leave it out. The
functions here run as Python and compiled alike, since a step that follows its bounds is folded
anew inside the compiled loop.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from numba.extending import register_jitable

from bcre_ca.exchange import exchanging


class Parameters(NamedTuple):
    """A :class:`bcre_ca.Rule` without its dt, as compiled code takes it.

    ``slope`` is the one at which the exchange vanishes. ``D``, ``kappa``, ``v_up`` and ``dry`` are
    None where the rule does without; ``calibrated``, ``limited`` and ``downhill``, for cells
    updated in place one after the other downhill, are None or True.
    """

    v: float
    D: float | None
    gamma: float
    slope: float
    d: float
    kappa: float | None
    v_up: float | None
    dry: float | None
    calibrated: bool | None
    limited: bool | None
    downhill: bool | None = None


class Coefficients(NamedTuple):
    """``c = v dt/d``, ``b = D dt/d^2``, ``q = c + b``, ``k = gamma dt/d`` and ``s = ±Sc d`` (minus
    for the printed sign); ``a``, ``m`` and ``u`` as :func:`bcre_ca.exchange.eroded` takes them, and
    the thickness ``dry`` below which a layer comes to rest.

    The flux out of cell i is ``q R(i) - b R(i+1)`` and the exchange ``R(i) (k (h(i) - h(i+1) -
    s))``, in this order of operations. In a calibrated rule b is what the diffusion of the upwind
    flux, (c/2)(1 - c), leaves of D dt/d^2, never less than 0. Without D, b is None.
    """

    c: float
    b: float | None
    q: float
    k: float
    s: float
    a: float | None
    m: float | None
    u: float | None
    dry: float | None


@register_jitable
def fold(p: Parameters, dt: float) -> Coefficients:
    """The coefficients of a step dt.

    d d and not d**2, which Python and the compiler round differently for one d in a thousand.
    """
    c = p.v * dt / p.d
    b = _diffusion(_scaled_before(p.D, dt, p.d * p.d), c, p.calibrated)
    k = p.gamma * dt / p.d
    return Coefficients(
        c,
        b,
        _sum(c, b),
        k,
        p.slope * p.d,
        _saturation(p.gamma, p.v_up),
        _scaled(p.kappa, dt / (p.d * p.d)),
        _scaled(p.calibrated, k / 2),
        p.dry,
    )


@register_jitable
def _diffusion(b: Any, c: float, calibrated: bool | None) -> Any:
    if b is None:
        return None
    if calibrated is None:
        return b
    return max(b - c * (1.0 - c) / 2, 0.0)


@register_jitable
def _saturation(gamma: float, v_up: Any) -> Any:
    if v_up is None:
        return None
    return gamma / v_up


@register_jitable
def _scaled_before(value: Any, factor: float, divisor: float) -> Any:
    if value is None:
        return None
    return value * factor / divisor


@register_jitable
def _sum(c: float, b: Any) -> float:
    if b is None:
        return c
    total: float = c + b
    return total


@register_jitable
def _scaled(value: Any, factor: float) -> Any:
    if value is None:
        return None
    return value * factor


@register_jitable
def largest_step(p: Parameters, largest_R: float, sink: float) -> float:
    """Largest dt that keeps R >= 0 and the surface wave stable; see :mod:`bcre_ca.theory`.

    Parameters
    ----------
    largest_R: largest rolling layer, a length.
    sink: fastest loss per unit of layer, max(kappa h_xx - gamma (S - Sc), 0), 1/time.
    """
    X = exchanging(largest_R, _saturation(p.gamma, p.v_up))
    largest: float = _largest_step(
        p.v / p.d,
        _over(p.D, p.d**2),
        p.gamma / p.d * X,
        _curvature_rate(X, p.d, p.kappa),
        sink,
        p.calibrated,
        p.limited,
        p.downhill,
    )
    return largest


@register_jitable
def _over(D: float | None, area: float) -> float:
    if D is None:
        return 0.0
    return D / area


@register_jitable
def _curvature_rate(X: float, d: float, kappa: float | None) -> float:
    if kappa is None:
        return 0.0
    return kappa * X / d**2


@register_jitable
def _largest_step(
    drift: float,
    spread: float,
    climb: float,
    bending: float,
    sink: float,
    calibrated: bool | None,
    limited: bool | None,
    downhill: bool | None,
) -> float:
    of_layer: float = _inverse(drift + 2 * spread + sink)
    of_wave: float = _inverse(climb + 2 * bending)
    if limited is not None:
        of_layer = of_layer / 2
    if calibrated is not None:
        of_layer = min(_inverse(drift + sink), _step_of_quadratic(drift, 2 * spread + sink))
        of_wave = _step_of_quadratic(climb, 2 * bending)
    if downhill is not None:
        of_wave = _inverse(climb + drift + spread)
    return min(of_layer, of_wave)


@register_jitable
def _step_of_quadratic(p: float, q: float) -> float:
    """Largest t with (p t)^2 + q t <= 1."""
    step: float = 2.0 * _inverse(q + math.sqrt(q * q + 4 * p * p))
    return step


@register_jitable
def _inverse(rate: float) -> float:
    return 1.0 / rate if rate > 0 else math.inf
