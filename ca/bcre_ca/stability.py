"""The largest stable step of every scheme, as Python and compiled alike."""

from __future__ import annotations

import math
from typing import Any

from bcre_ca.absent import or_else, over, plus, times
from bcre_ca.coefficients import Parameters
from bcre_ca.exchange import exchanging
from bcre_ca.inner import inner
from bcre_ca.schemes import (
    Calibrated,
    CompiledScheme,
    InContainer,
    InPlace,
    Limited,
    SlopeDriven,
    by_scheme,
)


@inner
def largest_step(p: Parameters, largest_R: float, sink: float) -> float:
    """Largest dt that keeps R >= 0 and the surface wave stable; see :mod:`bcre_ca.theory`.

    Parameters
    ----------
    largest_R: largest rolling layer, a length.
    sink: fastest loss per unit of layer, max(kappa h_xx - gamma (S - Sc), 0), 1/time.
    """
    X = exchanging(largest_R, over(p.gamma, p.v_up))
    drift, spread = plus(p.v, times(p.Gamma, largest_R)) / p.d, or_else(over(p.D, p.d**2), 0.0)
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


def _bound_in_container(
    drift: float, spread: float, sink: float, climb: float, bending: float, scheme: InContainer
) -> Any:
    bound = min(_inverse(drift + 2 * spread + sink), _inverse(climb + 2 * bending))
    return min(bound, scheme.longest)


def _bound_of_slope_driven(
    drift: float, spread: float, sink: float, climb: float, bending: float, scheme: SlopeDriven
) -> Any:
    return min(_inverse(2 * spread + sink + climb), scheme.longest)


_bound = by_scheme(
    _bound_of_upwind,
    {
        Calibrated: _bound_of_calibrated,
        Limited: _bound_of_limited,
        InPlace: _bound_in_place,
        InContainer: _bound_in_container,
        SlopeDriven: _bound_of_slope_driven,
    },
)


@inner
def _step_of_quadratic(p: float, q: float) -> float:
    """Largest t with (p t)^2 + q t <= 1."""
    step: float = 2.0 * _inverse(q + math.sqrt(q * q + 4 * p * p))
    return step


@inner
def _inverse(rate: float) -> float:
    return 1.0 / rate if rate > 0 else math.inf
