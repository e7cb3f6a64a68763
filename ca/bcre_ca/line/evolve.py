"""The automaton in time: a number of steps, chosen times, or a step that follows its bounds."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bcre_ca.gate import (
    ascending,
    is_number,
    layers_of,
    numbers_of,
    require,
    require_all_of_kind,
    require_kind,
    require_start,
    whole,
)
from bcre_ca.line import kernels
from bcre_ca.line.pile import Pile, checked, line_of, require_ends
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
        naming the argument, for layers of unequal or wrong shape, empty, masked, not finite or
        negative in R, and for other arguments that are not allowed.
    """
    require_kind("rule", rule, Rule)
    static, rolling = line_of(h, R)
    require_start(static, rolling)
    steps = whole("steps", steps)
    require_ends(ends)
    if frozen is not None:
        surface = numbers_of("frozen", frozen).astype(static.dtype)
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
    static, rolling = layers_of(h, R, 2, "(piles, N) with N >= 1")
    require_start(static, rolling)
    rules = [rule] * len(static) if isinstance(rule, Rule) else list(rule)
    for one in rules:
        require_kind("rule", one, Rule)
    if len(rules) != len(static):
        raise ValueError(f"rule: there are {len(rules)} for {len(static)} piles; must be as many")
    steps = whole("steps", steps)
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

    Raises
    ------
    ValueError
        naming the argument, for layers that cannot be changed in place.
    """
    require_kind("rule", rule, Rule)
    require_ends(ends)
    steps = whole("steps", steps)
    _require_in_place(h, R)
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
    pile = checked(pile, is_start=False)
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
    require_kind("rule", rule, Rule)
    require_ends(ends)
    pile = checked(pile)
    wanted = ascending(times, pile.t)
    require_all_of_kind("sources", sources, Source)
    if not (is_number(margin) and 0 < margin <= 1):
        raise ValueError(f"margin = {margin!r}: must be a number > 0 and at most 1")
    fixed = 0.0
    if not (isinstance(step, str) and step == "auto"):
        rule = rule.with_step(step)
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
    require_kind("rule", rule, Rule)
    require_kind("pile", pile, Pile)
    require_ends(ends)
    return kernels.stable_step(*line_of(pile.h, pile.R), rule, ends)


def stepped_cells(R: ArrayLike) -> int:
    """Cells that a block of steps of a synchronous rule visits: the wet ones and those in reach."""
    layer = numbers_of("R", R)
    if layer.ndim != 1:
        raise ValueError(f"R has shape {layer.shape}: must be (N,)")
    return kernels.stepped_cells(layer)


def _require_in_place(h: Any, R: Any) -> None:
    """Raise ValueError where compiled code could not change the layers where they are."""
    for name, layer in (("h", h), ("R", R)):
        require_kind(name, layer, np.ndarray)
        if numbers_of(name, layer).dtype not in (np.float64, np.float32):
            raise ValueError(f"{name} has the type {layer.dtype}: must be float64 or float32")
        if layer.ndim != 1 or not layer.size:
            raise ValueError(f"{name} has shape {layer.shape}: must be (N,) with N >= 1")
        if not (layer.flags.c_contiguous and layer.flags.writeable):
            raise ValueError(f"{name}: must be contiguous and writeable, to be changed in place")
    if h.shape != R.shape or h.dtype != R.dtype:
        raise ValueError(
            f"R has shape {R.shape} and type {R.dtype}: must be those of h, {h.shape} and {h.dtype}"
        )
    if np.may_share_memory(h, R):
        raise ValueError("R: must not share its memory with h")


def _evolve_frozen(
    h: Array, R: Array, rule: Rule, steps: int, ends: Ends, surface: Array
) -> tuple[Array, Array]:
    """No surface wave bounds the step, and the slope that does stays as it is."""
    rule.require_upwind("a frozen slope")
    if surface.shape != h.shape:
        raise ValueError(f"frozen has shape {surface.shape}: must be that of h, {h.shape}")
    require("frozen", surface, np.isfinite(surface), "must be finite")
    require_stable(surface, np.zeros_like(R), rule, ends)
    kernels.march_frozen(h, R, rule, steps, ends, surface)
    if not (np.isfinite(h).all() and np.isfinite(R).all()):
        raise FloatingPointError("the layers outgrew all numbers on the frozen slope")
    return h, R
