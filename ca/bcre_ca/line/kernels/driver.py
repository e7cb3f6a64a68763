"""Where and for how long the kernels run: on the wet cells only, for a number of steps or a span.

Nothing moves outside the window from the first to the last wet cell, and in the synchronous rule
the window grows by one cell a step at either end. A block of steps therefore runs on the window
widened by as many cells, and the window is found anew after it. The window must not cross joined
ends: where it would, and in the in-place readings, the whole pile is stepped.

``march``, ``march_frozen``, ``follow`` and ``bounds`` are compiled by :func:`bcre_ca.kept.kept`.
"""

from __future__ import annotations

import math

import numba
import numpy as np
from numba.extending import register_jitable

from bcre_ca.coefficients import (
    InPlace,
    Limited,
    by_scheme,
    coefficients_in,
    every_term,
    fold,
    largest_step,
    parameters_in,
)
from bcre_ca.line.kernels import frozen, in_place, second_order, sweep

BLOCK = 64
"""Steps after which the window is found anew, and the bounds where the step follows them."""

REACH = 2
"""Cells that a step reads beyond a wet one."""

MOST_HALVINGS = 60

# What a followed march counts.
STEPS, LOWERED, RAISED, REDONE = 0, 1, 2, 3


def _upwind_steps(h, R, K, steps, account, period_drop, scheme):  # type: ignore[no-untyped-def]
    if period_drop is None:
        sweep.open_ends(h, R, K, steps, account)
    else:
        sweep.periodic(h, R, K, steps, period_drop)


def _limited_steps(h, R, K, steps, account, period_drop, scheme):  # type: ignore[no-untyped-def]
    if period_drop is None:
        second_order.open_ends(h, R, K, steps, account)
    else:
        second_order.periodic(h, R, K, steps, period_drop)


def _in_place_steps(h, R, K, steps, account, period_drop, scheme):  # type: ignore[no-untyped-def]
    in_place.sweep(h, R, K, steps, account, period_drop)


_take = by_scheme(_upwind_steps, {Limited: _limited_steps, InPlace: _in_place_steps})

_steps_whole = by_scheme(lambda scheme: False, {InPlace: lambda scheme: True})


@numba.njit(error_model="numpy")
def wet_cells(R, low, high):  # type: ignore[no-untyped-def]
    """First cell of [low, high) with R other than 0, and the cell after the last one."""
    while low < high and R[low] == 0:
        low += 1
    while high > low and R[high - 1] == 0:
        high -= 1
    return low, high


@numba.njit(error_model="numpy")
def window(size, low, high, steps, period_drop, scheme):  # type: ignore[no-untyped-def]
    """Cells [a, b) that the next steps can read or change, and whether that is the whole pile."""
    a, b = low - steps - REACH, high + steps + REACH
    if _steps_whole(scheme):
        return 0, size, True
    if period_drop is not None and (a < 0 or b > size):
        return 0, size, True
    return max(a, 0), min(b, size), False


@numba.njit(error_model="numpy")
def _block(h, R, K, steps, account, period_drop, low, high):  # type: ignore[no-untyped-def]
    """``steps`` steps where it is wet, [low, high); the wet cells afterwards."""
    a, b, whole = window(h.size, low, high, steps, period_drop, K.scheme)
    if whole:
        _take(h, R, K, steps, account, period_drop, K.scheme)
    else:
        _take(h[a:b], R[a:b], K, steps, account, None, K.scheme)
    return wet_cells(R, a, b)


@numba.njit(error_model="numpy")
def fixed(h, R, K, steps, account, period_drop):  # type: ignore[no-untyped-def]
    """``steps`` steps with the coefficients K."""
    low, high = wet_cells(R, 0, R.size)
    done = 0
    while done < steps and low < high:
        together = min(BLOCK, steps - done)
        low, high = _block(h, R, K, together, account, period_drop, low, high)
        done += together


@numba.njit(error_model="numpy")
def _float_of(bits):  # type: ignore[no-untyped-def]
    return np.int64(bits).view(np.float64)


@numba.njit(error_model="numpy")
def _extremes(h, R, repose_drop):  # type: ignore[no-untyped-def]
    """Largest R and largest shortfall of a drop, both >= 0.

    Numbers >= 0 are ordered as the integers with the same bits, and a largest integer is found
    several at a time, which a largest float is not.
    """
    largest, shortfall = np.int64(0), np.int64(0)
    for i in range(R.size):
        largest = max(largest, np.float64(max(R[i], 0.0)).view(np.int64))
    for i in range(h.size - 1):
        missing = max(repose_drop - (h[i] - h[i + 1]), 0.0)
        shortfall = max(shortfall, np.float64(missing).view(np.int64))
    return _float_of(largest), _float_of(shortfall)


@numba.njit(error_model="numpy")
def _largest_bend(h, kappa):  # type: ignore[no-untyped-def]
    """Largest h(i-1) - 2 h(i) + h(i+1), or 0; looked for only where it counts."""
    if kappa == 0:
        return 0.0
    largest = np.int64(0)
    for i in range(h.size - 2):
        bend = max((h[i] - h[i + 1]) - (h[i + 1] - h[i + 2]), 0.0)
        largest = max(largest, np.float64(bend).view(np.int64))
    return _float_of(largest)


@numba.njit(error_model="numpy", fastmath={"reassoc"})
def _is_finite(h, R):  # type: ignore[no-untyped-def]
    total = 0.0
    for i in range(h.size):
        total += h[i] * 0.0 + R[i] * 0.0
    return total == 0.0


@numba.njit(error_model="numpy")
def stable_step(h, R, p, period_drop, foot):  # type: ignore[no-untyped-def]
    """The largest stable step for these layers; NaN where they are not finite.

    p holds every term. ``foot`` says whether the last cell is that at the open foot, beyond which
    the surface goes on at repose, rather than one inside the pile.
    """
    if not _is_finite(h, R):
        return math.nan
    last, repose_drop = h.size - 1, p.repose_slope * p.d
    largest, shortfall = _extremes(h, R, repose_drop)
    bend = _largest_bend(h, p.kappa)
    if period_drop is not None:
        across = h[last] - (h[0] - period_drop)
        shortfall = max(shortfall, repose_drop - across)
        before = h[last - 1] - h[last] if last > 0 else across
        after = h[0] - h[1] if last > 0 else across
        bend = max(bend, before - across, across - after)
    elif foot and last > 0:
        bend = max(bend, (h[last - 1] - h[last]) - repose_drop)
    sink = p.gamma * shortfall / p.d
    if p.kappa > 0:
        sink += p.kappa * bend / p.d**2
    return largest_step(p, largest, sink)


@numba.njit(error_model="numpy")
def _bound(h, R, p, period_drop, a, b, whole):  # type: ignore[no-untyped-def]
    if whole:
        return stable_step(h, R, p, period_drop, True)
    return stable_step(h[a:b], R[a:b], p, None, period_drop is None and b == h.size)


@numba.njit(error_model="numpy")
def _plan(span, bound, margin, calibrating):  # type: ignore[no-untyped-def]
    """Number of steps, their dt, and the dt wanted while the end of the span is far.

    A calibrated rule wants at least the step from which on its diffusion is the one asked for.
    """
    wanted = margin * bound
    if wanted < calibrating <= bound:
        wanted = calibrating
    steps = max(math.ceil(span / wanted), 1)
    if steps > 1 and span / steps < calibrating and span / (steps - 1) <= bound:
        steps -= 1
    if steps > BLOCK:
        return BLOCK, wanted, wanted
    return steps, span / steps, wanted


@numba.njit(error_model="numpy")
def _copy(h, R, account, to_h, to_R, to_account):  # type: ignore[no-untyped-def]
    for i in range(h.size):
        to_h[i] = h[i]
    for i in range(R.size):
        to_R[i] = R[i]
    to_account[0] = account[0]
    to_account[1] = account[1]


def follow(  # type: ignore[no-untyped-def]
    h, R, p, span, blocks, margin, calibrating, account, period_drop, counts
):
    """At most ``blocks`` blocks of steps whose dt is ``margin`` of the largest stable one.

    A block at whose end the bound has been passed is taken back and repeated in steps of half the
    length. Returns what is left of the span; negative where no step was short enough.
    """
    every = every_term(p)
    old_h, old_R, old_account = np.empty_like(h), np.empty_like(R), account.copy()
    low, high = wet_cells(R, 0, R.size)
    a, b, whole = window(h.size, low, high, BLOCK, period_drop, p.scheme)
    bound = _bound(h, R, every, period_drop, a, b, whole)
    former = 0.0
    end = 1e-12 * span
    for _ in range(blocks):
        if span <= end or low >= high:
            return 0.0
        steps, dt, wanted = _plan(span, bound, margin, calibrating)
        _copy(h[a:b], R[a:b], account, old_h[a:b], old_R[a:b], old_account)
        for _ in range(MOST_HALVINGS):
            low, high = _block(h, R, fold(p, dt), steps, account, period_drop, low, high)
            bound = _bound(h, R, every, period_drop, a, b, whole)
            if dt <= bound * (1.0 + 1e-12):
                break
            _copy(old_h[a:b], old_R[a:b], old_account, h[a:b], R[a:b], account)
            low, high = wet_cells(R, a, b)
            dt = dt / 2
            counts[REDONE] += 1
        else:
            return -span
        counts[STEPS] += steps
        counts[LOWERED] += 1 if wanted < former * (1.0 - 1e-9) else 0
        counts[RAISED] += 1 if 0 < former * (1.0 + 1e-9) < wanted else 0
        former = wanted
        span -= steps * dt
        at = window(h.size, low, high, BLOCK, period_drop, p.scheme)
        if at != (a, b, whole):
            a, b, whole = at
            bound = _bound(h, R, every, period_drop, a, b, whole)
    return max(span, 0.0)


def march(h, R, piles, rows, K, steps, accounts, period_drops):  # type: ignore[no-untyped-def]
    """``steps`` steps of some of many piles, shape (piles, N), one after the other.

    Each has its own row of coefficients, with the same terms absent as in K, its own account, and
    its own period drop, or None in the place of all.
    """
    for j in range(piles.size):
        own, drop = coefficients_in(rows[j], K), _drop_of(period_drops, j)
        fixed(h[piles[j]], R[piles[j]], own, steps, accounts[j], drop)


def march_frozen(h, R, drop, K, steps, account, period_drop):  # type: ignore[no-untyped-def]
    """``steps`` steps on a frozen slope."""
    frozen.march(h, R, drop, K, steps, account, period_drop)


def bounds(h, R, piles, rows, scheme, largest, period_drops):  # type: ignore[no-untyped-def]
    """Fill in the largest stable steps of some of many piles, by their rows of parameters."""
    for j in range(piles.size):
        p, drop = parameters_in(rows[j], scheme), _drop_of(period_drops, j)
        largest[j] = stable_step(h[piles[j]], R[piles[j]], p, drop, True)


@register_jitable
def _drop_of(period_drops, j):  # type: ignore[no-untyped-def]
    if period_drops is None:
        return None
    return period_drops[j]
