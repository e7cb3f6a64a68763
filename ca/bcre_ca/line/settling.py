"""A pile that steps on until nothing rolls."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bcre_ca.line import kernels
from bcre_ca.line.evolve import MARGIN
from bcre_ca.line.kernels.following import ENDLESS, STEPS, Course, State, T
from bcre_ca.line.pile import Pile
from bcre_ca.rule import Rule


def settled(pile: Pile, rule: Rule, still: float, between: float) -> Pile:
    """The pile once R is nowhere more than ``still``, in steps that follow their bounds.

    Its ends are open: rolling sand drifts to the foot and leaves there.

    Parameters
    ----------
    pile, rule: as in :func:`bcre_ca.frames`.
    still: a length, > 0.
    between: time after which the layer is looked at again; the end is found as late as that.

    Raises
    ------
    FloatingPointError
        where the layers outgrow every step.
    """
    state = State(pile.h.copy(), pile.R.copy(), np.zeros(2))
    middle = State(pile.h.copy(), pile.R.copy(), np.zeros(2))
    course = Course(float(pile.t), 0.0, 0, MARGIN, rule.calibrating_step())
    clock, counts = np.zeros(4), np.zeros(6, np.int64)
    clock[T] = pile.t
    while state.R.max() > still:
        until = float(clock[T]) + between
        ended = kernels.follow(state, rule, "open", course, until, clock, counts, middle)
        if ended == ENDLESS:
            raise FloatingPointError(f"no step is short enough at t = {float(clock[T]):.6g}")
    return replace(
        pile,
        h=state.h,
        R=state.R,
        t=float(clock[T]),
        outflow=pile.outflow + float(state.account[0]) * rule.d,
        steps=pile.steps + int(counts[STEPS]),
    )
