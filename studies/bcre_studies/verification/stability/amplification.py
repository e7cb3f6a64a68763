r"""Growth of small waves in one step of the automaton, in closed form, for every order and scheme.

About a uniform layer R0 on the repose line small waves of R and of u = h + Sc x grow by factors of
their own. With c = v dt/d, b = D dt/d^2, q = c + b, a = gamma R0 dt/d, w = e^(j k d),

    order        G of R                                            G of u
    synchronous  1 - c (1 - 1/w) + b (w - 2 + 1/w)                 1 - a (1 - w)
    right        1 - (1 - 1/w)(q - b w)/(1 - q/w)                  1 - a' (1 - w)
    left         1 - (1 - 1/w)(q - b w)/(1 - b w)                  (1 - a)/(1 - a w)

A sweep in place reads what it has just changed: downhill the flux f(i) = q (R(i) + f(i-1)) - b
R(i+1), uphill f(i) = q R(i) - b (R(i+1) - f(i+1)) and u(i) = (1 - a) u(i) + a u(i+1) with the new
u(i+1). What is read must not grow along the row: q <= 1 downhill, b <= 1 and a <= 1
uphill. Downhill a cell exchanges what it holds once it has received: a' = a (1 - b)/(1 - q).

The calibrated rule has b less (c/2)(1 - c), never below 0, and for u the factor of Lax and
Wendroff, 1 + (a/2)(w - 1/w) + (a^2/2)(w - 2 + 1/w). The flux-limited rule is linear where its
limiter passes the centred difference, r = (w - 1/w)/2, and where it cuts it off, r = 0:

    G = 1 - (1 - 1/w)(c (m + r/2) - b (w - 1) m)        m = 1 - (c r - b (w - 2 + 1/w))/2

and for u the conjugate of the same with c = a, b = 0.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

import bcre_ca
from bcre_ca import theory
from bcre_ca.rule import Order, Scheme

ANGLES = np.linspace(0.0, np.pi, 721)
"""Angles k d of the waves looked at; those with k < 0 have the conjugate factors."""

ROUNDING = 1e-12
"""|G| above 1 by no more than this is rounding, as for k = 0, where G = 1."""

Wave = Any
"""Complex numbers, one per angle."""


class Variant(NamedTuple):
    """One automaton: its scheme and the order in which the cells are updated."""

    scheme: Scheme
    order: Order

    def __str__(self) -> str:
        return self.scheme if self.order == "synchronous" else f"{self.scheme}, {self.order}"


class Numbers(NamedTuple):
    """What a step is made of: c = v dt/d, b = D dt/d^2 and a = gamma R0 dt/d."""

    drift: float
    spread: float
    climb: float

    def times(self, factor: float) -> Numbers:
        """Those of a step longer by the factor."""
        return Numbers(*(factor * number for number in self))


def rule_with(numbers: Numbers, variant: Variant) -> bcre_ca.Rule:
    """The rule with d = dt = R0 = 1 and Sc = 0 that has these numbers."""
    v, D, gamma = numbers
    return bcre_ca.Rule(v, D, gamma, 0.0, 1.0, 1.0, order=variant.order, scheme=variant.scheme)


def stable(numbers: Numbers, variant: Variant, growth: float = ROUNDING) -> bool:
    """Whether |G| <= 1 + growth for every wave of R and of u, and nothing grows along a sweep."""
    c, b, a = numbers
    if variant.order == "right":
        if c + b >= 1:
            return False
        a = a * (1 - b) / (1 - c - b)
    if variant.order == "left" and (b >= 1 or a >= 1):
        return False
    return largest_factor(Numbers(c, b, a), variant) <= 1 + growth


def largest_factor(numbers: Numbers, variant: Variant) -> float:
    """Largest |G| over all waves; of a sweep downhill ``climb`` is a'."""
    w = np.exp(1j * ANGLES)
    if variant.scheme == "limited":
        c, b, a = numbers
        slopes = (1j * np.sin(ANGLES), 0j)
        factors = [_limited(*pair, r, w) for r in slopes for pair in ((c, b), (a, 0.0))]
    else:
        factors = [_rolling(numbers, variant, w), _climbing(numbers.climb, variant, w)]
    return max(float(np.abs(factor).max()) for factor in factors)


def _rolling(numbers: Numbers, variant: Variant, w: Wave) -> Wave:
    c, b, _ = numbers
    if variant.order == "synchronous":
        folded = rule_with(numbers, variant).coefficients()
        return theory.amplification(c, folded.diffusion or 0.0, 0.0, 1.0, 1.0, 1 / w)
    passed_on = (c + b) / w if variant.order == "right" else b * w
    return 1 - (1 - 1 / w) * (c + b - b * w) / (1 - passed_on)


def _climbing(a: float, variant: Variant, w: Wave) -> Wave:
    if variant.scheme == "calibrated":
        return 1 + a / 2 * (w - 1 / w) + a**2 / 2 * (w - 2 + 1 / w)
    if variant.order == "left":
        return (1 - a) / (1 - a * w)
    return 1 - a * (1 - w)


def _limited(c: float, b: float, r: Wave, w: Wave) -> Wave:
    middle = 1 - (c * r - b * (w - 2 + 1 / w)) / 2
    return 1 - (1 - 1 / w) * (c * (middle + r / 2) - b * (w - 1) * middle)
