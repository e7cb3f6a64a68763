"""What the bounds of the step need to know of the layers, where it is wet."""

from __future__ import annotations

import math

import numpy as np

from bcre_ca.inner import inner, inner_reassociated
from bcre_ca.plane.coefficients import Facets, Split4, Tilted, by_flow
from bcre_ca.plane.kernels import facets, split4, tilted
from bcre_ca.plane.kernels.storage import COLUMNS, ROWS
from bcre_ca.plane.kernels.views import at, part
from bcre_ca.plane.kernels.windows import widen
from bcre_ca.plane.law import gated

_excesses_of = by_flow({Tilted: tilted.excesses, Split4: split4.excesses, Facets: facets.excesses})


def extremes(f, K, cells, steps, w):
    """Largest R, and largest drop that is missing to repose, of all that the next ``steps`` can
    read; both >= 0, and NaN where a layer is not finite. Compiled by
    :func:`bcre_ca.kept.kept`."""
    windows, carry = w.windows, w.carry[0, 0]
    top, foot = widen(f, w.wet, cells, True, steps, windows)
    largest, missing, unfinished = 0.0, 0.0, 0.0
    for i in range(top, foot):
        lo, hi = windows[0, i] + COLUMNS, windows[1, i] + COLUMNS
        if lo < hi:
            _excesses_of(f, carry, i, lo, hi, K, K.flow)
            free = part(f.free, i + ROWS, lo, hi)
            R, h = f.R[i + ROWS, lo:hi], f.h[i + ROWS, lo:hi]
            largest = max(largest, _largest(R))
            missing = max(missing, _largest_missing(carry[0, lo:hi], free))
            unfinished += _unfinished(h, R)
    if unfinished != 0:
        return math.nan, math.nan
    return largest, missing


@inner
def _float_of(bits):
    return np.int64(bits).view(np.float64)


@inner
def _largest(R):
    """Numbers >= 0 are ordered as the integers with the same bits, and a largest integer is found
    several at a time, which a largest float is not."""
    largest = np.int64(0)
    for j in range(R.size):
        largest = max(largest, np.float64(max(np.float64(R[j]), 0.0)).view(np.int64))
    return _float_of(largest)


@inner
def _largest_missing(excess, free):
    largest = np.int64(0)
    for j in range(excess.size):
        missing = max(np.float64(gated(-excess[j], at(free, j))), 0.0)
        largest = max(largest, np.float64(missing).view(np.int64))
    return _float_of(largest)


@inner_reassociated
def _unfinished(h, R):
    total = 0.0
    for j in range(h.size):
        total += h[j] * 0.0 + R[j] * 0.0
    return 0.0 if total == 0 else 1.0
