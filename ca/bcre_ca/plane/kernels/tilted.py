"""The tilted plane, row by row in place: :mod:`bcre_ca.plane.tilted`, compiled.

A row needs the old rows i and i + 1, which the sweep has not touched yet, and the flux out of row
i - 1, which it carries along.
"""

from __future__ import annotations

from bcre_ca.inner import inner
from bcre_ca.plane.kernels.storage import OPEN, PERIODIC, ROWS
from bcre_ca.plane.kernels.views import at, fill, part
from bcre_ca.plane.law import changed, eroded, gate_between, gated

CARRIED = 1
REACH = 1


@inner
def begin(f, carry, first, lo, hi, K, flow):
    """Carry what flows into row ``first``, before that row or the one above it changes."""
    flux = carry[0]
    if first == 0 and f.ends != PERIODIC:
        fill(flux, lo, hi, K.courant - K.courant)
        return
    row = first + ROWS
    R, R_above = f.R[row], f.R[row - 1]
    free, free_above = part(f.free, row, 0, hi), part(f.free, row - 1, 0, hi)
    for j in range(lo, hi):
        gate = gate_between(at(free_above, j), at(free, j))
        flux[j] = gated(K.outgoing * R_above[j] - K.diffusion * R[j], gate)


@inner
def take(f, carry, i, lo, hi, K, flow):
    """One step of the cells [lo, hi) of row i."""
    row = i + ROWS
    h, h_below = f.h[row, lo:hi], f.h[row + 1, lo:hi]
    R, R_below, flux = f.R[row, lo : hi + 1], f.R[row + 1, lo:hi], carry[0, lo:hi]
    free, free_below = part(f.free, row, lo, hi + 1), part(f.free, row + 1, lo, hi)
    base = part(f.base, row, lo, hi)
    gate = gate_between(at(part(f.free, row, lo - 1, lo), 0), at(free, 0))
    from_left = gated(K.across * (f.R[row, lo - 1] - R[0]), gate)
    if i == f.N - 1 and f.ends != PERIODIC:
        _take_last(h, R, flux, free, base, from_left, K, f.ends == OPEN)
        return
    _cells(h, h_below, R, R_below, flux, free, free_below, base, from_left, K)


@inner
def _cells(h, h_below, R, R_below, flux, free, free_below, base, from_left, K):
    """A function of its own, of rows: inside :func:`take` it would not be vectorised."""
    for j in range(h.size):
        here = R[j]
        gate = gate_between(at(free, j), at(free_below, j))
        out = gated(K.outgoing * here - K.diffusion * R_below[j], gate)
        to_right = gated(K.across * (here - R[j + 1]), gate_between(at(free, j), at(free, j + 1)))
        excess = gated(h[j] - h_below[j], gate) - K.repose_drop
        erosion = eroded(here, excess, h[j], at(base, j), K)
        h[j], R[j] = changed(h[j], here, flux[j] - out, from_left - to_right, erosion, K)
        flux[j] = out
        from_left = to_right


@inner
def _take_last(h, R, flux, free, base, from_left, K, is_open):
    """The row at the foot: its surface goes on at repose, or mirrors itself where it is closed."""
    zero = K.courant - K.courant
    courant, excess = (K.courant, zero) if is_open else (zero, -K.repose_drop)
    for j in range(h.size):
        here = R[j]
        out = courant * here
        to_right = gated(K.across * (here - R[j + 1]), gate_between(at(free, j), at(free, j + 1)))
        erosion = eroded(here, excess, h[j], at(base, j), K)
        h[j], R[j] = changed(h[j], here, flux[j] - out, from_left - to_right, erosion, K)
        flux[j] = out
        from_left = to_right


@inner
def excesses(f, carry, i, lo, hi, K, flow):
    """By how much row i drops beyond repose, into ``carry[0]``."""
    row = i + ROWS
    if i == f.N - 1 and f.ends != PERIODIC:
        fill(carry[0], lo, hi, K.courant - K.courant if f.ends == OPEN else -K.repose_drop)
        return
    h, h_below = f.h[row], f.h[row + 1]
    free, free_below = part(f.free, row, 0, hi), part(f.free, row + 1, 0, hi)
    for j in range(lo, hi):
        gate = gate_between(at(free, j), at(free_below, j))
        carry[0, j] = gated(h[j] - h_below[j], gate) - K.repose_drop
