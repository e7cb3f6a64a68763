"""The largest stable step for layers as they are."""

from __future__ import annotations

import math

import numpy as np

from bcre_ca.coefficients import parameters_in
from bcre_ca.inner import inner
from bcre_ca.line.kernels import container
from bcre_ca.rule import ROUNDING
from bcre_ca.schemes import InContainer, SlopeDriven, by_scheme
from bcre_ca.stability import largest_step

INFINITE = np.float64(np.inf).view(np.int64)


@inner
def _bits(number):
    """Numbers >= 0 are ordered as the integers with the same bits, and a largest integer is found
    several at a time, which a largest float is not."""
    return np.float64(number).view(np.int64)


@inner
def _number(bits):
    return np.int64(bits).view(np.float64)


@inner
def _extremes(h, R, repose_drop):
    """Largest R and largest shortfall of a drop, both >= 0; NaN where a layer is not finite, or R
    is negative, which no stable step makes it.

    One loop and no function of its own for a cell: else the compiler would not vectorise it.
    """
    last = h.size - 1
    largest, shortfall = _bits(max(R[last], 0.0)), np.int64(0)
    furthest, signs = _bits(abs(h[last] + R[last])), _bits(R[last])
    for i in range(last):
        signs = min(signs, np.float64(R[i]).view(np.int64))
        largest = max(largest, np.float64(max(R[i], 0.0)).view(np.int64))
        missing = max(repose_drop - (h[i] - h[i + 1]), 0.0)
        shortfall = max(shortfall, np.float64(missing).view(np.int64))
        furthest = max(furthest, np.float64(abs(h[i] + R[i])).view(np.int64))
    if furthest >= INFINITE:
        return math.nan, math.nan
    if signs < 0 and np.min(R) < -ROUNDING * _number(largest):
        return math.nan, math.nan
    return _number(largest), _number(shortfall)


@inner
def _largest_bend(h, kappa):
    """Largest h(i-1) - 2 h(i) + h(i+1), or 0; looked for only where it counts."""
    if kappa == 0:
        return 0.0
    largest = np.int64(0)
    for i in range(h.size - 2):
        bend = max((h[i] - h[i + 1]) - (h[i + 1] - h[i + 2]), 0.0)
        largest = max(largest, np.float64(bend).view(np.int64))
    return _number(largest)


@inner
def limits(h, R, p, period_drop, foot):
    """Largest layer and fastest loss per unit of layer, as :func:`largest_step` takes them.

    NaN where the layers are not finite or R is negative. p holds every term. ``foot`` says whether
    the last cell is that at the open foot, beyond which the surface goes on at repose, rather than
    one inside the pile.
    """
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
    return largest, sink


def _limits_within(h, R, p, period_drop, a, b, whole, scheme):
    if period_drop is None:
        return limits(h[a:b], R[a:b], p, None, b == h.size)
    if whole:
        return limits(h, R, p, period_drop, True)
    return limits(h[a:b], R[a:b], p, None, False)


def _limits_in_container(h, R, p, period_drop, a, b, whole, scheme):
    largest, sink = limits(h, R, p, period_drop, True)
    return largest, max(sink, container.sink_at_wall(h, p))


def _limits_slope_driven(h, R, p, period_drop, a, b, whole, scheme):
    largest, _ = limits(h, R, p, None, True)
    return largest, container.sink_on_slopes(h, p)


_limits = by_scheme(
    _limits_within, {InContainer: _limits_in_container, SlopeDriven: _limits_slope_driven}
)


@inner
def limits_within(h, R, p, period_drop, a, b, whole):
    """The same for the cells [a, b) of a pile, or the whole of it."""
    return _limits(h, R, p, period_drop, a, b, whole, p.scheme)


@inner
def stable_step(p, largest, sink):
    """The largest stable step under such limits; NaN where they are."""
    if math.isnan(largest):
        return math.nan
    return largest_step(p, largest, sink)


def stable_steps(h, R, piles, rows, scheme, largest, period_drops):
    """Fill in the largest stable steps of some of many piles, by their rows of parameters.

    Compiled by :func:`bcre_ca.kept.kept`.
    """
    for j in range(piles.size):
        p = parameters_in(rows[j], scheme)
        own = h[piles[j]], R[piles[j]]
        drop = drop_of(period_drops, j)
        layer, sink = limits_within(own[0], own[1], p, drop, 0, h.shape[1], True)
        largest[j] = stable_step(p, layer, sink)


@inner
def drop_of(period_drops, j):
    """One of the falls of the repose line over a period; None for open ends."""
    if period_drops is None:
        return None
    return period_drops[j]
