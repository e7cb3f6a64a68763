r"""What closed forms predict of a thin pulse: how far apart the two models end.

On a frozen slope both models keep a Gaussian. With sigma = gamma (S0 - Sc), c = v dt/d,
b = D dt/d^2 and g = 1 + sigma dt, after n steps [derived from G(z)^n, ``bcre_ca.theory``]

                mass        mean        variance
    automaton   g^n         n c d/g     w^2/2 + n d^2 ((c + 2 b)/g - (c/g)^2)
    BCRE        e^(n sigma dt)  v t     w^2/2 + 2 D t

so that to first order they differ, in units of s^2 = w^2/2 + 2 D t, in

    width   r = v d (1 - c) t/s^2                               the automaton's own diffusion
    place   c d gamma (S0 - Sc) t/s                             the pulse lags
    mass    exp(-(gamma (S0 - Sc) t)^2 dt/(2 t))                and grows less: the Euler step

The relative L1 difference of Gaussians of variances s^2 and s^2 (1 + r) is, with x^2 = (1 + r)
ln(1 + r)/r where they cross,

    2 (erf(x/sqrt 2) - erf(x/sqrt(2 (1 + r)))) = 0.484 r - ...                 5 % at r = 0.109,

and of equal ones, one displaced by p s, 2 erf(p/(2 sqrt 2)). The three changes are even, odd and
even in x - v t with 2, 1 and 0 zeros, nearly orthogonal: their squares add.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq

from bcre_studies.comparison.verdict import Verdict
from bcre_studies.validation.agreement_map.pulses import Pulse

CELLS = 4001
"""Points of the sum that stands for the integral of the difference of two Gaussians."""


def by_width(r: float) -> float:
    """Relative L1 difference of Gaussians of variances s^2 and s^2 (1 + r)."""
    if r <= 0:
        return 0.0
    crossing = math.sqrt((1 + r) * math.log1p(r) / r)
    return 2 * (math.erf(crossing / math.sqrt(2)) - math.erf(crossing / math.sqrt(2 * (1 + r))))


def largest_broadening(tolerance: float) -> float:
    """The r at which :func:`by_width` reaches the tolerance."""
    return float(brentq(lambda r: by_width(r) - tolerance, 1e-9, 10.0))


def by_width_place_and_mass(pulse: Pulse) -> float:
    """The relative L1 difference from the three terms of first order, their squares added."""
    courant = pulse.duration / pulse.steps
    place = courant * abs(pulse.growth) / math.sqrt(pulse.final_variance)
    of_place = 2 * math.erf(place / (2 * math.sqrt(2)))
    of_mass = -math.expm1(-(pulse.growth**2) / (2 * pulse.steps))
    return math.hypot(by_width(pulse.broadening), of_place, of_mass)


def by_moments(pulse: Pulse, tolerance: float) -> Verdict:
    """The verdict on Gaussians with the automaton's exact moments, BCRE's, and effective BCRE's."""
    w, t, n = pulse.cells_a_width, pulse.duration, pulse.steps
    dt, D, sigma = t / n, 1 / pulse.peclet, pulse.growth / t
    g = 1 + sigma * dt
    spread = n * ((dt + 2 * D * dt) / g - (dt / g) ** 2)
    automaton = g**n, n * dt / g, w**2 / 2 + spread
    for own, verdict in ((0.0, Verdict.AGREE), ((1 - dt) / 2, Verdict.EXPLAINED)):
        bcre = math.exp(pulse.growth), t, w**2 / 2 + 2 * (D + own) * t
        if _relative_l1(automaton, bcre) <= tolerance:
            return verdict
    return Verdict.DISAGREE


def _relative_l1(one: tuple[float, float, float], other: tuple[float, float, float]) -> float:
    """Integral of |one - other| over that of the other; mass, mean and variance of each."""
    reach = 8 * math.sqrt(max(one[2], other[2]))
    x = np.linspace(min(one[1], other[1]) - reach, max(one[1], other[1]) + reach, CELLS)
    gap = np.abs(_gaussian(x, *one) - _gaussian(x, *other))
    return float(np.sum(gap) * (x[1] - x[0]) / other[0])


def _gaussian(
    x: np.ndarray[tuple[int], np.dtype[np.float64]], mass: float, mean: float, variance: float
) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    return np.asarray(
        mass * np.exp(-((x - mean) ** 2) / (2 * variance)) / math.sqrt(2 * math.pi * variance)
    )
