"""The compiled automaton: many steps a call, in place, equal to :mod:`bcre_ca.step` to the bit.

Start at ``sweep`` for the rule itself; ``limited`` and ``in_place`` are its other forms, and
``driver`` decides where and for how long they run. The functions here choose among what was
compiled; expressions are those of ``step.py``, in the same order, without fused or
reassociated arithmetic.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bcre_ca.coefficients import Coefficients, Parameters
from bcre_ca.kernels import driver
from bcre_ca.rule import Ends, Rule
from bcre_ca.sources import SOURCES
from bcre_ca.step import period_drop

Array = NDArray[np.float64]

BLOCK = driver.BLOCK


_fixed, _followed, _batch, _bound = driver.entries(SOURCES)


class Followed(NamedTuple):
    """What a march under the bounds did; ``left`` of the span is negative where it gave up."""

    left: float
    outflow: float
    steps: int
    lowered: int
    raised: int
    redone: int


def march(h: Array, R: Array, rule: Rule, steps: int, ends: Ends) -> float:
    """Take ``steps`` steps in place; return what left through the foot (times d: an area).

    h and R have the shape (N,), or (scenes, N) for scenes that do not touch each other and are
    shared out among the processors; what left is then summed over them.
    """
    K = _as_type(rule.coefficients(), h.dtype)
    limited, rightwards = rule.parameters().limited, _rightwards(rule)
    fall = _fall(rule, h, ends)
    accounts = np.zeros((*h.shape[:-1], 2))
    run = _fixed if h.ndim == 1 else _batch
    run(h, R, K, steps, accounts, fall, limited, rightwards)
    return math.fsum(accounts[..., 0].ravel())


def follow(
    h: Array, R: Array, rule: Rule, span: float, blocks: int, margin: float, ends: Ends
) -> Followed:
    """March over the time ``span`` in steps of ``margin`` of the largest stable one, in place.

    At most ``blocks`` blocks of :data:`BLOCK` steps are taken; the rest of the span is left.
    """
    account, counts = np.zeros(2), np.zeros(4, np.int64)
    left = _followed(
        h,
        R,
        rule.parameters(),
        span,
        blocks,
        margin,
        rule.calibrating_step(),
        account,
        _fall(rule, h, ends),
        _rightwards(rule),
        counts,
    )
    return Followed(float(left), float(account[0]), *(int(count) for count in counts))


def stable_step(h: Array, R: Array, rule: Rule, ends: Ends) -> float:
    """The largest stable step for these layers; NaN where they are not finite."""
    return float(_bound(h, R, rule.parameters(), _fall(rule, h, ends)))


def _rightwards(rule: Rule) -> bool | None:
    """None tells the compiler that the rule is synchronous."""
    return None if rule.order == "synchronous" else rule.order == "right"


def _fall(rule: Rule, h: Array, ends: Ends) -> float | None:
    """In the number type of h; None tells the compiler that the ends are open."""
    return h.dtype.type(period_drop(rule, h.shape[-1])) if ends == "periodic" else None


def _as_type(K: Coefficients, dtype: np.dtype[np.float64]) -> Coefficients:
    """The coefficients in the number type of the layers, which then is that of the arithmetic."""
    if dtype == np.float64:
        return K
    return Coefficients._make(None if value is None else dtype.type(value) for value in K)


__all__ = ["BLOCK", "Followed", "Parameters", "follow", "march", "stable_step"]
