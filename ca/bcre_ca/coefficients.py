"""The rule's constants per step and cell, which every path of the automaton computes with.

The functions here run as Python and compiled: where the step follows its bounds, the constants are
folded anew inside the compiled loop. Terms that a rule does without are None
(:mod:`bcre_ca.absent`).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

from numba.extending import overload, register_jitable

from bcre_ca.absent import or_else, over, plus, times
from bcre_ca.exchange import exchanging


class Upwind(NamedTuple):
    """The paper's differences, of first order."""


class Calibrated(NamedTuple):
    """Upwind, less the diffusion and the curvature that upwind differences add."""


class Limited(NamedTuple):
    """Second order with limited slopes."""


class InPlace(NamedTuple):
    """Upwind, cells updated in place one after the other, downhill or uphill."""

    downhill: bool


CompiledScheme = Upwind | Calibrated | Limited | InPlace
"""A scheme is a type, so that each is compiled by itself."""


def by_scheme(default: Callable[..., Any], others: dict[type, Callable[..., Any]]) -> Any:
    """A function whose body is chosen by the scheme, its last argument.

    Python chooses at each call, the compiler once.
    """

    def chosen(*arguments: Any) -> Any:
        return others.get(type(arguments[-1]), default)(*arguments)

    def compiled(*arguments: Any) -> Any:
        return others.get(arguments[-1].instance_class, default)

    overload(chosen, strict=False)(compiled)
    return chosen


class Parameters(NamedTuple):
    """A :class:`bcre_ca.Rule` without its dt, as compiled code takes it.

    ``repose_slope`` is the slope at which the exchange vanishes.
    """

    v: float
    D: float | None
    gamma: float
    repose_slope: float
    d: float
    kappa: float | None = None
    v_up: float | None = None
    dry: float | None = None
    scheme: CompiledScheme = Upwind()


class Coefficients(NamedTuple):
    """The constants of a step, without units except where given.

    courant: v dt/d.
    diffusion: D dt/d^2; in a calibrated rule what the diffusion of the upwind flux,
        courant (1 - courant)/2, leaves of it, never less than 0.
    outgoing: courant + diffusion, the part of R that leaves a cell.
    exchange: gamma dt/d, 1/length.
    repose_drop: ±Sc d, the drop to the next cell at repose (minus for the printed sign), a length.
    saturation: gamma/v_up, 1/length.
    curvature: kappa dt/d^2, 1/length.
    wave_correction: exchange/2 in a calibrated rule, which takes the rule's own curvature
        (gamma d/2)(1 - exchange X) back: the surface wave becomes that of Lax and Wendroff.
    dry: thickness below which a layer comes to rest, a length.
    emptying: steps in which a cell would empty, 1/(courant + 2 diffusion); absent without ``dry``.
    """

    courant: float
    diffusion: float | None
    outgoing: float
    exchange: float
    repose_drop: float
    saturation: float | None
    curvature: float | None
    wave_correction: float | None
    dry: float | None
    emptying: float | None
    scheme: CompiledScheme


def row_of(terms: Parameters | Coefficients) -> list[float]:
    """The terms as numbers, without the scheme; 0 for an absent one."""
    *numbers, _ = terms
    return [0.0 if number is None else number for number in numbers]


@register_jitable
def coefficients_in(row: Any, like: Coefficients) -> Coefficients:
    """What :func:`row_of` has made a row of; ``like`` says which terms are absent."""
    return Coefficients(
        row[0],
        _unless_absent(like.diffusion, row[1]),
        row[2],
        row[3],
        row[4],
        _unless_absent(like.saturation, row[5]),
        _unless_absent(like.curvature, row[6]),
        _unless_absent(like.wave_correction, row[7]),
        _unless_absent(like.dry, row[8]),
        _unless_absent(like.emptying, row[9]),
        like.scheme,
    )


@register_jitable
def parameters_in(row: Any, scheme: CompiledScheme) -> Parameters:
    """What :func:`row_of` has made a row of, where no term is absent."""
    return Parameters(row[0], row[1], row[2], row[3], row[4], row[5], row[6], row[7], scheme)


@register_jitable
def _unless_absent(like: Any, value: float) -> Any:
    if like is None:
        return None
    return value


@register_jitable
def fold(p: Parameters, dt: float) -> Coefficients:
    """The coefficients of a step dt.

    d d and not d**2, which Python and the compiler round differently for one d in a thousand.
    """
    courant = p.v * dt / p.d
    exchange = p.gamma * dt / p.d
    diffusion = _diffusion_left(over(times(p.D, dt), p.d * p.d), courant, p.scheme)
    outgoing = plus(courant, diffusion)
    return Coefficients(
        courant,
        diffusion,
        outgoing,
        exchange,
        p.repose_slope * p.d,
        over(p.gamma, p.v_up),
        times(p.kappa, dt / (p.d * p.d)),
        _wave_correction(exchange, p.scheme),
        p.dry,
        emptying_steps(plus(outgoing, diffusion), p.dry),
        p.scheme,
    )


@register_jitable
def emptying_steps(leaving: Any, dry: Any) -> Any:
    """Steps in which a cell empties that loses the part ``leaving`` in each; 1 where none does."""
    if dry is None:
        return None
    return 1.0 / leaving if leaving > 0 else 1.0


def _diffusion_of_calibrated(diffusion: Any, courant: float, scheme: Calibrated) -> Any:
    if diffusion is None:
        return None
    return max(diffusion - courant * (1.0 - courant) / 2, 0.0)


_diffusion_left = by_scheme(
    lambda diffusion, courant, scheme: diffusion, {Calibrated: _diffusion_of_calibrated}
)
_wave_correction = by_scheme(
    lambda exchange, scheme: None, {Calibrated: lambda exchange, scheme: exchange / 2}
)


@register_jitable
def every_term(p: Parameters) -> Parameters:
    """The same rule with no term absent, for what need not be compiled for each choice of terms."""
    return Parameters(
        p.v,
        or_else(p.D, 0.0),
        p.gamma,
        p.repose_slope,
        p.d,
        or_else(p.kappa, 0.0),
        or_else(p.v_up, math.inf),
        or_else(p.dry, 0.0),
        p.scheme,
    )


@register_jitable
def largest_step(p: Parameters, largest_R: float, sink: float) -> float:
    """Largest dt that keeps R >= 0 and the surface wave stable; see :mod:`bcre_ca.theory`.

    Parameters
    ----------
    largest_R: largest rolling layer, a length.
    sink: fastest loss per unit of layer, max(kappa h_xx - gamma (S - Sc), 0), 1/time.
    """
    X = exchanging(largest_R, over(p.gamma, p.v_up))
    drift, spread = p.v / p.d, or_else(over(p.D, p.d**2), 0.0)
    climb, bending = p.gamma / p.d * X, or_else(over(times(p.kappa, X), p.d**2), 0.0)
    largest: float = _bound(drift, spread, sink, climb, bending, p.scheme)
    return largest


def _bound_of_upwind(
    drift: float, spread: float, sink: float, climb: float, bending: float, scheme: CompiledScheme
) -> Any:
    return min(_inverse(drift + 2 * spread + sink), _inverse(climb + 2 * bending))


def _bound_of_calibrated(
    drift: float, spread: float, sink: float, climb: float, bending: float, scheme: CompiledScheme
) -> Any:
    of_layer = min(_inverse(drift + sink), _step_of_quadratic(drift, 2 * spread + sink))
    return min(of_layer, _step_of_quadratic(climb, 2 * bending))


def _bound_of_limited(
    drift: float, spread: float, sink: float, climb: float, bending: float, scheme: CompiledScheme
) -> Any:
    return min(_inverse(drift + 2 * spread + sink) / 2, _inverse(climb + 2 * bending))


def _bound_in_place(
    drift: float, spread: float, sink: float, climb: float, bending: float, scheme: InPlace
) -> Any:
    passing = climb + drift + spread if scheme.downhill else climb
    return min(_inverse(drift + 2 * spread + sink), _inverse(passing))


_bound = by_scheme(
    _bound_of_upwind,
    {Calibrated: _bound_of_calibrated, Limited: _bound_of_limited, InPlace: _bound_in_place},
)


@register_jitable
def _step_of_quadratic(p: float, q: float) -> float:
    """Largest t with (p t)^2 + q t <= 1."""
    step: float = 2.0 * _inverse(q + math.sqrt(q * q + 4 * p * p))
    return step


@register_jitable
def _inverse(rate: float) -> float:
    return 1.0 / rate if rate > 0 else math.inf
