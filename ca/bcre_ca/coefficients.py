"""The rule's constants per step and cell, which every path of the automaton computes with.

The functions here run as Python and compiled: where the step follows its bounds, the constants are
folded anew inside the compiled loop. Terms that a rule does without are None
(:mod:`bcre_ca.absent`).
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from bcre_ca.absent import or_else, over, plus, times
from bcre_ca.inner import inner
from bcre_ca.schemes import (
    Calibrated,
    CompiledScheme,
    InContainer,
    SlopeDriven,
    Upwind,
    by_scheme,
)


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
    Gamma: float | None = None
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
    thickening: Gamma dt/(2 d), 1/length: what a thick layer R carries beyond courant R, over R^2.
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
    thickening: float | None
    scheme: CompiledScheme


def row_of(terms: Parameters | Coefficients) -> list[float]:
    """The terms as numbers, without the scheme; 0 for an absent one."""
    *numbers, _ = terms
    return [0.0 if number is None else number for number in numbers]


@inner
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
        _unless_absent(like.thickening, row[10]),
        like.scheme,
    )


@inner
def parameters_in(row: Any, scheme: CompiledScheme) -> Parameters:
    """What :func:`row_of` has made a row of, where no term is absent."""
    return Parameters(
        row[0], row[1], row[2], row[3], row[4], row[5], row[6], row[7], row[8], scheme
    )


@inner
def _unless_absent(like: Any, value: float) -> Any:
    if like is None:
        return None
    return value


@inner
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
        times(p.Gamma, dt / (2 * p.d)),
        _scheme_of_step(dt, p.scheme),
    )


@inner
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


_scheme_of_step = by_scheme(
    lambda dt, scheme: scheme,
    {
        InContainer: lambda dt, scheme: InContainer(
            scheme.supply * dt, scheme.ends, scheme.longest
        ),
        SlopeDriven: lambda dt, scheme: SlopeDriven(
            scheme.supply * dt, scheme.ends, scheme.longest, scheme.d
        ),
    },
)


@inner
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
        or_else(p.Gamma, 0.0),
        p.scheme,
    )
