"""Where the kernels run: on the wet cells only, a block of steps at a time.

Nothing moves outside the window from the first to the last wet cell, and in the synchronous rule
the window grows by one cell a step at either end. A block of steps therefore runs on the window
widened by as many cells, and the window is found anew after it. The window must not cross joined
ends: where it would, and in the in-place readings, the whole pile is stepped.

``march`` and ``march_frozen`` are compiled by :func:`bcre_ca.kept.kept`.
"""

from __future__ import annotations

from bcre_ca.coefficients import coefficients_in, parameters_in
from bcre_ca.inner import inner
from bcre_ca.line.kernels import container, frozen, in_place, second_order, sweep
from bcre_ca.line.kernels.bounds import drop_of, limits_within, stable_step
from bcre_ca.rule import ROUNDING
from bcre_ca.schemes import InContainer, InPlace, Limited, SlopeDriven, by_scheme

BLOCK = 64
"""Steps after which the window is found anew, and whether the step is still a stable one."""

REACH = 2
"""Cells that a step reads beyond a wet one."""


def _upwind_steps(h, R, K, steps, account, period_drop, scheme):
    if period_drop is None:
        sweep.open_ends(h, R, K, steps, account)
    else:
        sweep.periodic(h, R, K, steps, period_drop)


def _limited_steps(h, R, K, steps, account, period_drop, scheme):
    if period_drop is None:
        second_order.open_ends(h, R, K, steps, account)
    else:
        second_order.periodic(h, R, K, steps, period_drop)


def _in_place_steps(h, R, K, steps, account, period_drop, scheme):
    in_place.sweep(h, R, K, steps, account, period_drop)


def _steps_in_container(h, R, K, steps, account, period_drop, scheme):
    container.upwind(h, R, K, steps, account)


def _slope_driven_steps(h, R, K, steps, account, period_drop, scheme):
    container.slope_driven(h, R, K, steps, account)


_take = by_scheme(
    _upwind_steps,
    {
        Limited: _limited_steps,
        InPlace: _in_place_steps,
        InContainer: _steps_in_container,
        SlopeDriven: _slope_driven_steps,
    },
)

WHOLE = (InPlace, InContainer, SlopeDriven)
_steps_whole = by_scheme(lambda scheme: False, dict.fromkeys(WHOLE, lambda scheme: True))


@inner
def wet_cells(R, low, high):
    """First cell of [low, high) with R other than 0, and the cell after the last one."""
    while low < high and R[low] == 0:
        low += 1
    while high > low and R[high - 1] == 0:
        high -= 1
    return low, high


def _wet_or_poured_on(R, low, high, scheme):
    if scheme.supply.any():
        return low, high
    return wet_cells(R, low, high)


moving_cells = by_scheme(
    lambda R, low, high, scheme: wet_cells(R, low, high),
    {InContainer: _wet_or_poured_on, SlopeDriven: _wet_or_poured_on},
)
"""The wet cells of [low, high), and all of them where sources pour."""


@inner
def window(size, low, high, period_drop, scheme):
    """Cells [a, b) that a block can read or change, and whether that is the whole pile."""
    a, b = low - BLOCK - REACH, high + BLOCK + REACH
    if _steps_whole(scheme):
        return 0, size, True
    if period_drop is not None and (a < 0 or b > size):
        return 0, size, True
    return max(a, 0), min(b, size), False


@inner
def take(h, R, K, steps, account, period_drop, a, b, whole):
    """At most a block of steps in the window [a, b); the wet cells afterwards."""
    if period_drop is None:  # one call, so that the kernel is compiled once
        _take(h[a:b], R[a:b], K, steps, account, None, K.scheme)
    elif whole:
        _take(h, R, K, steps, account, period_drop, K.scheme)
    else:
        _take(h[a:b], R[a:b], K, steps, account, None, K.scheme)
    return moving_cells(R, a, b, K.scheme)


@inner
def _outlasts(h, R, K, p, dt, steps, account, period_drop, is_watched):
    """``steps`` steps; where they are watched, up to the first block that outgrows dt.

    Below limits that have been seen to be harmless the bound need not be found again.
    """
    low, high = moving_cells(R, 0, R.size, K.scheme)
    done, seen_largest, seen_sink = 0, -1.0, -1.0
    while done < steps and low < high:
        together = min(BLOCK, steps - done)
        a, b, whole = window(h.size, low, high, period_drop, K.scheme)
        low, high = take(h, R, K, together, account, period_drop, a, b, whole)
        done += together
        if is_watched:
            largest, sink = limits_within(h, R, p, period_drop, a, b, whole)
            if not (largest <= seen_largest and sink <= seen_sink):
                if not dt <= stable_step(p, largest, sink) * (1.0 + ROUNDING):
                    return False
                seen_largest, seen_sink = max(largest, seen_largest), max(sink, seen_sink)
    return True


def march(
    h, R, piles, rows, K, parameters, dts, steps, accounts, period_drops, is_watched, has_outlasted
):
    """``steps`` steps of some of many piles, shape (piles, N), one after the other.

    Each has its own row of coefficients, with the same terms absent as in K, its own row of
    parameters and dt, its own account, and its own period drop, or None in the place of all.
    ``has_outlasted`` takes whether dt has been stable after each block, for each pile.
    """
    for j in range(piles.size):
        own, p = coefficients_in(rows[j], K), parameters_in(parameters[j], K.scheme)
        drop, layers = drop_of(period_drops, j), (h[piles[j]], R[piles[j]])
        has_outlasted[j] = _outlasts(
            layers[0], layers[1], own, p, dts[j], steps, accounts[j], drop, is_watched
        )


def march_frozen(h, R, drop, K, steps, account, period_drop):
    """``steps`` steps on a frozen slope."""
    frozen.march(h, R, drop, K, steps, account, period_drop)
