"""The automaton in time: a number of steps, chosen times, or a step that follows its bounds."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bcre_ca.line import kernels
from bcre_ca.line.kernels import AT_ONCE, BLOCK
from bcre_ca.line.pile import Pile, layers_of, require_ends, whole
from bcre_ca.rule import Ends, Rule, UnstableStep

Array = NDArray[np.float64]

MARGIN = 0.8
"""Share of the bound that a followed step takes, so that a block of steps seldom outgrows it."""


def evolve(
    h: ArrayLike,
    R: ArrayLike,
    rule: Rule,
    steps: int,
    ends: Ends = "open",
    frozen: ArrayLike | None = None,
) -> tuple[Array, Array]:
    """The layers after exactly ``steps`` steps of ``rule.dt``, as new arrays.

    Parameters
    ----------
    h, R: static and rolling layer, lengths, shape (N,). They are kept in single precision where
        both are float32, else in double.
    steps: number of steps, >= 0.
    ends: ``"open"`` (closed top, open foot) or ``"periodic"`` (in h + Sc x and R).
    frozen: a surface, shape (N,), whose slope S0 the exchange sees at every step instead of that
        of h: E = gamma R (S0 - Sc). For the synchronous upwind rule only.

    Raises
    ------
    UnstableStep
        where dt cannot be stable for this start.
    FloatingPointError
        where the layers have outgrown dt by the end.
    ValueError
        for layers of unequal or wrong shape, empty or not finite.

    >>> import numpy as np
    >>> rule = Rule(v=0.1, D=0.1, gamma=0.01, Sc=0.5, d=1.0, dt=0.4)
    >>> h, R = evolve(0.5 * np.arange(20.0)[::-1], np.eye(20)[3], rule, steps=10)
    >>> float(round((h + R).sum() - 95, 12))
    1.0
    """
    static, rolling = layers_of(h, R, rank=1)
    steps = whole(steps)
    require_ends(ends)
    if frozen is not None:
        return _evolve_frozen(static, rolling, rule, steps, ends, np.asarray(frozen, static.dtype))
    _require_stable(static, rolling, rule, ends)
    start = Pile(static.copy(), rolling.copy())
    _march(static, rolling, rule, steps, ends)
    _require_outlasted(start, static, rolling, rule, steps, ends)
    return static, rolling


def evolve_many(
    h: ArrayLike, R: ArrayLike, rule: Rule | Sequence[Rule], steps: int, ends: Ends = "open"
) -> tuple[Array, Array]:
    """:func:`evolve` for many piles, layers of shape (piles, N), of one rule or a rule each.

    The piles do not touch each other; they are shared out among the processors.
    """
    static, rolling = layers_of(h, R, rank=2)
    rules = [rule] * len(static) if isinstance(rule, Rule) else list(rule)
    if len(rules) != len(static):
        raise ValueError(f"rule: there are {len(rules)} for {len(static)} piles; must be as many")
    steps = whole(steps)
    require_ends(ends)
    for i in _unstable(static, rolling, rules, ends):
        _require_stable(static[i], rolling[i], rules[i], ends)
    starts = static.copy(), rolling.copy()
    for part in _parts(steps, static.shape[1]):
        kernels.march_many(static, rolling, rules, part, ends)
    for i in _unstable(static, rolling, rules, ends):
        start = Pile(starts[0][i], starts[1][i])
        _require_outlasted(start, static[i], rolling[i], rules[i], steps, ends)
    return static, rolling


def _unstable(h: Array, R: Array, rules: Sequence[Rule], ends: Ends) -> Iterator[int]:
    """The piles whose dt may not be stable, or are not finite."""
    steps = np.array([rule.dt for rule in rules])
    stable = steps <= kernels.stable_steps(h, R, rules, ends)
    return (int(i) for i in np.flatnonzero(~stable))


def march(h: Array, R: Array, rule: Rule, steps: int, ends: Ends = "open") -> float:
    """Take steps in place, stable or not; h and R are contiguous arrays of shape (N,).

    Returns what left through the foot, in units of R (times d: an area).
    """
    if h.ndim != 1:
        raise ValueError(f"h has shape {h.shape}: must be (N,)")
    return _march(h, R, rule, steps, ends)


def advance(pile: Pile, rule: Rule, steps: int, ends: Ends = "open") -> Pile:
    """The pile after ``steps`` steps of ``rule.dt``, stable or not.

    Raises
    ------
    FloatingPointError
        where the layers are no longer finite, naming cell, time and the bound that was passed.
    """
    steps = whole(steps)
    require_ends(ends)
    h, R = pile.h.copy(), pile.R.copy()
    outflow = _march(h, R, rule, steps, ends) * rule.d
    if not (np.isfinite(h).all() and np.isfinite(R).all()):
        _locate_instability(pile, rule, steps, ends)
    return replace(
        pile,
        h=h,
        R=R,
        t=pile.t + steps * rule.dt,
        outflow=pile.outflow + outflow,
        steps=pile.steps + steps,
    )


def frames(
    pile: Pile,
    rule: Rule,
    times: Sequence[float],
    ends: Ends = "open",
    step: float | Literal["auto"] = "auto",
    margin: float = MARGIN,
) -> Iterator[Pile]:
    """The pile at each of the ascending ``times``.

    A fixed step is taken as it is, except for a shorter one before a time between two steps.
    ``"auto"`` takes the share ``margin`` of the largest stable step, found anew after every
    :data:`BLOCK` steps. A block at whose end the bound has been passed is repeated in shorter
    steps.

    Raises
    ------
    UnstableStep
        for a fixed step that cannot be stable at the start.
    FloatingPointError
        for a fixed step that the avalanche outgrew, naming cell, time and bound.
    """
    if step != "auto":
        rule = replace(rule, dt=step)
        _require_stable(pile.h, pile.R, rule, ends)
    for time in times:
        if time < pile.t:
            raise ValueError(f"times = {list(times)!r}: must ascend from t = {pile.t!r}")
        if step == "auto":
            pile = _follow(pile, rule, time, ends, margin)
        else:
            pile = _reach(pile, rule, time, ends)
        yield pile


def largest_stable_step(pile: Pile, rule: Rule, ends: Ends) -> float:
    """:meth:`Rule.max_stable_step` for this pile; NaN where it is not finite."""
    return kernels.stable_step(pile.h, pile.R, rule, ends)


def _require_stable(h: Array, R: Array, rule: Rule, ends: Ends) -> None:
    rule.require_within(kernels.stable_step(h, R, rule, ends), float(R.max()))


def _parts(steps: int, cells: int) -> Iterator[int]:
    """The steps in parts short enough to be interrupted between."""
    part = max(AT_ONCE // cells, BLOCK)
    return (min(part, steps - done) for done in range(0, steps, part))


def _march(
    h: Array, R: Array, rule: Rule, steps: int, ends: Ends, frozen: Array | None = None
) -> float:
    return math.fsum(
        kernels.march(h, R, rule, part, ends, frozen) for part in _parts(steps, h.size)
    )


def _evolve_frozen(
    h: Array, R: Array, rule: Rule, steps: int, ends: Ends, surface: Array
) -> tuple[Array, Array]:
    """No surface wave bounds the step, and the slope that does stays as it is."""
    rule.require_upwind("a frozen slope")
    if surface.shape != h.shape:
        raise ValueError(f"frozen has shape {surface.shape}: must be that of h, {h.shape}")
    _require_stable(surface, np.zeros_like(R), rule, ends)
    _march(h, R, rule, steps, ends, surface)
    if not (np.isfinite(h).all() and np.isfinite(R).all()):
        raise FloatingPointError("the layers outgrew all numbers on the frozen slope")
    return h, R


def _reach(pile: Pile, rule: Rule, time: float, ends: Ends) -> Pile:
    """Whole steps of dt, then what is left of the way in one shorter step."""
    span = time - pile.t
    steps = math.floor(span / rule.dt * (1 + 1e-9))
    end = _advance_stably(pile, rule, steps, ends)
    left = span - steps * rule.dt
    if left > 1e-9 * rule.dt:
        end = _advance_stably(end, replace(rule, dt=left), 1, ends)
    return replace(end, t=time)


def _advance_stably(pile: Pile, rule: Rule, steps: int, ends: Ends) -> Pile:
    end = advance(pile, rule, steps, ends)
    _require_outlasted(pile, end.h, end.R, rule, steps, ends)
    return end


def _require_outlasted(start: Pile, h: Array, R: Array, rule: Rule, steps: int, ends: Ends) -> None:
    """Raise where dt is no longer stable at the end of the steps."""
    try:
        _require_stable(h, R, rule, ends)
    except UnstableStep:
        _locate_instability(start, rule, steps, ends)
        raise


def _locate_instability(
    pile: Pile, rule: Rule, steps: int, ends: Ends, together: int = BLOCK
) -> None:
    """Take the steps again, ``together`` at a time, and raise where dt ceased to be stable.

    An instability that begins and ends within ``together`` steps is not seen.
    """
    for done in range(0, steps, together):
        h, R = pile.h.copy(), pile.R.copy()
        part = min(together, steps - done)
        kernels.march(h, R, rule, part, ends)
        try:
            _require_stable(h, R, rule, ends)
        except UnstableStep as outgrown:
            if part > 1:
                _locate_instability(pile, rule, part, ends, together=1)
            finite = np.isfinite(h) & np.isfinite(R)
            cell = int(np.argmax(R)) if finite.all() else int(np.argmin(finite))
            raise FloatingPointError(
                f"the avalanche outgrew the step at t = {pile.t + part * rule.dt:.6g}, in cell "
                f"{cell}: {outgrown}"
            ) from None
        pile = replace(pile, h=h, R=R, t=pile.t + part * rule.dt)


def _follow(pile: Pile, rule: Rule, time: float, ends: Ends, margin: float) -> Pile:
    h, R = pile.h.copy(), pile.R.copy()
    span, blocks = time - pile.t, max(AT_ONCE // (h.size * BLOCK), 1)
    if span <= 1e-12 * abs(time):
        return replace(pile, t=time)
    while span > 0:
        done = kernels.follow(h, R, rule, span, blocks, margin, ends)
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
