"""The free surface down its steepest facets: :mod:`bcre_ca.plane.facets`, compiled.

What the cells of a row send is put into three rows of inflow, so that row i can be changed once row
i + 1, looked at with the old rows up to i + 2, has sent its own. Contributions arrive in the order
of the rows and columns that they come from, as the plain step adds them.
"""

from __future__ import annotations

import numpy as np

from bcre_ca.inner import inner
from bcre_ca.plane.facets import FACETS
from bcre_ca.plane.kernels.steepest import steepest_of_cells
from bcre_ca.plane.kernels.storage import COLUMNS, PERIODIC, ROWS
from bcre_ca.plane.kernels.views import at, copy, fill, part
from bcre_ca.plane.law import changed, eroded, gate_between, gated

INFLOW, OUTFLOW, STEEPNESS = 1, 4, 6
ALONG, DIAGONAL, FACET = 8, 9, 10
OF_FIRST = 11
CARRIED = 14
REACH = 2

AXIS_I, AXIS_J = np.array([axis for axis, _ in FACETS]).T.copy()
CORNER_I, CORNER_J = np.array([corner for _, corner in FACETS]).T.copy()


@inner
def begin(f, carry, first, lo, hi, K, flow):
    """Carry what flows into row ``first``, before any row near it changes."""
    zero = K.courant - K.courant
    for k in range(3):
        fill(carry[INFLOW + k], 0, carry.shape[1], zero)
    fill(carry[0], lo, hi, zero)
    is_joined = first == 0 and f.ends == PERIODIC
    if first > 0 or is_joined:
        above = f.N - 1 if is_joined else first - 1
        _look(f, carry, above, first - 1, lo, hi, K, flow)
        _send(f, carry, ALONG, first - 1, lo, hi)
        R, R_above = f.R[first + ROWS], f.R[first + ROWS - 1]
        free = part(f.free, first + ROWS, 0, hi)
        free_above = part(f.free, first + ROWS - 1, 0, hi)
        for j in range(lo, hi):
            gate = gate_between(at(free_above, j), at(free, j))
            carry[0, j] = gated(K.diffusion * (R_above[j] - R[j]), gate)
    _look(f, carry, first, first, lo, hi, K, flow)
    if is_joined:
        for k in range(3):
            copy(carry[ALONG + k], carry[OF_FIRST + k])
    _send(f, carry, ALONG, first, lo, hi)


@inner
def take(f, carry, i, lo, hi, K, flow):
    """One step of the cells [lo, hi) of row i."""
    row = i + ROWS
    if i + 1 < f.N:
        _look(f, carry, i + 1, i + 1, lo, hi, K, flow)
        _send(f, carry, ALONG, i + 1, lo, hi)
    elif f.ends == PERIODIC:
        _send(f, carry, OF_FIRST, i + 1, lo, hi)
    h, flux = f.h[row, lo:hi], carry[0, lo:hi]
    R, R_below = f.R[row, lo : hi + 1], f.R[row + 1, lo:hi]
    inflow, outflow = carry[INFLOW + i % 3, lo:hi], carry[OUTFLOW + i % 2, lo:hi]
    steepness = carry[STEEPNESS + i % 2, lo:hi]
    free, free_below = part(f.free, row, lo, hi + 1), part(f.free, row + 1, lo, hi)
    base = part(f.base, row, lo, hi)
    gate = gate_between(at(part(f.free, row, lo - 1, lo), 0), at(free, 0))
    from_left = gated(K.across * (f.R[row, lo - 1] - R[0]), gate)
    rows = (h, R, R_below, flux, inflow, outflow, steepness, free, free_below, base)
    _cells(*rows, from_left, K)
    if i == f.N - 1 and f.ends != PERIODIC:
        copy(carry[INFLOW + (i + 1) % 3], carry[0])


@inner
def _cells(h, R, R_below, flux, inflow, outflow, steepness, free, free_below, base, from_left, K):
    """A function of its own, of rows: inside :func:`take` it would not be vectorised."""
    for j in range(h.size):
        here = R[j]
        gate = gate_between(at(free, j), at(free_below, j))
        out = gated(K.diffusion * (here - R_below[j]), gate)
        gate = gate_between(at(free, j), at(free, j + 1))
        to_right = gated(K.across * (here - R[j + 1]), gate)
        erosion = eroded(here, steepness[j] - K.repose_drop, h[j], at(base, j), K)
        diffused = (flux[j] - out) + (from_left - to_right)
        h[j], R[j] = changed(h[j], here, inflow[j] - outflow[j], diffused, erosion, K)
        flux[j] = out
        from_left = to_right


@inner
def excesses(f, carry, i, lo, hi, K, flow):
    """By how much row i drops beyond repose, into ``carry[0]``."""
    _look(f, carry, i, 0, lo, hi, K, flow)
    for j in range(lo, hi):
        carry[0, j] = carry[STEEPNESS, j] - K.repose_drop


@inner
def _look(f, carry, i, place, lo, hi, K, flow):
    """The steepest facets of row i, and what its cells send along and diagonally."""
    row = i + ROWS
    lower, upper = lo - 1, hi + 1
    rows = (
        f.h[row - 1, lower:upper],
        f.h[row, lower:upper],
        f.h[row + 1, lower:upper],
        part(f.free, row - 1, lower, upper),
        part(f.free, row, lower, upper),
        part(f.free, row + 1, lower, upper),
    )
    R, squared, sent = (
        f.R[row, lo:hi],
        carry[STEEPNESS + place % 2, lo:hi],
        carry[OUTFLOW + place % 2, lo:hi],
    )
    a, b, facet = carry[ALONG, lo:hi], carry[DIAGONAL, lo:hi], carry[FACET, lo:hi]
    steepest_of_cells(*rows, squared, a, b, facet, K.half, flow.straight)
    _sent_by_cells(R, squared, a, b, sent, K)
    if f.sides == PERIODIC:
        first, last = COLUMNS, COLUMNS + f.M - 1
        if lo == first and hi == last + 1:
            for k in (ALONG, DIAGONAL, FACET):
                carry[k, first - 1] = carry[k, last]
                carry[k, last + 1] = carry[k, first]


@inner
def _sent_by_cells(R, squared, a, b, sent, K):
    """From the drops a and b: what is sent along and diagonally, and both; and the steepness."""
    zero = K.courant - K.courant
    for j in range(R.size):
        steepness = np.sqrt(squared[j])
        squared[j] = steepness
        speed = K.courant * R[j] / steepness if steepness > K.least_drop else zero
        along, diagonal = speed * (a[j] - b[j]), speed * b[j]
        a[j], b[j] = along, diagonal
        sent[j] = along + diagonal


@inner
def _send(f, carry, sent, i, lo, hi):
    """Put what the cells of row i send into the rows about it; the one below is begun with it."""
    fill(carry[INFLOW + (i + 1) % 3], 0, carry.shape[1], 0)
    rows = INFLOW + (i - 1) % 3, INFLOW + i % 3, INFLOW + (i + 1) % 3
    wide = 1 if f.sides == PERIODIC and hi - lo == f.M else 0
    for j in range(lo - wide, hi + wide):
        along, diagonal = carry[sent, j], carry[sent + 1, j]
        if along != 0 or diagonal != 0:
            facet = int(carry[sent + 2, j])
            carry[rows[1 + AXIS_I[facet]], j + AXIS_J[facet]] += along
            carry[rows[1 + CORNER_I[facet]], j + CORNER_J[facet]] += diagonal
