"""A run looked at between its steps, which do not depend on when that is."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bcre_ca.line import kernels
from bcre_ca.line.kernels.following import (
    AT_REST,
    BEFORE,
    BEGAN,
    DT,
    ENDLESS,
    LENGTH,
    LOWERED,
    OUTGROWN,
    RAISED,
    REDONE,
    STEPS,
    Course,
    State,
    T,
    same_time,
    steps_before,
)
from bcre_ca.line.pile import Pile
from bcre_ca.line.refusal import raise_outgrown
from bcre_ca.rule import Ends, Rule

Array = NDArray[np.float64]


class Recording:
    """A pile that steps on as far as the times that are asked for, none earlier than the last.

    Between two steps the layers and the outflow are interpolated linearly, which keeps mass and
    R >= 0. At the end of a step, to a thousand millionth of it, they are its own.

    Parameters
    ----------
    pile: where it begins; not changed.
    rule, ends: as everywhere.
    step: a fixed step, or 0 for one that follows the bounds.
    margin: part of the largest stable step that the latter takes.
    last: the last time that will be asked for; no fixed step begins after it.
    supply: what sources pour all the time, length/time, shape (N,).
    """

    def __init__(
        self,
        pile: Pile,
        rule: Rule,
        ends: Ends,
        step: float,
        margin: float,
        last: float,
        supply: Array | None = None,
    ) -> None:
        self._start, self._rule, self._ends, self._supply = pile, rule, ends, supply
        steps = _steps_to(last - pile.t, last, step)
        calibrating, longest = rule.calibrating_step(), float(last - pile.t)
        self._course = Course(float(pile.t), step, steps, margin, calibrating, longest)
        self._clock, self._counts = np.zeros(4), np.zeros(6, np.int64)
        self._clock[[T, BEGAN]] = pile.t
        self._state = _copy(State(pile.h, pile.R, np.zeros(2)))
        # Before the step in which the last time lay, and, once needed, after it.
        self._before = _copy(self._state)
        self._after: State | None = None
        self._place = 0

    def at(self, time: float) -> Pile:
        """The pile at a time.

        Raises
        ------
        FloatingPointError
            where the avalanche has outgrown the fixed step, or every step.
        """
        while time > self._clock[T] + self._near:
            if not self._step_on(time):
                steps = _steps_to(time - self._start.t, time, self._course.step)
                return self._pile(self._state, max(steps, int(self._counts[STEPS])), time)
        if time >= self._clock[T] - self._near:
            return self._pile(self._state, int(self._counts[STEPS]), time)
        return self._within_block(time)

    def until_still(self, still: float, between: float) -> Pile:
        """The pile once R is nowhere more than ``still``, looked at after every ``between``.

        Raises
        ------
        FloatingPointError
            as :meth:`at`.
        """
        while self._state.R.max() > still:
            self._step_on(float(self._clock[T]) + between)
        return self._pile(self._state, int(self._counts[STEPS]), float(self._clock[T]))

    @property
    def _near(self) -> float:
        """By which a time may miss the end of a step and still be that."""
        return float(same_time(float(self._clock[BEGAN]), float(self._clock[DT])))

    def _step_on(self, time: float) -> bool:
        """Step on to the time; False where nothing moves any more."""
        clock, counts, start, course = self._clock, self._counts, self._start, self._course
        ended = kernels.follow(
            self._state,
            self._rule,
            self._ends,
            course,
            time,
            clock,
            counts,
            self._before,
            self._supply,
        )
        self._place, self._after = int(counts[BEFORE]), None
        if ended == OUTGROWN:
            steps = min(int(counts[STEPS]) + kernels.BLOCK, course.steps)
            rule = replace(self._rule, dt=course.step)
            raise_outgrown(start.h, start.R, rule, steps, self._ends, start.t, self._supply)
        if ended == ENDLESS:
            raise FloatingPointError(
                f"no step is short enough at t = {float(clock[T]):.6g}: the layers outgrow every "
                "bound"
            )
        return ended != AT_REST

    def _within_block(self, time: float) -> Pile:
        """Between two steps of the last block, or at the end of one."""
        dt, since = float(self._clock[DT]), time - float(self._clock[BEGAN])
        place = steps_before(since, self._near, dt, kernels.BLOCK)
        if self._after is not None and place == self._place + 1:
            self._before, self._after = self._after, None
        elif place > self._place:
            self._march(self._before, place - self._place)
            self._after = None
        self._place = place
        steps = int(self._counts[STEPS] - self._counts[LENGTH]) + place
        beyond = since - place * dt
        if beyond <= self._near:
            return self._pile(self._before, steps, time)
        if self._after is None:
            self._after = _copy(self._before)
            self._march(self._after, 1)
        return self._pile(_between(self._before, self._after, beyond / dt), steps + 1, time)

    def _march(self, state: State, steps: int) -> None:
        rule = replace(self._rule, dt=float(self._clock[DT]))
        kernels.march(state.h, state.R, rule, steps, self._ends, state.account, self._supply)

    def _pile(self, state: State, steps: int, time: float) -> Pile:
        start, counts = self._start, self._counts
        return Pile(
            h=state.h.copy(),
            R=state.R.copy(),
            t=time,
            outflow=start.outflow + float(state.account[0]) * self._rule.d,
            steps=start.steps + steps,
            lowered=start.lowered + int(counts[LOWERED]),
            raised=start.raised + int(counts[RAISED]),
            redone=start.redone + int(counts[REDONE]),
        )


def _steps_to(span: float, time: float, step: float) -> int:
    """Number of fixed steps that reach the end of a span."""
    if step == 0:
        return 0
    return max(math.ceil((span - float(same_time(time, step))) / step), 0)


def _copy(state: State) -> State:
    return State(state.h.copy(), state.R.copy(), state.account.copy())


def _between(before: State, after: State, part: float) -> State:
    """Linear, and in no cell beyond either."""

    def mixed(a: Array, b: Array) -> Any:
        return np.clip((1 - part) * a + part * b, np.minimum(a, b), np.maximum(a, b))

    return State(*(mixed(a, b) for a, b in zip(before, after, strict=True)))
