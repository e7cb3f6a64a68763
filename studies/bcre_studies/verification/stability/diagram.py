"""A plane of steps for one model: who grows on it, by measurement, prediction and bound."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, cast

import numpy as np

import bcre_ca
import bcre_pde
from bcre_pde import theory
from bcre_pde.explicit import ExplicitMethod
from bcre_studies.models.registry import AUTOMATON
from bcre_studies.verification.stability.amplification import Numbers, Variant, rule_with, stable
from bcre_studies.verification.stability.growth import PDE, STEPS, automaton_grows, pde_grows

DRIFT_AND_SPREAD = "drift and spread"
CLIMB_AND_DRIFT = "climb and drift"
PLANES = (DRIFT_AND_SPREAD, CLIMB_AND_DRIFT)

VARIANTS = (
    Variant("upwind", "synchronous"),
    Variant("calibrated", "synchronous"),
    Variant("limited", "synchronous"),
    Variant("upwind", "right"),
    Variant("upwind", "left"),
)
METHODS: tuple[ExplicitMethod, ...] = ("runge-kutta", "RK45", "DOP853")

AUTOMATON_LIMITS = {DRIFT_AND_SPREAD: (1.9, 1.2), CLIMB_AND_DRIFT: (1.3, 1.3)}
PDE_LIMITS = {DRIFT_AND_SPREAD: (2.9, 0.7), CLIMB_AND_DRIFT: (2.9, 2.9)}
DOP853_LIMITS = {DRIFT_AND_SPREAD: (4.7, 1.4), CLIMB_AND_DRIFT: (4.7, 4.7)}
"""How far the planes reach; no point of theirs lies on a predicted boundary."""

ANGLES = theory.ANGLES[::16]

Test = Callable[[Numbers], bool]


class Diagram(NamedTuple):
    """A plane of steps for one model: the automaton's variant or BCRE's method."""

    model: str
    variant: Variant | ExplicitMethod
    plane: str

    def limits(self) -> tuple[float, float]:
        if self.model == AUTOMATON.name:
            return AUTOMATON_LIMITS[self.plane]
        return (DOP853_LIMITS if self.variant == "DOP853" else PDE_LIMITS)[self.plane]

    def numbers(self, x: float, y: float) -> Numbers:
        """Those of a point of the plane."""
        return Numbers(x, y, 0.0) if self.plane == DRIFT_AND_SPREAD else Numbers(y, 0.0, x)

    def grows(self) -> Test:
        """Measured."""
        if self.model == AUTOMATON.name:
            return lambda numbers: automaton_grows(numbers, cast("Variant", self.variant))
        return lambda numbers: pde_grows(numbers, cast("ExplicitMethod", self.variant))

    def predicted(self) -> Test:
        """|G| <= 1."""
        return self._no_faster_than(theory.ROUNDING)

    def no_visible_growth(self) -> Test:
        """|G| <= 10^(1/n) in the n steps that are taken: growth that they can show."""
        steps = STEPS if self.model == AUTOMATON.name else PDE[1]
        return self._no_faster_than(10 ** (1 / steps) - 1)

    def _no_faster_than(self, growth: float) -> Test:
        if self.model == AUTOMATON.name:
            return lambda numbers: stable(numbers, cast("Variant", self.variant), growth)
        return lambda numbers: _pde_stable(cast("ExplicitMethod", self.variant), growth, numbers)

    def accepted(self, numbers: Numbers) -> bool:
        """Whether the model's own bound, under the layer of 1, lets a step of 1 pass."""
        return self.bound(numbers) >= 1

    def bound(self, numbers: Numbers) -> float:
        """The model's own largest step, in steps of these numbers."""
        if self.model == AUTOMATON.name:
            rule = rule_with(numbers, cast("Variant", self.variant))
            pile = bcre_ca.Pile(np.zeros(8), np.ones(8))
            return bcre_ca.largest_stable_step(pile, rule, "periodic")
        v, D, gamma = numbers
        return bcre_pde.largest_explicit_step(bcre_pde.Material(v, D, gamma, 0.0), 1.0, 1.0)


def _pde_stable(method: ExplicitMethod, growth: float, numbers: Numbers) -> bool:
    """:func:`bcre_pde.theory.stable`, on fewer waves and up to some growth."""
    return all(
        theory.amplification_bound(*numbers, method, ANGLES, rough=rough) <= 1 + growth
        for rough in (False, True)
    )
