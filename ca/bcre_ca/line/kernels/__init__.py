"""The compiled automaton: many steps a call, equal to :mod:`bcre_ca.line.step` to the bit.

The kernels are ``sweep`` for the upwind and the calibrated scheme, ``second_order`` for the limited
one, ``in_place`` for the in-place readings, ``container`` for lines with sources and walls, and
``frozen`` for a frozen slope. ``driver`` decides where they run, ``bounds`` how long a step may be,
and ``following`` leads them to a wanted time.
Their expressions are those of the plain step, in the same order, without fused or reassociated
arithmetic.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from bcre_ca.coefficients import Coefficients, Parameters, every_term, fold, row_of
from bcre_ca.kept import kept
from bcre_ca.line.container import parameters_of
from bcre_ca.line.drops import drops, period_drop
from bcre_ca.line.kernels import bounds, driver, following
from bcre_ca.line.kernels.following import Course, State
from bcre_ca.rule import Ends, Rule

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Piles = NDArray[np.int64]

BLOCK = driver.BLOCK

AT_ONCE = 200_000_000
"""Cell-steps of one compiled call, which Ctrl-C cannot interrupt."""

ONE = np.zeros(1, np.int64)
"""The only pile."""

_march = kept(driver.march)
_march_frozen = kept(driver.march_frozen)
_follow = kept(following.follow)
_stable_steps = kept(bounds.stable_steps)


def march(
    h: Array,
    R: Array,
    rule: Rule,
    steps: int,
    ends: Ends,
    account: Array,
    supply: Array | None = None,
) -> None:
    """Take ``steps`` steps in place, stable or not.

    h and R have the shape (N,). ``account``, shape (2,), takes what left through the foot (times d:
    an area), and its rounding error. ``supply``, length/time, shape (N,), is what sources pour.
    """
    for part in _parts(steps, h.size):
        _march_piles(h[None], R[None], [rule], ONE, part, ends, account[None], False, supply)


def march_watched(
    h: Array,
    R: Array,
    rules: Sequence[Rule],
    steps: int,
    ends: Ends,
    supply: Array | None = None,
) -> Flags:
    """Take ``steps`` steps of many piles in place, shape (piles, N), a rule each.

    They are shared out among the processors. Returns for which piles dt has been stable after every
    :data:`BLOCK` steps; the others stop where it was not.
    """
    accounts, has_outlasted = np.zeros((len(h), 2)), np.ones(len(h), bool)
    terms = [_terms(parameters_of(rule, ends, h.shape[1], supply)) for rule in rules]
    for part in _parts(steps, h.shape[1]):

        def march_some(piles: Piles, part: int = part) -> None:
            own, account = [rules[i] for i in piles], accounts[piles]
            found = _march_piles(h, R, own, piles, part, ends, account, True, supply)
            has_outlasted[piles], accounts[piles] = found, account

        _shared_out(march_some, terms, max(AT_ONCE // max(h.shape[1] * part, 1), 1))
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
    supply: Array | None = None,
) -> int:
    """Change the state until the time ``until`` lies in the last block of steps, or behind it.

    See :func:`bcre_ca.line.kernels.following.follow`; returns how it ended.
    """
    p = parameters_of(rule, ends, state.h.size, supply, course.longest)
    fall = _fall(rule, state.h, ends)
    blocks = max(AT_ONCE // (state.h.size * BLOCK), 1)
    ended = following.UNDERWAY
    while ended == following.UNDERWAY:
        ended = int(_follow(state, p, course, until, blocks, fall, clock, counts, middle))
    return ended


def stable_step(h: Array, R: Array, rule: Rule, ends: Ends, supply: Array | None = None) -> float:
    """The largest stable step for these layers; NaN where they are not finite."""
    every = every_term(parameters_of(rule, ends, h.size, supply))
    falls = _falls([rule], h, ends)
    return float(_bounds_of(h[None], R[None], [every], ONE, falls)[0])


def stable_steps(h: Array, R: Array, rules: Sequence[Rule], ends: Ends) -> Array:
    """:func:`stable_step` of many piles, shape (piles, N), a rule each; shape (piles,)."""
    largest = np.empty(len(rules))
    parameters = [parameters_of(rule, ends, h.shape[1]) for rule in rules]

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
    _stable_steps(h, R, piles, rows, parameters[0].scheme, largest, falls)
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
    if len(shares) == 1:
        return [function(np.asarray(shares[0]))]
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
    fields = (field for field in p.scheme if not isinstance(field, np.ndarray))
    return type(p.scheme), *fields


def stepped_cells(R: Array) -> int:
    """Cells that a block of steps of a synchronous rule visits: the wet ones and those in reach."""
    wet = np.flatnonzero(R)
    if wet.size == 0:
        return 0
    around = BLOCK + driver.REACH
    return int(min(wet[-1] + 1 + around, R.size) - max(wet[0] - around, 0))


def _march_piles(
    h: Array,
    R: Array,
    rules: Sequence[Rule],
    piles: Piles,
    steps: int,
    ends: Ends,
    accounts: Array,
    is_watched: bool,
    supply: Array | None,
) -> Flags:
    """March some of the piles, whose rules have the same terms."""
    of_rules = [parameters_of(rule, ends, h.shape[1], supply) for rule in rules]
    coefficients = [fold(p, float(rule.dt)) for p, rule in zip(of_rules, rules, strict=True)]
    rows = np.array([row_of(K) for K in coefficients], h.dtype)
    parameters = np.array([row_of(every_term(p)) for p in of_rules])
    K, dts = _as_type(coefficients[0], h.dtype), np.array([float(rule.dt) for rule in rules])
    falls, has_outlasted = _falls(rules, h, ends), np.empty(piles.size, bool)
    _march(h, R, piles, rows, K, parameters, dts, steps, accounts, falls, is_watched, has_outlasted)
    return has_outlasted


def _parts(steps: int, cells: int) -> list[int]:
    """The steps in parts of whole blocks, short enough to be interrupted between."""
    part = max(AT_ONCE // (cells * BLOCK), 1) * BLOCK
    return [min(part, steps - done) for done in range(0, steps, part)]


def _fall(rule: Rule, h: Array, ends: Ends) -> Any:
    """Of the repose line over the period, in the number type of h; None where none is joined."""
    fall = period_drop(rule, h.shape[-1], ends)
    return None if fall is None else h.dtype.type(fall)


def _falls(rules: Sequence[Rule], h: Array, ends: Ends) -> Any:
    """:func:`_fall` of each rule; None where no ends are joined."""
    if ends != "periodic":
        return None
    return np.array([_fall(rule, h, ends) for rule in rules], h.dtype)


def _as_type(K: Coefficients, dtype: np.dtype[np.float64]) -> Coefficients:
    """The coefficients in the number type of the layers, which then is that of the arithmetic."""
    if dtype == np.float64:
        return K
    *numbers, scheme = K
    return Coefficients._make([*(None if x is None else dtype.type(x) for x in numbers), scheme])
