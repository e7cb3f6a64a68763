"""The parameters of the automaton, the readings of its printed rule, and its stable steps."""

from __future__ import annotations

import math
from dataclasses import dataclass
from numbers import Real
from typing import Literal, NamedTuple, get_args

from bcre_ca import theory

Sign = Literal["consistent", "printed"]
Order = Literal["synchronous", "right", "left"]
Ends = Literal["open", "periodic"]

ROUNDING = 1e-12
"""Relative slack with which a step counts as equal to its bound."""


class UnstableStep(ValueError):  # noqa: N818 - named for what happened, as StopIteration is
    """A time step that cannot be stable; ``largest`` is the largest one that would be."""

    def __init__(self, dt: float, largest: float, bound: str) -> None:
        super().__init__(
            f"dt = {dt:.6g} cannot be stable: {bound}; "
            f"the largest stable step is {_rounded_down(largest)}"
        )
        self.dt = dt
        self.largest = largest


def _is_number(value: object) -> bool:
    return isinstance(value, Real) and math.isfinite(value)


def _rounded_down(step: float) -> str:
    """Six digits that do not exceed the step, so that what is recommended is accepted."""
    text = f"{step:.6g}"
    return text if float(text) <= step else f"{step * (1 - 5e-6):.6g}"


class Coefficients(NamedTuple):
    """The rule's constants folded per step and cell; every path computes with exactly these.

    ``c = v dt/d``, ``b = D dt/d^2``, ``q = c + b``, ``k = gamma dt/d`` and ``s = ±Sc d`` (minus for
    the printed sign). The flux out of cell i is ``q R(i) - b R(i+1)`` and the exchange
    ``R(i) (k (h(i) - h(i+1) - s))``, in this order of operations.
    """

    c: float
    b: float
    q: float
    k: float
    s: float


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

    Raises
    ------
    ValueError
        naming the parameter, its value and what is allowed. Whether ``dt`` is stable depends on
        the state too; :func:`bcre_ca.evolve` judges it.
    """

    v: float
    D: float
    gamma: float
    Sc: float
    d: float
    dt: float
    sign: Sign = "consistent"
    order: Order = "synchronous"

    def __post_init__(self) -> None:
        for name in ("v", "D", "gamma", "Sc"):
            value = getattr(self, name)
            if not (_is_number(value) and value >= 0):
                raise ValueError(f"{name} = {value!r}: must be a finite number >= 0")
        for name in ("d", "dt"):
            value = getattr(self, name)
            if not (_is_number(value) and value > 0):
                raise ValueError(f"{name} = {value!r}: must be a finite number > 0")
        if self.sign not in get_args(Sign):
            raise ValueError(f"sign = {self.sign!r}: must be one of {get_args(Sign)}")
        if self.order not in get_args(Order):
            raise ValueError(f"order = {self.order!r}: must be one of {get_args(Order)}")

    def coefficients(self) -> Coefficients:
        """Fold the parameters into the constants that every path of the automaton uses."""
        c = self.v * self.dt / self.d
        b = self.D * self.dt / self.d**2
        return Coefficients(
            c=c, b=b, q=c + b, k=self.gamma * self.dt / self.d, s=self.exchange_slope() * self.d
        )

    def exchange_slope(self) -> float:
        """Slope at which the exchange vanishes: Sc, or -Sc for the printed sign."""
        return self.Sc if self.sign == "consistent" else -self.Sc

    def max_stable_step(self, largest_R: float = 0.0, smallest_slope: float | None = None) -> float:
        """Largest dt with v dt/d + 2 D dt/d^2 + gamma dt max(Sc - S, 0) <= 1, gamma R dt/d <= 1.

        The first bound keeps R >= 0, the second keeps the surface wave, which climbs at gamma R,
        from crossing more than a cell a step. See :func:`bcre_ca.theory.max_stable_step`.

        Parameters
        ----------
        largest_R: largest rolling layer in the pile, a length.
        smallest_slope: smallest slope S in the pile; left out, nowhere below the repose slope.
        """
        deficit = 0.0 if smallest_slope is None else max(self.exchange_slope() - smallest_slope, 0)
        return theory.max_stable_step(self.v, self.D, self.gamma, self.d, largest_R, deficit)

    def require_stable(self, largest_R: float = 0.0, smallest_slope: float | None = None) -> None:
        """Raise :class:`UnstableStep` where dt exceeds :meth:`max_stable_step`."""
        largest = self.max_stable_step(largest_R, smallest_slope)
        if self.dt > largest * (1 + ROUNDING):
            layer_bound = self.max_stable_step(0.0, smallest_slope)
            bound = (
                "v dt/d + 2 D dt/d^2 + gamma dt max(Sc - S, 0) must not exceed 1"
                if self.dt > layer_bound * (1 + ROUNDING)
                else f"gamma R dt/d must not exceed 1 where R = {largest_R:.6g}"
            )
            raise UnstableStep(self.dt, largest, bound)

    def second_critical_slope(self) -> float:
        """Sd of the synchronous rule; see :func:`bcre_ca.theory.second_critical_excess`."""
        self._require_synchronous("the second critical slope")
        return self.exchange_slope() + theory.second_critical_excess(
            self.v, self.D, self.gamma, self.d
        )

    def effective_diffusion(self) -> float:
        """D_eff = D + (v d/2)(1 - v dt/d); see :func:`bcre_ca.theory.effective_diffusion`."""
        self._require_synchronous("D_eff")
        return theory.effective_diffusion(self.v, self.D, self.d, self.dt)

    def effective_curvature(self, R0: float = 0.0) -> float:
        """kappa_eff = (gamma d/2)(1 - gamma R0 dt/d), R0 a uniform rolling layer."""
        self._require_synchronous("kappa_eff")
        return theory.effective_curvature(self.gamma, self.d, self.dt, R0)

    def _require_synchronous(self, what: str) -> None:
        if self.order != "synchronous":
            raise ValueError(
                f"order = {self.order!r}: {what} is known in closed form for 'synchronous' only"
            )
