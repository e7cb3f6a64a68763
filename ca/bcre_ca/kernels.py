"""The compiled sweeps: many steps a call, in place, equal to :mod:`bcre_ca.step` to the bit.

In place works for the synchronous rule too: cell i needs the old cells i and i+1, which a sweep
downhill has not touched yet, and the flux out of cell i-1, which is carried along. Expressions are
those of ``step.py``, in the same order, without fused or reassociated arithmetic. The fluxes
through the ends are taken before the loop, and neighbours are read as ``h[i + 1]`` rather than
through a shifted view, since the compiler would otherwise not vectorise the loop.

Every kernel takes h and R of shape (N,), changes both, and returns what left through the foot.
"""

from __future__ import annotations

from collections.abc import Callable

import numba
import numpy as np
from numpy.typing import NDArray

from bcre_ca.rule import Ends, Rule
from bcre_ca.step import period_drop

Array = NDArray[np.float64]


def march(h: Array, R: Array, rule: Rule, steps: int, ends: Ends) -> float:
    """Take ``steps`` steps in place; return what left through the foot (times d: an area)."""
    c, b, q, k, s = rule.coefficients()
    drop = period_drop(rule, h.size)
    kernel: Callable[..., float]
    if rule.order == "synchronous":
        kernel = _synchronous_periodic if ends == "periodic" else _synchronous_open
    else:
        kernel = _right if rule.order == "right" else _left
    return float(kernel(h, R, c, b, q, k, s, drop, steps, ends == "periodic"))


@numba.njit(cache=True)
def _synchronous_open(h, R, c, b, q, k, s, drop, steps, periodic):  # type: ignore[no-untyped-def]
    last = h.size - 1
    outflow = 0.0
    lost = 0.0
    for _ in range(steps):
        foot = c * R[last]
        into_last = q * R[last - 1] - b * R[last] if last > 0 else 0.0
        flux_in = 0.0
        for i in range(last):
            R_i = R[i]
            flux_out = q * R_i - b * R[i + 1]
            exchange = R_i * (k * ((h[i] - h[i + 1]) - s))
            h[i] = h[i] - exchange
            R[i] = R_i + ((flux_in - flux_out) + exchange)
            flux_in = flux_out
        R[last] = R[last] + (into_last - foot)
        # Compensated, so that the balance of mass holds to rounding after any number of steps.
        term = foot - lost
        total = outflow + term
        lost = (total - outflow) - term
        outflow = total
    return outflow


@numba.njit(cache=True)
def _synchronous_periodic(h, R, c, b, q, k, s, drop, steps, periodic):  # type: ignore[no-untyped-def]
    last = h.size - 1
    for _ in range(steps):
        R_first, R_last, h_last = R[0], R[last], h[last]
        into_first = q * R_last - b * R_first
        into_last = q * R[last - 1] - b * R_last if last > 0 else into_first
        exchange_last = R_last * (k * ((h_last - (h[0] - drop)) - s))
        flux_in = into_first
        for i in range(last):
            R_i = R[i]
            flux_out = q * R_i - b * R[i + 1]
            exchange = R_i * (k * ((h[i] - h[i + 1]) - s))
            h[i] = h[i] - exchange
            R[i] = R_i + ((flux_in - flux_out) + exchange)
            flux_in = flux_out
        h[last] = h_last - exchange_last
        R[last] = R_last + ((into_last - into_first) + exchange_last)
    return 0.0


@numba.njit(cache=True)
def _visit(h, R, i, c, b, q, k, s, drop, periodic):  # type: ignore[no-untyped-def]
    """Update cell i in place from what is found; return what leaves through the foot."""
    last = h.size - 1
    outflow = 0.0
    if i < last:
        flux = q * R[i] - b * R[i + 1]
        exchange = R[i] * (k * ((h[i] - h[i + 1]) - s))
        R[i + 1] += flux
    elif periodic:
        flux = q * R[i] - b * R[0]
        exchange = R[i] * (k * ((h[i] - (h[0] - drop)) - s))
        R[0] += flux
    else:
        flux = c * R[i]
        exchange = 0.0
        outflow = flux
    R[i] += exchange - flux
    h[i] -= exchange
    return outflow


@numba.njit(cache=True)
def _right(h, R, c, b, q, k, s, drop, steps, periodic):  # type: ignore[no-untyped-def]
    outflow = 0.0
    for _ in range(steps):
        for i in range(h.size):
            outflow += _visit(h, R, i, c, b, q, k, s, drop, periodic)
    return outflow


@numba.njit(cache=True)
def _left(h, R, c, b, q, k, s, drop, steps, periodic):  # type: ignore[no-untyped-def]
    outflow = 0.0
    for _ in range(steps):
        for i in range(h.size - 1, -1, -1):
            outflow += _visit(h, R, i, c, b, q, k, s, drop, periodic)
    return outflow
