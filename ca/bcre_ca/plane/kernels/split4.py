"""The free surface shared out among four neighbours: :mod:`bcre_ca.plane.split4`, compiled.

Sand leaves a cell at ``speed`` = v dt/d R/S, so that it is enough to know that of row i and of the
row below, taken from old rows up to i + 2, and the flux out of row i - 1, which is carried along.
Rows of speeds alternate between two places each, since row i's are needed until row i is done.
"""

from __future__ import annotations

import numpy as np

from bcre_ca.inner import inner
from bcre_ca.plane.kernels.storage import COLUMNS, PERIODIC, ROWS
from bcre_ca.plane.kernels.views import at, copy, fill, part
from bcre_ca.plane.law import changed, eroded, gate_between, gated, larger

SPEED, STEEPNESS, SPEED_OF_FIRST = 1, 3, 5
CARRIED = 6
REACH = 2


@inner
def begin(f, carry, first, lo, hi, K, flow):
    """Carry what flows into row ``first`` and its speed, before any row near it changes."""
    flux = carry[0]
    _steepness(f, carry, first, lo, hi, K)
    if first == 0 and f.ends != PERIODIC:
        fill(flux, lo, hi, K.courant - K.courant)
        return
    above = first - 1 if first > 0 else f.N - 1
    speed = carry[SPEED + first % 2]
    if first == 0:
        copy(speed, carry[SPEED_OF_FIRST])
    other = carry[SPEED + (first + 1) % 2]
    _steepness_into(f, other, carry[STEEPNESS + (first + 1) % 2], above, lo, hi, K)
    row = above + ROWS
    h, h_below, R, R_below = f.h[row], f.h[row + 1], f.R[row], f.R[row + 1]
    free, free_below = part(f.free, row, 0, hi), part(f.free, row + 1, 0, hi)
    for j in range(lo, hi):
        gate = gate_between(at(free, j), at(free_below, j))
        drop = gated(h[j] - h_below[j], gate)
        diffusive = gated(K.diffusion * (R[j] - R_below[j]), gate)
        flux[j] = drop * (other[j] if drop > 0 else speed[j]) + diffusive


@inner
def take(f, carry, i, lo, hi, K, flow):
    """One step of the cells [lo, hi) of row i."""
    row = i + ROWS
    if i + 1 < f.N:
        _steepness(f, carry, i + 1, lo, hi, K)
    elif f.ends == PERIODIC:
        copy(carry[SPEED_OF_FIRST], carry[SPEED + (i + 1) % 2])
    else:
        fill(carry[SPEED + (i + 1) % 2], lo, hi, K.courant - K.courant)
    h, h_below = f.h[row, lo : hi + 1], f.h[row + 1, lo:hi]
    R, R_below, flux = f.R[row, lo : hi + 1], f.R[row + 1, lo:hi], carry[0, lo:hi]
    speed, speed_below = carry[SPEED + i % 2, lo : hi + 1], carry[SPEED + (i + 1) % 2, lo:hi]
    steepness = carry[STEEPNESS + i % 2, lo:hi]
    free, free_below = part(f.free, row, lo, hi + 1), part(f.free, row + 1, lo, hi)
    base = part(f.base, row, lo, hi)
    gate = gate_between(at(part(f.free, row, lo - 1, lo), 0), at(free, 0))
    drop = gated(f.h[row, lo - 1] - h[0], gate)
    speed_left = carry[SPEED + i % 2, lo - 1]
    from_left = drop * (speed_left if drop > 0 else speed[0]) + gated(
        K.across * (f.R[row, lo - 1] - R[0]), gate
    )
    rows = (h, h_below, R, R_below, flux, speed, speed_below, steepness, free, free_below, base)
    _cells(*rows, from_left, K)


@inner
def _cells(
    h,
    h_below,
    R,
    R_below,
    flux,
    speed,
    speed_below,
    steepness,
    free,
    free_below,
    base,
    from_left,
    K,
):
    """A function of its own, of rows: inside :func:`take` it would not be vectorised."""
    for j in range(flux.size):
        here, h_here, sent = R[j], h[j], speed[j]
        gate = gate_between(at(free, j), at(free_below, j))
        drop, other = gated(h_here - h_below[j], gate), speed_below[j]
        out = drop * (sent if drop > 0 else other) + gated(K.diffusion * (here - R_below[j]), gate)
        gate = gate_between(at(free, j), at(free, j + 1))
        drop, other = gated(h_here - h[j + 1], gate), speed[j + 1]
        to_right = drop * (sent if drop > 0 else other) + gated(K.across * (here - R[j + 1]), gate)
        erosion = eroded(here, steepness[j] - K.repose_drop, h_here, at(base, j), K)
        h[j], R[j] = changed(h_here, here, flux[j] - out, from_left - to_right, erosion, K)
        flux[j] = out
        from_left = to_right


@inner
def excesses(f, carry, i, lo, hi, K, flow):
    """By how much row i drops beyond repose, into ``carry[0]``."""
    _steepness_into(f, carry[1], carry[0], i, lo, hi, K)
    for j in range(lo, hi):
        carry[0, j] -= K.repose_drop


@inner
def _steepness(f, carry, i, lo, hi, K):
    """Steepness and speed of row i, and the speed beyond closed or joined sides."""
    speed = carry[SPEED + i % 2]
    _steepness_into(f, speed, carry[STEEPNESS + i % 2], i, lo, hi, K)
    if f.sides == PERIODIC:
        first, last = COLUMNS, COLUMNS + f.M - 1
        if lo == first and hi == last + 1:
            speed[first - 1] = speed[last]
            speed[last + 1] = speed[first]


@inner
def _steepness_into(f, to_speed, to_steepness, i, lo, hi, K):
    row = i + ROWS
    h, R = f.h[row, lo - 1 : hi + 1], f.R[row, lo:hi]
    above, below = f.h[row - 1, lo:hi], f.h[row + 1, lo:hi]
    free = part(f.free, row, lo - 1, hi + 1)
    free_above, free_below = part(f.free, row - 1, lo, hi), part(f.free, row + 1, lo, hi)
    speed, steepness = to_speed[lo:hi], to_steepness[lo:hi]
    _steepness_of_cells(h, above, below, free, free_above, free_below, R, speed, steepness, K)


@inner
def _steepness_of_cells(h, above, below, free, free_above, free_below, R, speed, steepness, K):
    zero = K.courant - K.courant
    for j in range(R.size):
        here, is_free = h[j + 1], at(free, j + 1)
        up = larger(gated(here - above[j], gate_between(is_free, at(free_above, j))), zero)
        down = larger(gated(here - below[j], gate_between(is_free, at(free_below, j))), zero)
        left = larger(gated(here - h[j], gate_between(is_free, at(free, j))), zero)
        right = larger(gated(here - h[j + 2], gate_between(is_free, at(free, j + 2))), zero)
        root = np.sqrt((up * up + down * down) + (left * left + right * right))
        steepness[j] = root
        speed[j] = K.courant * R[j] / root if root > K.least_drop else zero
