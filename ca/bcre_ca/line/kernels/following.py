"""A march to a wanted time, block by block, in a fixed step or in one that follows its bounds.

No step depends on the time that is wanted. The block of steps in which that lies is taken whole,
and the state before the step in which it lies is kept on the way.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bcre_ca.coefficients import every_term, fold
from bcre_ca.inner import inner
from bcre_ca.line.kernels.bounds import limits_within, stable_step
from bcre_ca.line.kernels.driver import BLOCK, moving_cells, take, window
from bcre_ca.rule import ROUNDING

Array = NDArray[np.float64]

MOST_HALVINGS = 60

UNDERWAY, REACHED, AT_REST, OUTGROWN, ENDLESS = range(5)
"""How a march ends: all blocks taken; the time reached; nothing moves any more; a fixed step is no
longer stable; no step is short enough."""


class Course(NamedTuple):
    """What is decided for a whole run.

    start: its first time.
    step: the fixed step, or 0 where it follows the bounds.
    steps: number of fixed steps.
    margin: share of the bound that a step takes.
    calibrating: smallest step wanted, where the bound allows it.
    longest: a step that is long enough where there is no bound.
    """

    start: float
    step: float
    steps: int
    margin: float
    calibrating: float
    longest: float = math.inf


T, FORMER, BEGAN, DT = range(4)
"""Of a clock: the time, the step wanted last, and of the last block its start and its step."""

STEPS, LOWERED, RAISED, REDONE, LENGTH, BEFORE = range(6)
"""Of counts: what :class:`bcre_ca.Pile` counts; the steps of the last block, and those of them that
precede the step in which the wanted time lies."""


class State(NamedTuple):
    """Layers, and the account of what has left through the foot."""

    h: Array
    R: Array
    account: Array


@inner
def same_time(t: float, dt: float) -> float:
    """Time by which a wanted time may miss the end of a step and still be that."""
    return max(1e-9 * dt, 1e-15 * abs(t))


@inner
def steps_before(span: float, near: float, dt: float, most: int) -> int:
    """Whole steps in a span that may be longer by ``near``, at most so many."""
    if span + near >= most * dt:
        return most
    return int((span + near) / dt)


@inner
def _wanted(bound, course):
    """A calibrated rule wants at least the step at which its diffusion is the one asked for."""
    wanted = course.margin * bound
    if wanted < course.calibrating <= bound:
        return course.calibrating
    return wanted


@inner
def _bound(h, R, every, period_drop, a, b, whole):
    largest, sink = limits_within(h, R, every, period_drop, a, b, whole)
    return stable_step(every, largest, sink)


@inner
def _copy(state, a, b, to):
    for i in range(a, b):
        to.h[i] = state.h[i]
        to.R[i] = state.R[i]
    to.account[0] = state.account[0]
    to.account[1] = state.account[1]


@inner
def _note(clock, counts, t, dt, wanted, length, before):
    """A block of ``length`` steps of dt is over, and the time is t."""
    former = clock[FORMER]
    counts[LOWERED] += 1 if wanted < former * (1.0 - 1e-9) else 0
    counts[RAISED] += 1 if 0 < former * (1.0 + 1e-9) < wanted else 0
    counts[STEPS] += length
    counts[LENGTH], counts[BEFORE] = length, before
    clock[BEGAN], clock[T] = clock[T], t
    clock[FORMER], clock[DT] = wanted, dt


def follow(state, p, course, until, blocks, period_drop, clock, counts, middle):
    """Change the state by at most ``blocks`` blocks, until the time ``until`` lies in one of them.

    ``middle`` is then the state before the step in which it lies, unless that is after the block. A
    block at whose end the bound has been passed is taken back and repeated in steps of half the
    length. Compiled by :func:`bcre_ca.kept.kept`.
    """
    h, R, account = state.h, state.R, state.account
    every = every_term(p)
    old = State(np.empty_like(h), np.empty_like(R), np.empty_like(account))
    low, high = moving_cells(R, 0, R.size, p.scheme)
    a, b, whole = window(h.size, low, high, period_drop, p.scheme)
    bound = _bound(h, R, every, period_drop, a, b, whole)
    for _ in range(blocks):
        if low >= high or bound == math.inf:
            return AT_REST
        wanted, length = course.step, BLOCK
        if course.step > 0:
            length = min(length, course.steps - counts[STEPS])
        else:
            wanted = _wanted(bound, course)
            _copy(state, a, b, old)
        dt, t = wanted, clock[T]
        for _ in range(MOST_HALVINGS):
            before, done = steps_before(until - t, same_time(t, dt), dt, length), 0
            for stop in (before, length):
                if done < stop:
                    low, high = take(
                        h, R, fold(p, dt), stop - done, account, period_drop, a, b, whole
                    )
                    done = stop
                if done == before < length:
                    _copy(state, 0, h.size, middle)
            bound = _bound(h, R, every, period_drop, a, b, whole)
            if dt <= bound * (1.0 + ROUNDING):
                break
            if course.step > 0:
                return OUTGROWN
            _copy(old, a, b, state)
            low, high = moving_cells(R, a, b, p.scheme)
            dt = dt / 2
            counts[REDONE] += 1
        else:
            return ENDLESS
        end = t + length * dt
        if course.step > 0:
            end = course.start + (counts[STEPS] + length) * dt
        _note(clock, counts, end, dt, wanted, length, before)
        if until <= end + same_time(t, dt):
            return REACHED
        at = window(h.size, low, high, period_drop, p.scheme)
        if at != (a, b, whole):
            a, b, whole = at
            bound = _bound(h, R, every, period_drop, a, b, whole)
    return UNDERWAY
