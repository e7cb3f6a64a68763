"""The compiled automaton: many steps a call, equal to :mod:`bcre_ca.line.step` to the bit.

The kernels are ``sweep`` for the upwind and the calibrated scheme, ``second_order`` for the limited
one, ``in_place`` for the in-place readings and ``frozen`` for a frozen slope. ``driver`` decides
where they run, ``bounds`` how long a step may be, and ``following`` leads them to a wanted time.
Their expressions are those of the plain step, in the same order, without fused or reassociated
arithmetic.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from bcre_ca.coefficients import Coefficients, every_term
from bcre_ca.kept import kept
from bcre_ca.line.drops import drops, period_drop
from bcre_ca.line.kernels import bounds, driver, following
from bcre_ca.line.kernels.following import Course, State
from bcre_ca.rule import Ends, Rule

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

BLOCK = driver.BLOCK

AT_ONCE = 200_000_000
"""Cell-steps of one compiled call, which Ctrl-C cannot interrupt."""

_march = kept(driver.march)
_march_frozen = kept(driver.march_frozen)
_follow = kept(following.follow)
_bound = kept(bounds.bound)


def march(h: Array, R: Array, rule: Rule, steps: int, ends: Ends, account: Array) -> None:
    """Take ``steps`` steps in place, stable or not.

    h and R have the shape (N,). ``account``, shape (2,), takes what left through the foot (times d:
    an area), and its rounding error.
    """
    for part in _parts(steps, h.size):
        _march_piles(h[None], R[None], rule, part, ends, account[None], is_watched=False)


def march_watched(h: Array, R: Array, rule: Rule, steps: int, ends: Ends) -> Flags:
    """Take ``steps`` steps of many piles in place, shape (piles, N), shared among the processors.

    Returns for which piles dt has been stable after every :data:`BLOCK` steps; the others stop
    where it was not.
    """
    accounts, has_outlasted = np.zeros((len(h), 2)), np.ones(len(h), bool)

    def share(of: slice, part: int) -> Flags:
        return _march_piles(h[of], R[of], rule, part, ends, accounts[of], is_watched=True)

    threads = min(numba.get_num_threads(), len(h))
    shares = [slice(len(h) * i // threads, len(h) * (i + 1) // threads) for i in range(threads)]
    for part in _parts(steps, h.size):
        if threads == 1:
            has_outlasted &= share(shares[0], part)
        else:
            with ThreadPoolExecutor(threads) as pool:
                has_outlasted &= np.concatenate(list(pool.map(share, shares, [part] * threads)))
        if not has_outlasted.all():
            break
    return has_outlasted


def march_frozen(h: Array, R: Array, rule: Rule, steps: int, ends: Ends, surface: Array) -> None:
    """Take ``steps`` steps in place whose exchange sees the slope of ``surface``."""
    K, fall = _as_type(rule.coefficients(), h.dtype), _fall(rule, h, ends)
    _, below = drops(surface, K.repose_drop, fall)
    for part in _parts(steps, h.size):
        _march_frozen(h, R, below, K, part, np.zeros(2), fall)


def follow(
    state: State,
    rule: Rule,
    ends: Ends,
    course: Course,
    until: float,
    clock: Array,
    counts: NDArray[np.int64],
    middle: State,
) -> int:
    """Change the state until the time ``until`` lies in the last block of steps, or behind it.

    See :func:`bcre_ca.line.kernels.following.follow`; returns how it ended.
    """
    p, fall = rule.parameters(), _fall(rule, state.h, ends)
    blocks = max(AT_ONCE // (state.h.size * BLOCK), 1)
    ended = following.UNDERWAY
    while ended == following.UNDERWAY:
        ended = int(_follow(state, p, course, until, blocks, fall, clock, counts, middle))
    return ended


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


def _march_piles(
    h: Array, R: Array, rule: Rule, steps: int, ends: Ends, accounts: Array, is_watched: bool
) -> Flags:
    K, p = _as_type(rule.coefficients(), h.dtype), every_term(rule.parameters())
    has_outlasted, dt = np.empty(len(h), bool), float(rule.dt)
    _march(h, R, K, p, dt, steps, accounts, _fall(rule, h, ends), is_watched, has_outlasted)
    return has_outlasted


def _parts(steps: int, cells: int) -> list[int]:
    """The steps in parts of whole blocks, short enough to be interrupted between."""
    part = max(AT_ONCE // (cells * BLOCK), 1) * BLOCK
    return [min(part, steps - done) for done in range(0, steps, part)]


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
