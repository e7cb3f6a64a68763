"""What lies beyond the ends and sides, renewed as the cells before them change."""

from __future__ import annotations

from bcre_ca.inner import inner
from bcre_ca.plane.kernels.storage import COLUMNS, OPEN, PERIODIC, ROWS
from bcre_ca.plane.kernels.views import copy


@inner
def mirror(f, i, foot_drop):
    """Renew what lies beyond the sides and closed or open ends of row i."""
    row, first, last = i + ROWS, COLUMNS, COLUMNS + f.M - 1
    left, right = (last, first) if f.sides == PERIODIC else (first, last)
    for layer in (f.h, f.R):
        layer[row, first - 1] = layer[row, left]
        layer[row, last + 1] = layer[row, right]
    if f.ends != PERIODIC:
        if i == 0:
            copy(f.h[row], f.h[row - 1])
            copy(f.R[row], f.R[row - 1])
        if i == f.N - 1:
            copy(f.R[row], f.R[row + 1])
            for j in range(first - 1, last + 2):
                f.h[row + 1, j] = f.h[row, j] - foot_drop if f.ends == OPEN else f.h[row, j]


@inner
def join(f):
    """Renew the rows beyond periodic ends."""
    top, foot = ROWS, ROWS + f.N - 1
    copy(f.R[foot], f.R[top - 1])
    copy(f.R[top], f.R[foot + 1])
    for j in range(f.h.shape[1]):
        f.h[top - 1, j] = f.h[foot, j] + f.fall
        f.h[foot + 1, j] = f.h[top, j] - f.fall
