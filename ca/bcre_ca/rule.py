"""The parameters of the automaton: its coefficients, readings, schemes and stable steps."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, Literal, get_args

from bcre_ca import theory
from bcre_ca.coefficients import Coefficients, Parameters, fold
from bcre_ca.exchange import exchanging
from bcre_ca.gate import is_number, require_not_negative, require_positive
from bcre_ca.schemes import Calibrated, CompiledScheme, InPlace, Limited, Upwind
from bcre_ca.stability import largest_step
from bcre_ca.unstable import LAYER_BOUND, SLOPE_DRIVEN_BOUND, THICK_BOUND, WAVE_BOUND, UnstableStep

Sign = Literal["consistent", "printed"]
Order = Literal["synchronous", "right", "left"]
Scheme = Literal["upwind", "calibrated", "limited"]
Ends = Literal["open", "wall", "periodic"]

ROUNDING = 1e-12
"""Relative slack with which a step counts as equal to its bound."""

PRINTED: dict[str, object] = {"scheme": "upwind", "kappa": 0.0, "v_up": math.inf, "Gamma": 0.0}
"""What the in-place readings of the printed rule take."""

ALONE_WITH_BETA: dict[str, object] = {
    "v": 0.0,
    "sign": "consistent",
    "order": "synchronous",
    "scheme": "upwind",
    "kappa": 0.0,
    "v_up": math.inf,
    "dry": 0.0,
    "Gamma": 0.0,
}
"""What a rule with beta, whose layer is driven by the slope, takes of the others."""

COMPILED: dict[str, CompiledScheme] = {
    "upwind": Upwind(),
    "calibrated": Calibrated(),
    "limited": Limited(),
    "right": InPlace(downhill=True),
    "left": InPlace(downhill=False),
}


@dataclass(frozen=True)
class Rule:
    """The automaton's transition map with its units.

    Parameters
    ----------
    v: drift speed of the rolling layer, length/time, >= 0.
    D: diffusion of the rolling layer, length^2/time, >= 0.
    gamma: exchange rate, 1/time, >= 0.
    Sc: repose slope, tangent of the angle of repose, >= 0 (x runs downhill).
    d: cell length, > 0.
    dt: time step, > 0. The paper's own numbers are those of ``d = dt = 1``.
    sign: ``"consistent"`` exchanges gamma R (S - Sc); ``"printed"`` is equations (4) and (5) of the
        paper as they stand, gamma R (S + Sc).
    order: ``"synchronous"`` reads every neighbour from the old state; ``"right"`` and ``"left"``
        update in place, sweeping downhill or uphill.
    scheme: ``"upwind"`` is the paper's. ``"calibrated"`` subtracts from D and kappa what upwind
        differences add to them, so that D_eff = D and kappa_eff = kappa. Where D is too small for
        that, D_eff comes as near as it can (:meth:`effective_diffusion`,
        :meth:`calibrating_step`). ``"limited"`` is of second order where the layers are smooth
        (:mod:`bcre_ca.line.second_order`).
    kappa: curvature term of the exchange, length/time, >= 0.
    v_up: largest speed of the climbing wave, length/time, > 0; infinite for the linear exchange.
    Gamma: velocity gradient of a thick layer, which carries v R + Gamma R^2/2; 1/time, >= 0. For
        the synchronous upwind scheme only.
    beta: speed of the layer per unit of slope, in place of v; length/time, >= 0. The rule is then
        that of :mod:`bcre_ca.line.slope_driven`, which takes v = 0, and D, gamma and Sc alone.
    dry: a layer thinner than this comes to rest, R is moved into h, unless what flows in is about
        to make it thicker (:func:`bcre_ca.exchange.deposit_thin`). A length, >= 0.

    Raises
    ------
    ValueError
        naming the parameter, its value and what is allowed. Whether ``dt`` is stable depends on
        the state too; :func:`bcre_ca.evolve` judges it.

    >>> rule = Rule(v=0.1, D=0.1, gamma=0.01, Sc=0.5, d=1.0, dt=0.4)
    >>> round(rule.second_critical_slope(), 6), round(rule.effective_diffusion(), 6)
    (2.215729, 0.148)
    >>> Rule(v=-0.1, D=0.1, gamma=0.01, Sc=0.5, d=1.0, dt=0.4)
    Traceback (most recent call last):
    ValueError: v = -0.1: must be a finite number >= 0
    """

    v: float
    D: float
    gamma: float
    Sc: float
    d: float
    dt: float
    sign: Sign = "consistent"
    order: Order = "synchronous"
    scheme: Scheme = "upwind"
    kappa: float = 0.0
    v_up: float = math.inf
    dry: float = 0.0
    Gamma: float = 0.0
    beta: float = 0.0

    def __post_init__(self) -> None:
        for name in ("v", "D", "gamma", "Sc", "kappa", "dry", "Gamma", "beta"):
            require_not_negative(name, getattr(self, name))
        for name in ("d", "dt"):
            require_positive(name, getattr(self, name))
        for name, allowed in (("sign", Sign), ("order", Order), ("scheme", Scheme)):
            value = getattr(self, name)
            if value not in get_args(allowed):
                raise ValueError(f"{name} = {value!r}: must be one of {get_args(allowed)}")
        if not (is_number(self.v_up) and self.v_up > 0):
            raise ValueError(f"v_up = {self.v_up!r}: must be a number > 0")
        self._require_plain_scheme()

    def _require_plain_scheme(self) -> None:
        """Raise ValueError for terms that the rule's order or scheme does not take."""
        if self.order != "synchronous":
            why = f"where order = {self.order!r}, a reading of the printed rule"
            self._require(PRINTED, why)
        if self.beta > 0:
            self._require(ALONE_WITH_BETA, f"where beta = {self.beta!r}")
        if self.Gamma > 0 and self.scheme != "upwind":
            raise ValueError(
                f"Gamma = {self.Gamma!r}: must be 0 where scheme = {self.scheme!r}; thick layers "
                "are carried by the upwind scheme only"
            )

    def _require(self, values: dict[str, object], why: str) -> None:
        for name, value in values.items():
            if getattr(self, name) != value:
                raise ValueError(f"{name} = {getattr(self, name)!r}: must be {value!r} {why}")

    def with_step(self, step: Any) -> Rule:
        """The same rule with another dt; ValueError where that is no step."""
        try:
            return replace(self, dt=float(step))
        except (TypeError, ValueError):
            raise ValueError(f"step = {step!r}: must be 'auto' or a finite number > 0") from None

    def parameters(self) -> Parameters:
        """The rule without its dt, absent terms as None; beta in place of v."""
        return Parameters(
            float(self.beta or self.v),
            float(self.D) if self.D > 0 else None,
            float(self.gamma),
            float(self.exchange_slope()),
            float(self.d),
            kappa=float(self.kappa) if self.kappa > 0 else None,
            v_up=float(self.v_up) if math.isfinite(self.v_up) else None,
            dry=float(self.dry) if self.dry > 0 else None,
            Gamma=float(self.Gamma) if self.Gamma > 0 else None,
            scheme=COMPILED[self.scheme if self.order == "synchronous" else self.order],
        )

    def coefficients(self) -> Coefficients:
        """Fold the parameters into the constants that every path of the automaton uses."""
        folded: Coefficients = fold(self.parameters(), float(self.dt))
        return folded

    def exchange_slope(self) -> float:
        """Slope at which the exchange vanishes: Sc, or -Sc for the printed sign."""
        return self.Sc if self.sign == "consistent" else -self.Sc

    def max_stable_step(
        self,
        largest_R: float = 0.0,
        smallest_slope: float | None = None,
        largest_curvature: float = 0.0,
    ) -> float:
        """Largest dt that keeps R >= 0 and lets the surface wave cross at most a cell a step.

        The upwind scheme needs J' dt/d + 2 D dt/d^2 + sink dt <= 1 and (gamma/d + 2 kappa/d^2) X dt
        <= 1, where J' = v + Gamma R, sink = max(kappa h_xx - gamma (S - Sc), 0) and X(R) is the
        layer that exchanges.
        For the other schemes see :func:`bcre_ca.theory.max_stable_step`.

        A sweep downhill updates a cell after it has received what leaves the one above. Up to
        R/(1 - v dt/d - D dt/d^2) exchanges there, and the second bound is
        (gamma R/d + v/d + D/d^2) dt <= 1. A sweep uphill, or one downhill across joined ends, meets
        slopes that the same sweep has already lowered by deposits: R >= 0 is then not assured.

        Parameters
        ----------
        largest_R: largest rolling layer in the pile, a length.
        smallest_slope: smallest slope S in the pile; left out, nowhere below the repose slope.
        largest_curvature: largest h_xx in the pile, 1/length.
        """
        if self.beta > 0:
            raise ValueError(
                f"beta = {self.beta!r}: the largest stable step depends on all slopes; see "
                "bcre_ca.largest_stable_step"
            )
        deficit = 0.0 if smallest_slope is None else max(self.exchange_slope() - smallest_slope, 0)
        sink = self.gamma * deficit + self.kappa * max(largest_curvature, 0.0)
        return float(largest_step(self.parameters(), largest_R, sink))

    def require_stable(self, largest_R: float = 0.0, smallest_slope: float | None = None) -> None:
        """Raise :class:`UnstableStep` where dt exceeds :meth:`max_stable_step`."""
        self.require_within(self.max_stable_step(largest_R, smallest_slope), largest_R)

    def require_within(self, largest: float, largest_R: float) -> None:
        """Raise :class:`UnstableStep` where dt exceeds ``largest``, the largest stable step found.

        ``largest_R``, the layer that it was found for, decides which of the bounds is named.
        """
        if not self.dt <= largest * (1 + ROUNDING):
            for term, bound in ((self.beta, SLOPE_DRIVEN_BOUND), (self.Gamma, THICK_BOUND)):
                if term > 0:
                    raise UnstableStep(self.dt, largest, bound)
            with_wave, without = (largest_step(self.parameters(), R, 0.0) for R in (largest_R, 0.0))
            by_wave = with_wave <= largest * (1 + ROUNDING) < without
            bound = (
                f"{WAVE_BOUND[self.order]} must not exceed 1 where R = {largest_R:.6g}"
                if by_wave
                else LAYER_BOUND[self.scheme]
            )
            raise UnstableStep(self.dt, largest, bound)

    def second_critical_slope(self) -> float:
        """Sd of the synchronous rule; see :func:`bcre_ca.theory.second_critical_excess`.

        In a calibrated rule the diffusion left in its flux takes the place of D.
        """
        self._require_synchronous("the second critical slope")
        if self.scheme == "limited":
            raise ValueError(
                "scheme = 'limited': the second critical slope is known in closed form for "
                "'upwind' and 'calibrated' only, whose steps on a frozen slope are linear"
            )
        excess = theory.second_critical_excess(self.v, self.diffusion_left(), self.gamma, self.d)
        return self.exchange_slope() + excess

    def effective_diffusion(self, R0: float = 0.0) -> float:
        """D_eff of the modified equation, to first order in d and dt, under a layer R0.

        D + (J' d/2)(1 - J' dt/d), J' = v + Gamma R0, for the upwind rule
        (:func:`bcre_ca.theory.effective_diffusion`); D for the limited one, and for the calibrated
        one if dt is at least its calibrating step.
        """
        self._require_synchronous("D_eff")
        if self.scheme == "limited":
            return self.D
        speed = self.v + self.Gamma * R0
        return theory.effective_diffusion(speed, self.diffusion_left(), self.d, self.dt)

    def diffusion_left(self) -> float:
        """The diffusion in the rule's flux: D, or what calibration leaves of it."""
        return (self.coefficients().diffusion or 0.0) * self.d**2 / self.dt

    def effective_curvature(self, R0: float = 0.0) -> float:
        """kappa_eff of the modified equation; kappa + (gamma d/2)(1 - gamma X dt/d) for the upwind
        rule under a uniform rolling layer R0, X = X(R0), and kappa for the others."""
        self._require_synchronous("kappa_eff")
        if self.scheme != "upwind":
            return self.kappa
        X = float(exchanging(R0, self.coefficients().saturation))
        return self.kappa + theory.effective_curvature(self.gamma, self.d, self.dt, X)

    def calibrating_step(self) -> float:
        """Smallest dt at which the calibrated rule reaches D_eff = D: (d/v)(1 - 2 D/(v d)), or 0.

        Below it the upwind flux alone diffuses more than D, (v d/2)(1 - v dt/d) > D. It is 0 for
        cells of Peclet number v d/D <= 2, and for the other schemes.
        """
        if self.scheme != "calibrated" or self.v == 0:
            return 0.0
        return max(self.d / self.v * (1 - 2 * self.D / (self.v * self.d)), 0.0)

    def require_upwind(self, what: str) -> None:
        """Raise ValueError where the rule is not the synchronous upwind one."""
        if (self.order, self.scheme) != ("synchronous", "upwind"):
            raise ValueError(
                f"order = {self.order!r}, scheme = {self.scheme!r}: {what} is defined for the "
                "synchronous upwind rule only"
            )
        for name in ("Gamma", "beta"):
            if getattr(self, name) > 0:
                raise ValueError(f"{name} = {getattr(self, name)!r}: {what} is defined for 0 only")

    def _require_synchronous(self, what: str) -> None:
        if self.order != "synchronous":
            raise ValueError(
                f"order = {self.order!r}: {what} is known in closed form for 'synchronous' only"
            )
        if self.beta > 0:
            raise ValueError(f"beta = {self.beta!r}: {what} is known in closed form for 0 only")
