"""The compiled automaton: many steps a call, equal to :mod:`bcre_ca.line.step` to the bit.

The kernels are ``sweep`` for the upwind and the calibrated scheme, ``second_order`` for the limited
one, ``in_place`` for the in-place readings and ``frozen`` for a frozen slope; ``driver`` decides
where and for how long they run. Their expressions are those of the plain step, in the same order,
without fused or reassociated arithmetic.
"""

from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor
from typing import Any, NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from bcre_ca.coefficients import Coefficients, every_term
from bcre_ca.kept import kept
from bcre_ca.line.drops import drops, period_drop
from bcre_ca.line.kernels import driver
from bcre_ca.rule import Ends, Rule

Array = NDArray[np.float64]

BLOCK = driver.BLOCK


_march = kept(driver.march)
_march_frozen = kept(driver.march_frozen)
_follow = kept(driver.follow)
_bound = kept(driver.bound)


class Followed(NamedTuple):
    """What a march under the bounds did; ``left`` of the span is negative where it gave up."""

    left: float
    outflow: float
    steps: int
    lowered: int
    raised: int
    redone: int


def march(
    h: Array, R: Array, rule: Rule, steps: int, ends: Ends, frozen: Array | None = None
) -> float:
    """Take ``steps`` steps in place; return what left through the foot (times d: an area).

    h and R have the shape (N,). The exchange sees the slope of ``frozen`` where that is given.
    """
    if frozen is None:
        return _march_piles(h[None], R[None], rule, steps, ends)
    K, account, fall = _as_type(rule.coefficients(), h.dtype), np.zeros(2), _fall(rule, h, ends)
    _, below = drops(frozen, K.repose_drop, fall)
    _march_frozen(h, R, below, K, steps, account, fall)
    return float(account[0])


def march_many(h: Array, R: Array, rule: Rule, steps: int, ends: Ends) -> float:
    """:func:`march` for many piles, shape (piles, N), shared out among the processors."""
    threads = min(numba.get_num_threads(), len(h))
    shares = [slice(len(h) * i // threads, len(h) * (i + 1) // threads) for i in range(threads)]
    with ThreadPoolExecutor(threads) as pool:
        found = pool.map(lambda of: _march_piles(h[of], R[of], rule, steps, ends), shares)
    return math.fsum(found)


def _march_piles(h: Array, R: Array, rule: Rule, steps: int, ends: Ends) -> float:
    K, accounts = _as_type(rule.coefficients(), h.dtype), np.zeros((len(h), 2))
    _march(h, R, K, steps, accounts, _fall(rule, h, ends))
    return math.fsum(accounts[:, 0])


def follow(
    h: Array, R: Array, rule: Rule, span: float, blocks: int, margin: float, ends: Ends
) -> Followed:
    """March over the time ``span`` in steps of ``margin`` of the largest stable one, in place.

    At most ``blocks`` blocks of :data:`BLOCK` steps are taken; the rest of the span is left.
    """
    account, counts = np.zeros(2), np.zeros(4, np.int64)
    p, calibrating, fall = rule.parameters(), rule.calibrating_step(), _fall(rule, h, ends)
    left = _follow(h, R, p, span, blocks, margin, calibrating, account, fall, counts)
    return Followed(float(left), float(account[0]), *(int(count) for count in counts))


def stable_step(h: Array, R: Array, rule: Rule, ends: Ends) -> float:
    """The largest stable step for these layers; NaN where they are not finite."""
    return float(_bound(h, R, every_term(rule.parameters()), _fall(rule, h, ends)))


def stepped_cells(R: Array) -> int:
    """Cells that a block of steps of a synchronous rule visits: the wet ones and those in reach."""
    wet = np.flatnonzero(R)
    if wet.size == 0:
        return 0
    around = BLOCK + driver.REACH
    return int(min(wet[-1] + 1 + around, R.size) - max(wet[0] - around, 0))


def _fall(rule: Rule, h: Array, ends: Ends) -> Any:
    """Of the repose line over the period, in the number type of h; None for open ends."""
    fall = period_drop(rule, h.shape[-1], ends)
    return None if fall is None else h.dtype.type(fall)


def _as_type(K: Coefficients, dtype: np.dtype[np.float64]) -> Coefficients:
    """The coefficients in the number type of the layers, which then is that of the arithmetic."""
    if dtype == np.float64:
        return K
    *numbers, scheme = K
    return Coefficients._make([*(None if x is None else dtype.type(x) for x in numbers), scheme])
