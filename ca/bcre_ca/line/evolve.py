"""The automaton in time: a number of steps, chosen times, or a step that follows its bounds."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bcre_ca.line import kernels
from bcre_ca.line.pile import Pile, layers_of, require_ends, whole
from bcre_ca.line.recording import Recording
from bcre_ca.line.refusal import raise_outgrown, require_stable
from bcre_ca.line.sources import Source, stretches, supply_of
from bcre_ca.rule import Ends, Rule

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
    ends: ``"open"`` (closed top, open foot), ``"wall"`` (closed top, a wall at the foot) or
        ``"periodic"`` (in h + Sc x and R).
    frozen: a surface, shape (N,), whose slope S0 the exchange sees at every step instead of that
        of h: E = gamma R (S0 - Sc). For the synchronous upwind rule only.

    Raises
    ------
    UnstableStep
        where dt cannot be stable for this start.
    FloatingPointError
        where the layers have outgrown dt by the end, or after any :data:`BLOCK` steps.
    ValueError
        for layers of unequal or wrong shape, empty or not finite.
    """
    static, rolling = layers_of(h, R, rank=1)
    steps = whole(steps)
    require_ends(ends)
    if frozen is not None:
        surface = np.asarray(frozen, static.dtype)
        return _evolve_frozen(static, rolling, rule, steps, ends, surface)
    require_stable(static, rolling, rule, ends)
    start = static.copy(), rolling.copy()
    if not kernels.march_watched(static[None], rolling[None], [rule], steps, ends).all():
        raise_outgrown(*start, rule, steps, ends)
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
    is_stable = [one.dt for one in rules] <= kernels.stable_steps(static, rolling, rules, ends)
    for i in np.flatnonzero(~is_stable):  # or not finite, or stable but for rounding
        require_stable(static[i], rolling[i], rules[i], ends)
    start = static.copy(), rolling.copy()
    has_outlasted = kernels.march_watched(static, rolling, rules, steps, ends)
    if not has_outlasted.all():
        first = int(np.argmin(has_outlasted))
        raise_outgrown(start[0][first], start[1][first], rules[first], steps, ends)
    return static, rolling


def march(h: Array, R: Array, rule: Rule, steps: int, ends: Ends = "open") -> float:
    """Take steps in place, stable or not; h and R are contiguous arrays of shape (N,).

    Returns what left through the foot, in units of R (times d: an area).
    """
    if h.ndim != 1:
        raise ValueError(f"h has shape {h.shape}: must be (N,)")
    account = np.zeros(2)
    kernels.march(h, R, rule, steps, ends, account)
    return float(account[0])


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
    outflow = march(h, R, rule, steps, ends) * rule.d
    if not (np.isfinite(h).all() and np.isfinite(R).all()):
        raise_outgrown(pile.h, pile.R, rule, steps, ends, pile.t)
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
    sources: Sequence[Source] = (),
) -> Iterator[Pile]:
    """The pile at each of the ascending ``times``, with what ``sources`` pour.

    The steps do not depend on the times: between two steps the layers are interpolated linearly,
    which keeps mass and R >= 0. The last step may end after the last time.

    ``"auto"`` takes the share ``margin`` of the largest stable step, found anew after every
    :data:`BLOCK` steps. A block at whose end the bound has been passed is repeated in shorter
    steps, and a block is always taken whole. A fixed step is looked at as often, and once it has
    passed the last time.

    Raises
    ------
    UnstableStep
        for a fixed step that cannot be stable at the start.
    FloatingPointError
        for a fixed step that the avalanche outgrew, naming cell, time and bound.
    ValueError
        for sources beyond the line or between joined ends.
    """
    wanted = [float(time) for time in times]
    for before, time in zip([pile.t, *wanted], wanted, strict=False):
        if not before <= time < np.inf:
            raise ValueError(f"times = {wanted!r}: must ascend from t = {pile.t!r}")
    fixed = 0.0
    if step != "auto":
        rule = replace(rule, dt=step)
        supply = supply_of(sources, pile.t, pile.h.size, rule.d)
        require_stable(pile.h, pile.R, rule, ends, supply)
        fixed = float(rule.dt)
    if not sources:
        run = Recording(pile, rule, ends, fixed, margin, wanted[-1] if wanted else pile.t)
        return (run.at(time) for time in wanted)
    return _poured_on(pile, rule, wanted, ends, fixed, margin, sources)


def _poured_on(
    pile: Pile,
    rule: Rule,
    wanted: Sequence[float],
    ends: Ends,
    step: float,
    margin: float,
    sources: Sequence[Source],
) -> Iterator[Pile]:
    """:func:`frames` in stretches of time in which no source begins or ends."""
    left = list(wanted)
    for begin, end in stretches(sources, pile.t, left[-1] if left else pile.t):
        supply = supply_of(sources, begin, pile.h.size, rule.d)
        run = Recording(pile, rule, ends, step, margin, end, supply)
        while left and (left[0] < end or end == wanted[-1]):
            yield run.at(left.pop(0))
        if left:
            pile = run.at(end)


def largest_stable_step(pile: Pile, rule: Rule, ends: Ends) -> float:
    """:meth:`Rule.max_stable_step` for this pile; NaN where it is not finite."""
    return kernels.stable_step(pile.h, pile.R, rule, ends)


def _evolve_frozen(
    h: Array, R: Array, rule: Rule, steps: int, ends: Ends, surface: Array
) -> tuple[Array, Array]:
    """No surface wave bounds the step, and the slope that does stays as it is."""
    rule.require_upwind("a frozen slope")
    if surface.shape != h.shape:
        raise ValueError(f"frozen has shape {surface.shape}: must be that of h, {h.shape}")
    require_stable(surface, np.zeros_like(R), rule, ends)
    kernels.march_frozen(h, R, rule, steps, ends, surface)
    if not (np.isfinite(h).all() and np.isfinite(R).all()):
        raise FloatingPointError("the layers outgrew all numbers on the frozen slope")
    return h, R
