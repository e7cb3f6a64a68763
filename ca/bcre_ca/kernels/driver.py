"""Driving the kernels: only where it is wet, so many steps or under the bounds, one scene or many.

Outside the window from the first to the last wet cell nothing moves, and in the synchronous rule
the window grows by one cell a step at either end; so a block of steps runs on the window widened by
as many cells, and the window is looked up again after it. The window must not cross joined
ends; where it would, and for the in-place readings, the whole pile is stepped.
"""

from __future__ import annotations

import math

import numba
import numpy as np

from bcre_ca.coefficients import fold, largest_step
from bcre_ca.kernels import in_place, limited, sweep

BLOCK = 64
"""Steps between two looks at the window, and at the bounds where the step follows them."""

SEES = 2
"""Cells that a step reads beyond a wet one."""

MOST_HALVINGS = 60

# What a followed march counts.
STEPS, LOWERED, RAISED, REDONE = 0, 1, 2, 3


@numba.njit(error_model="numpy")
def wet_cells(R, low, high):  # type: ignore[no-untyped-def]
    """First cell of [low, high) with R other than 0, and the cell after the last one."""
    while low < high and R[low] == 0:
        low += 1
    while high > low and R[high - 1] == 0:
        high -= 1
    return low, high


@numba.njit(error_model="numpy")
def _window(size, low, high, steps, fall, rightwards):  # type: ignore[no-untyped-def]
    """Cells [a, b) that the next steps can read or change, and whether that is the whole pile."""
    a, b = low - steps - SEES, high + steps + SEES
    if rightwards is not None:
        return 0, size, True
    if fall is not None and (a < 0 or b > size):
        return 0, size, True
    return max(a, 0), min(b, size), False


@numba.njit(error_model="numpy")
def _take(h, R, K, steps, account, fall, is_limited, rightwards):  # type: ignore[no-untyped-def]
    if rightwards is not None:
        in_place.sweep(h, R, K, steps, account, fall, rightwards)
    elif is_limited is None:
        if fall is None:
            sweep.open_ends(h, R, K, steps, account)
        else:
            sweep.periodic(h, R, K, steps, fall)
    elif fall is None:
        limited.open_ends(h, R, K, steps, account)
    else:
        limited.periodic(h, R, K, steps, fall)


@numba.njit(error_model="numpy")
def _block(  # type: ignore[no-untyped-def]
    h, R, K, steps, account, fall, is_limited, rightwards, low, high
):
    """``steps`` steps where it is wet, [low, high); the wet cells afterwards."""
    a, b, whole = _window(h.size, low, high, steps, fall, rightwards)
    if whole:
        _take(h, R, K, steps, account, fall, is_limited, rightwards)
    else:
        _take(h[a:b], R[a:b], K, steps, account, None, is_limited, rightwards)
    return wet_cells(R, a, b)


@numba.njit(error_model="numpy")
def fixed(h, R, K, steps, account, fall, is_limited, rightwards):  # type: ignore[no-untyped-def]
    """``steps`` steps with the coefficients K."""
    low, high = wet_cells(R, 0, R.size)
    done = 0
    while done < steps and low < high:
        together = min(BLOCK, steps - done)
        low, high = _block(h, R, K, together, account, fall, is_limited, rightwards, low, high)
        done += together


@numba.njit(error_model="numpy")
def _float_of(bits):  # type: ignore[no-untyped-def]
    return np.int64(bits).view(np.float64)


@numba.njit(error_model="numpy")
def _extremes(h, R, repose_drop):  # type: ignore[no-untyped-def]
    """Largest R, largest shortfall of a drop, and largest bend between neighbours; all >= 0.

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
    if kappa is None:
        return 0.0
    largest = np.int64(0)
    for i in range(h.size - 2):
        bend = max((h[i] - h[i + 1]) - (h[i + 1] - h[i + 2]), 0.0)
        largest = max(largest, np.float64(bend).view(np.int64))
    return _float_of(largest)


@numba.njit(error_model="numpy")
def _bend_at_foot(h, repose_drop, kappa):  # type: ignore[no-untyped-def]
    """That of the last cell, beyond which the surface goes on at repose."""
    if kappa is None or h.size == 1:
        return 0.0
    return (h[h.size - 2] - h[h.size - 1]) - repose_drop


@numba.njit(error_model="numpy", fastmath={"reassoc"})
def _is_finite(h, R):  # type: ignore[no-untyped-def]
    total = 0.0
    for i in range(h.size):
        total += h[i] * 0.0 + R[i] * 0.0
    return total == 0.0


@numba.njit(error_model="numpy")
def stable_step(h, R, p, fall, foot):  # type: ignore[no-untyped-def]
    """The largest stable step for these layers; NaN where they are not finite.

    ``foot`` says whether the last cell is that at the open foot rather than one of a window.
    """
    if not _is_finite(h, R):
        return math.nan
    largest, shortfall = _extremes(h, R, p.slope * p.d)
    bend = _largest_bend(h, p.kappa)
    if fall is not None:
        last = h.size - 1
        across = h[last] - (h[0] - fall)
        shortfall = max(shortfall, p.slope * p.d - across)
        before = h[last - 1] - h[last] if last > 0 else across
        after = h[0] - h[1] if last > 0 else across
        bend = max(bend, before - across, across - after)
    elif foot:
        bend = max(bend, _bend_at_foot(h, p.slope * p.d, p.kappa))
    return largest_step(p, largest, _sink(p.gamma * shortfall / p.d, bend, p.d, p.kappa))


@numba.njit(error_model="numpy")
def _sink(loss, bend, d, kappa):  # type: ignore[no-untyped-def]
    if kappa is None:
        return loss
    return loss + kappa * bend / d**2


@numba.njit(error_model="numpy")
def _bound(h, R, p, fall, a, b, whole):  # type: ignore[no-untyped-def]
    if whole:
        return stable_step(h, R, p, fall, True)
    return stable_step(h[a:b], R[a:b], p, None, fall is None and b == h.size)


@numba.njit(error_model="numpy")
def _plan(span, bound, margin, calibrating):  # type: ignore[no-untyped-def]
    """Steps until the end of the span, their dt, and the dt wanted for as long as it is far.

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


@numba.njit(error_model="numpy")
def followed(  # type: ignore[no-untyped-def]
    h, R, p, span, blocks, margin, calibrating, account, fall, rightwards, counts
):
    """At most so many blocks of steps whose dt is ``margin`` of the largest stable one.

    A block at whose end the bound has been passed is taken back and repeated in steps of half the
    length. Returns what is left of the span; negative where no step was short enough.
    """
    old_h, old_R, old_account = np.empty_like(h), np.empty_like(R), account.copy()
    low, high = wet_cells(R, 0, R.size)
    a, b, whole = _window(h.size, low, high, BLOCK, fall, rightwards)
    bound = _bound(h, R, p, fall, a, b, whole)
    former = 0.0
    end = 1e-12 * span
    for _ in range(blocks):
        if span <= end or low >= high:
            return 0.0
        steps, dt, wanted = _plan(span, bound, margin, calibrating)
        _copy(h[a:b], R[a:b], account, old_h[a:b], old_R[a:b], old_account)
        for _ in range(MOST_HALVINGS):
            low, high = _block(
                h, R, fold(p, dt), steps, account, fall, p.limited, rightwards, low, high
            )
            bound = _bound(h, R, p, fall, a, b, whole)
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
        at = _window(h.size, low, high, BLOCK, fall, rightwards)
        if at != (a, b, whole):
            a, b, whole = at
            bound = _bound(h, R, p, fall, a, b, whole)
    return max(span, 0.0)


@numba.njit(error_model="numpy")
def _one_of(h, R, K, steps, accounts, fall, is_limited, rightwards, scene):  # type: ignore[no-untyped-def]
    """A function of its own: the loop below would not be compiled correctly around its body."""
    fixed(h[scene], R[scene], K, steps, accounts[scene], fall, is_limited, rightwards)


def entries(sources: str):  # type: ignore[no-untyped-def]
    """The compiled functions that Python calls: ``march``, ``follow``, ``batch``, ``bound``.

    Their machine code is kept on disk, under a key in which the values that a function closes over
    count but the files of the functions it calls do not: hence ``sources``, a digest of those.
    """

    @numba.njit(cache=True, error_model="numpy")
    def march(h, R, K, steps, account, fall, is_limited, rightwards):  # type: ignore[no-untyped-def]
        sources  # noqa: B018
        fixed(h, R, K, steps, account, fall, is_limited, rightwards)

    @numba.njit(cache=True, error_model="numpy")
    def follow(  # type: ignore[no-untyped-def]
        h, R, p, span, blocks, margin, calibrating, account, fall, rightwards, counts
    ):
        sources  # noqa: B018
        return followed(
            h, R, p, span, blocks, margin, calibrating, account, fall, rightwards, counts
        )

    @numba.njit(cache=True, parallel=True, error_model="numpy")
    def batch(h, R, K, steps, accounts, fall, is_limited, rightwards):  # type: ignore[no-untyped-def]
        sources  # noqa: B018
        for scene in numba.prange(h.shape[0]):
            _one_of(h, R, K, steps, accounts, fall, is_limited, rightwards, scene)

    @numba.njit(cache=True, error_model="numpy")
    def bound(h, R, p, fall):  # type: ignore[no-untyped-def]
        sources  # noqa: B018
        return stable_step(h, R, p, fall, True)

    return march, follow, batch, bound
