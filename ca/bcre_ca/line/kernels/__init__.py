"""The compiled automaton: many steps a call, equal to :mod:`bcre_ca.line.step` to the bit.

The kernels are ``sweep`` for the upwind and the calibrated scheme, ``second_order`` for the limited
one, ``in_place`` for the in-place readings and ``frozen`` for a frozen slope; ``driver`` decides
where and for how long they run. Their expressions are those of the plain step, in the same order,
without fused or reassociated arithmetic.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any, NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from bcre_ca.coefficients import Coefficients, Parameters, every_term, row_of
from bcre_ca.kept import kept
from bcre_ca.line.drops import drops, period_drop
from bcre_ca.line.kernels import driver
from bcre_ca.rule import Ends, Rule

Array = NDArray[np.float64]
Piles = NDArray[np.int64]

AT_ONCE = 200_000_000
"""Cell-steps of one compiled call, which Ctrl-C cannot interrupt."""

ONE = np.zeros(1, np.int64)
"""The only pile."""

BLOCK = driver.BLOCK


_march = kept(driver.march)
_march_frozen = kept(driver.march_frozen)
_follow = kept(driver.follow)
_bounds = kept(driver.bounds)


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
        return _march_piles(h[None], R[None], [rule], ONE, steps, ends)
    K, account, fall = _as_type(rule.coefficients(), h.dtype), np.zeros(2), _fall(rule, h, ends)
    _, below = drops(frozen, K.repose_drop, fall)
    _march_frozen(h, R, below, K, steps, account, fall)
    return float(account[0])


def march_many(h: Array, R: Array, rules: Sequence[Rule], steps: int, ends: Ends) -> float:
    """:func:`march` for many piles, shape (piles, N), a rule each, shared out among processors."""

    def march_some(piles: Piles) -> float:
        return _march_piles(h, R, [rules[i] for i in piles], piles, steps, ends)

    terms = [_terms(rule.parameters()) for rule in rules]
    together = max(AT_ONCE // max(h.shape[1] * steps, 1), 1)
    return math.fsum(_shared_out(march_some, terms, together))


def _march_piles(
    h: Array, R: Array, rules: Sequence[Rule], piles: Piles, steps: int, ends: Ends
) -> float:
    """March some of the piles, whose rules have the same terms."""
    coefficients = [rule.coefficients() for rule in rules]
    rows = np.array([row_of(K) for K in coefficients], h.dtype)
    accounts, K = np.zeros((piles.size, 2)), _as_type(coefficients[0], h.dtype)
    _march(h, R, piles, rows, K, steps, accounts, _falls(rules, h, ends))
    return math.fsum(accounts[:, 0])


def stable_steps(h: Array, R: Array, rules: Sequence[Rule], ends: Ends) -> Array:
    """:func:`stable_step` of many piles, shape (piles, N), a rule each; shape (piles,)."""
    largest, parameters = np.empty(len(rules)), [rule.parameters() for rule in rules]

    def bound_some(piles: Piles) -> None:
        every = [every_term(parameters[i]) for i in piles]
        falls = _falls([rules[i] for i in piles], h, ends)
        largest[piles] = _bounds_of(h, R, every, piles, falls)

    _shared_out(bound_some, [_scheme(p) for p in parameters], len(rules))
    return largest


def _bounds_of(
    h: Array, R: Array, parameters: Sequence[Parameters], piles: Piles, falls: Any
) -> Array:
    """Of some of the piles, whose rules have the same scheme and no term absent."""
    rows, largest = np.array([row_of(p) for p in parameters]), np.empty(piles.size)
    _bounds(h, R, piles, rows, parameters[0].scheme, largest, falls)
    return largest


def _shared_out(function: Callable[[Piles], Any], kinds: Sequence[Any], together: int) -> list[Any]:
    """What the function returns of the piles of each kind, at most ``together`` in one call."""
    of_kind: dict[Any, list[int]] = {}
    for pile, kind in enumerate(kinds):
        of_kind.setdefault(kind, []).append(pile)
    threads = numba.get_num_threads()
    shares = [
        share
        for piles in of_kind.values()
        for share in np.array_split(
            piles, min(max(threads, -(-len(piles) // together)), len(piles))
        )
    ]
    pool = ThreadPoolExecutor(threads)
    try:
        return list(pool.map(function, shares))
    finally:
        pool.shutdown(cancel_futures=True)  # after Ctrl-C what has not begun need not be waited for


def _terms(p: Parameters) -> tuple[Any, ...]:
    """What is compiled for itself: which terms are absent, and the scheme."""
    return (*(term is None for term in p), *_scheme(p))


def _scheme(p: Parameters) -> tuple[Any, ...]:
    """With its type: schemes without a field are equal as tuples."""
    return type(p.scheme), p.scheme


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
    every, falls = every_term(rule.parameters()), _falls([rule], h, ends)
    return float(_bounds_of(h[None], R[None], [every], ONE, falls)[0])


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


def _falls(rules: Sequence[Rule], h: Array, ends: Ends) -> Any:
    """:func:`_fall` of each rule; None for open ends."""
    if ends == "open":
        return None
    return np.array([_fall(rule, h, ends) for rule in rules], h.dtype)


def _as_type(K: Coefficients, dtype: np.dtype[np.float64]) -> Coefficients:
    """The coefficients in the number type of the layers, which then is that of the arithmetic."""
    if dtype == np.float64:
        return K
    *numbers, scheme = K
    return Coefficients._make([*(None if x is None else dtype.type(x) for x in numbers), scheme])
