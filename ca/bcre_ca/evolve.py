"""Running the automaton: so many steps, to chosen times, or with a step that follows its bounds."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bcre_ca import kernels
from bcre_ca.kernels import BLOCK
from bcre_ca.rule import Ends, Rule, UnstableStep

Array = NDArray[np.float64]

AT_ONCE = 200_000_000
"""Cell-steps between two looks at the keyboard: compiled code cannot be interrupted."""

DENORMAL = 1e-300
"""Below this the sign of a layer is a matter of rounding among denormal numbers."""

MARGIN = 0.8
"""Part of the bound that a followed step takes, so that a block of growth seldom passes it."""


@dataclass(frozen=True)
class Pile:
    """The automaton's state: layers h and R of shape (N,), time, and the history of mass.

    ``outflow`` is the area that has left through the foot, so that
    ``d sum(h + R) + outflow`` does not change. ``steps`` counts those taken; ``lowered`` and
    ``raised`` how often a step that follows its bounds became shorter or longer, ``redone`` how
    often a block of steps was taken back and repeated in shorter ones.
    """

    h: Array
    R: Array
    t: float = 0.0
    outflow: float = 0.0
    steps: int = 0
    lowered: int = 0
    raised: int = 0
    redone: int = 0

    def mass(self, d: float) -> float:
        """Area of sand in the pile, d sum(h + R)."""
        return d * (math.fsum(self.h) + math.fsum(self.R))


def evolve(
    h: ArrayLike, R: ArrayLike, rule: Rule, steps: int, ends: Ends = "open"
) -> tuple[Array, Array]:
    """The layers after exactly ``steps`` steps of ``rule.dt``, as new arrays.

    Parameters
    ----------
    h, R: static and rolling layer, lengths, shape (N,); or (scenes, N) for many piles of one rule,
        which are shared out among the processors. They are kept in single precision where both
        are float32, else in double.
    steps: number of steps, >= 0.
    ends: ``"open"`` (closed top, open foot) or ``"periodic"`` (in h + Sc x and R).

    Raises
    ------
    UnstableStep
        where dt cannot be stable for this start; FloatingPointError where the layers have outgrown
        it by the end; ValueError for layers of unequal, empty or non-finite content.
    """
    static, rolling = _layers(h, R)
    _require_steps(steps)
    _require_ends(ends)
    require_stable(static, rolling, rule, ends)
    start = static.copy(), rolling.copy()
    _march(static, rolling, rule, int(steps), ends)
    try:
        require_stable(static, rolling, rule, ends)
    except UnstableStep:
        for row in zip(*(np.atleast_2d(layer) for layer in start), strict=True):
            _require_outlasting(Pile(*row), rule, int(steps), ends)
        raise
    return static, rolling


def advance(pile: Pile, rule: Rule, steps: int, ends: Ends = "open") -> Pile:
    """The pile after ``steps`` steps of ``rule.dt``, whatever their stability.

    Raises
    ------
    FloatingPointError
        where the layers are no longer finite, naming cell, time and the bound that was passed.
    """
    _require_steps(steps)
    _require_ends(ends)
    h, R = pile.h.copy(), pile.R.copy()
    outflow = _march(h, R, rule, int(steps), ends) * rule.d
    if not (np.isfinite(h).all() and np.isfinite(R).all()):
        _require_outlasting(pile, rule, int(steps), ends)
    return replace(
        pile,
        h=h,
        R=R,
        t=pile.t + steps * rule.dt,
        outflow=pile.outflow + outflow,
        steps=pile.steps + int(steps),
    )


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
        for a fixed step that the avalanche outgrew, naming cell, time and bound.
    """
    if step != "auto":
        rule = replace(rule, dt=step)
        require_stable(pile.h, pile.R, rule, ends)
    for time in times:
        if time < pile.t:
            raise ValueError(f"times = {list(times)!r}: must ascend from t = {pile.t!r}")
        pile = _follow(pile, rule, time, ends) if step == "auto" else _reach(pile, rule, time, ends)
        yield pile


def largest_stable_step(pile: Pile, rule: Rule, ends: Ends) -> float:
    """:meth:`Rule.max_stable_step` for this pile; NaN where it is not finite."""
    return kernels.stable_step(pile.h, pile.R, rule, ends)


def require_stable(h: Array, R: Array, rule: Rule, ends: Ends) -> None:
    """Raise :class:`UnstableStep` where ``rule.dt`` cannot be stable for these layers."""
    rows = zip(np.atleast_2d(h), np.atleast_2d(R), strict=True)
    largest = min(kernels.stable_step(*row, rule, ends) for row in rows)
    rule.require_within(largest, float(R.max()))


def _march(h: Array, R: Array, rule: Rule, steps: int, ends: Ends) -> float:
    """March in place, in parts short enough to be interrupted between."""
    part = max(AT_ONCE // h.size, BLOCK)
    outflows = (
        kernels.march(h, R, rule, min(part, steps - done), ends) for done in range(0, steps, part)
    )
    return math.fsum(outflows)


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
        require_stable(end.h, end.R, rule, ends)
    except UnstableStep:
        _require_outlasting(pile, rule, steps, ends)
        raise
    return end


def _require_outlasting(
    pile: Pile, rule: Rule, steps: int, ends: Ends, together: int = BLOCK
) -> None:
    """Take the steps again, so many together, and say where the step ceased to be stable.

    An excess that is gone again after so many steps is not seen.
    """
    for done in range(0, steps, together):
        h, R = pile.h.copy(), pile.R.copy()
        part = min(together, steps - done)
        kernels.march(h, R, rule, part, ends)
        try:
            require_stable(h, R, rule, ends)
        except UnstableStep as outgrown:
            if part > 1:
                _require_outlasting(pile, rule, part, ends, together=1)
            finite = np.isfinite(h) & np.isfinite(R)
            cell = int(np.argmax(R)) if finite.all() else int(np.argmin(finite))
            raise FloatingPointError(
                f"the avalanche outgrew the step at t = {pile.t + part * rule.dt:.6g}, in cell "
                f"{cell}: {outgrown}"
            ) from None
        pile = replace(pile, h=h, R=R, t=pile.t + part * rule.dt)


def _follow(pile: Pile, rule: Rule, time: float, ends: Ends) -> Pile:
    h, R = pile.h.copy(), pile.R.copy()
    span, blocks = time - pile.t, max(AT_ONCE // (h.size * BLOCK), 1)
    if span <= 1e-12 * abs(time):
        return replace(pile, t=time)
    while span > 0:
        done = kernels.follow(h, R, rule, span, blocks, MARGIN, ends)
        if done.left < 0:
            raise FloatingPointError(
                f"no step is short enough at t = {time + done.left:.6g}: the layers outgrow "
                "every bound"
            )
        span = done.left
        pile = replace(
            pile,
            outflow=pile.outflow + done.outflow * rule.d,
            steps=pile.steps + done.steps,
            lowered=pile.lowered + done.lowered,
            raised=pile.raised + done.raised,
            redone=pile.redone + done.redone,
        )
    return replace(pile, h=h, R=R, t=time)


def _require_steps(steps: Any) -> None:
    if isinstance(steps, bool) or steps != int(steps) or steps < 0:
        raise ValueError(f"steps = {steps!r}: must be a whole number >= 0")


def _require_ends(ends: str) -> None:
    if ends not in ("open", "periodic"):
        raise ValueError(f"ends = {ends!r}: must be 'open' or 'periodic'")


def _layers(h: ArrayLike, R: ArrayLike) -> tuple[Array, Array]:
    both_single = all(getattr(layer, "dtype", None) == np.float32 for layer in (h, R))
    dtype: Any = np.float32 if both_single else float
    static, rolling = np.array(h, dtype=dtype, order="C"), np.array(R, dtype=dtype, order="C")
    if static.ndim not in (1, 2) or static.shape != rolling.shape or not static.size:
        raise ValueError(
            f"h has shape {static.shape}, R {rolling.shape}: must be equal, (N,) with N >= 1, or "
            "(scenes, N)"
        )
    if not (np.isfinite(static).all() and np.isfinite(rolling).all()):
        raise ValueError("h and R must be finite")
    if rolling.min() < -DENORMAL:
        raise ValueError(f"R = {float(rolling.min())!r}: must be >= 0")
    return static, rolling
