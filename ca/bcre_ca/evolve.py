"""Running the automaton: so many steps, to chosen times, or with a step that follows its bounds."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bcre_ca.kernels import march
from bcre_ca.rule import Ends, Rule, UnstableStep

Array = NDArray[np.float64]

BLOCK = 32
"""Steps between two looks at the bounds when the step follows them."""

DENORMAL = 1e-300
"""Below this the sign of a layer is a matter of rounding among denormal numbers."""

MARGIN = 0.8
"""Part of the bound that such a step takes, so that a block of growth seldom passes it."""


@dataclass(frozen=True)
class Pile:
    """The automaton's state: layers h and R of shape (N,), time, and the history of mass.

    ``outflow`` is the area that has left through the foot, so that
    ``d sum(h + R) + outflow`` does not change.
    """

    h: Array
    R: Array
    t: float = 0.0
    outflow: float = 0.0
    steps: int = 0

    def mass(self, d: float) -> float:
        """Area of sand in the pile, d sum(h + R)."""
        return d * (math.fsum(self.h) + math.fsum(self.R))


def evolve(
    h: ArrayLike, R: ArrayLike, rule: Rule, steps: int, ends: Ends = "open"
) -> tuple[Array, Array]:
    """The layers after exactly ``steps`` steps of ``rule.dt``, as new arrays.

    Parameters
    ----------
    h, R: static and rolling layer, lengths, shape (N,).
    steps: number of steps, >= 0.
    ends: ``"open"`` (closed top, open foot) or ``"periodic"`` (in h + Sc x and R).

    Raises
    ------
    UnstableStep
        where dt cannot be stable for this start; FloatingPointError where the layers outgrew it
        on the way; ValueError for layers of unequal, empty or non-finite content.
    """
    start = Pile(*_layers(h, R))
    require_stable(start, rule, ends)
    end = _advance_stably(start, rule, steps, ends)
    return end.h, end.R


def advance(pile: Pile, rule: Rule, steps: int, ends: Ends = "open") -> Pile:
    """The pile after ``steps`` steps of ``rule.dt``, whatever their stability.

    Raises
    ------
    FloatingPointError
        naming the first cell that is no longer finite and the bound that was passed.
    """
    if isinstance(steps, bool) or steps != int(steps) or steps < 0:
        raise ValueError(f"steps = {steps!r}: must be a whole number >= 0")
    if ends not in ("open", "periodic"):
        raise ValueError(f"ends = {ends!r}: must be 'open' or 'periodic'")
    h, R = pile.h.copy(), pile.R.copy()
    outflow = march(h, R, rule, steps, ends) * rule.d
    if not (np.isfinite(h).all() and np.isfinite(R).all()):
        cell = int(np.argmin(np.isfinite(h) & np.isfinite(R)))
        raise FloatingPointError(
            f"the automaton lost stability between t = {pile.t:.6g} and "
            f"{pile.t + steps * rule.dt:.6g}, first in cell {cell}: gamma R dt/d passed 1 "
            f"(dt = {rule.dt:.6g})"
        )
    return Pile(h, R, pile.t + steps * rule.dt, pile.outflow + outflow, pile.steps + steps)


def frames(
    pile: Pile,
    rule: Rule,
    times: Sequence[float],
    ends: Ends = "open",
    step: float | Literal["auto"] = "auto",
) -> Iterator[Pile]:
    """The pile at each of the ascending ``times``.

    A fixed step is taken as it is, but for a shorter one before a time that does not fall on a
    step. ``"auto"`` takes :data:`MARGIN` of the largest stable step and looks again after every
    :data:`BLOCK` steps; a block at whose end the bound has been passed is thrown away and taken
    in smaller steps.

    Raises
    ------
    UnstableStep
        for a fixed step that cannot be stable at the start.
    FloatingPointError
        for a fixed step that the avalanche outgrew.
    """
    if step != "auto":
        rule = replace(rule, dt=step)
        require_stable(pile, rule, ends)
    for time in times:
        if time < pile.t:
            raise ValueError(f"times = {list(times)!r}: must ascend from t = {pile.t!r}")
        pile = _follow(pile, rule, time, ends) if step == "auto" else _reach(pile, rule, time, ends)
        yield pile


def largest_stable_step(pile: Pile, rule: Rule, ends: Ends) -> float:
    """:meth:`Rule.max_stable_step` for this pile."""
    return rule.max_stable_step(float(pile.R.max()), _smallest_slope(pile, rule, ends))


def require_stable(pile: Pile, rule: Rule, ends: Ends) -> None:
    """Raise :class:`UnstableStep` where ``rule.dt`` cannot be stable for this pile."""
    rule.require_stable(float(pile.R.max()), _smallest_slope(pile, rule, ends))


def _reach(pile: Pile, rule: Rule, time: float, ends: Ends) -> Pile:
    """Whole steps of dt, and what is left of the way in one shorter step."""
    span = time - pile.t
    steps = math.floor(span / rule.dt * (1 + 1e-9))
    end = _advance_stably(pile, rule, steps, ends)
    left = span - steps * rule.dt
    if left > 1e-9 * rule.dt:
        end = _advance_stably(end, replace(rule, dt=left), 1, ends)
    return replace(end, t=time)


def _advance_stably(pile: Pile, rule: Rule, steps: int, ends: Ends) -> Pile:
    end = advance(pile, rule, steps, ends)
    try:
        require_stable(end, rule, ends)
    except UnstableStep as outgrown:
        message = f"the avalanche outgrew the step by t = {end.t:.6g}: {outgrown}"
        raise FloatingPointError(message) from None
    return end


def _follow(pile: Pile, rule: Rule, time: float, ends: Ends) -> Pile:
    while time - pile.t > 1e-12 * abs(time):
        span = time - pile.t
        bound = largest_stable_step(pile, rule, ends)
        steps = min(BLOCK, max(math.ceil(span / (MARGIN * bound)), 1))
        dt = min(MARGIN * bound, span / steps)
        pile = _stable_block(pile, replace(rule, dt=dt), steps, ends)
    return replace(pile, t=time)


def _stable_block(pile: Pile, rule: Rule, steps: int, ends: Ends) -> Pile:
    while True:
        try:
            end = advance(pile, rule, steps, ends)
            require_stable(end, rule, ends)
        except (FloatingPointError, UnstableStep):
            rule = replace(rule, dt=rule.dt / 2)
        else:
            return end


def _smallest_slope(pile: Pile, rule: Rule, ends: Ends) -> float:
    fall = pile.h[:-1] - pile.h[1:]
    smallest = float(fall.min()) / rule.d if fall.size else rule.Sc
    if ends == "periodic":
        across = float(pile.h[-1] - pile.h[0]) / rule.d + rule.Sc * pile.h.size
        smallest = min(smallest, across)
    return smallest


def _layers(h: ArrayLike, R: ArrayLike) -> tuple[Array, Array]:
    static, rolling = np.array(h, dtype=float), np.array(R, dtype=float)
    if static.ndim != 1 or static.shape != rolling.shape or not static.size:
        raise ValueError(
            f"h has shape {static.shape}, R {rolling.shape}: must be equal, (N,) with N >= 1"
        )
    if not (np.isfinite(static).all() and np.isfinite(rolling).all()):
        raise ValueError("h and R must be finite")
    if rolling.min() < -DENORMAL:
        raise ValueError(f"R = {float(rolling.min())!r}: must be >= 0")
    return static, rolling
