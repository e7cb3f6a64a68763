r"""Across the flow: what spreads sideways, and the curvature there in the exchange.

    R_t += (D_y R_y)_y        E += -X(R) kappa_y u_yy

R_y on a face and u_yy in a cell are central, of order 6. Sides are joined, or closed: mirrors,
through which nothing passes. Both are written in differences, so that a row without structure
adds nothing, to the bit.
"""

from __future__ import annotations

from bcre_pde.exchange import exchanging
from bcre_pde.inner import inner
from bcre_pde.stencils import GHOSTS


@inner
def add_rates(u, R, K, padded, scratch, u_rate, R_rate):
    """Add what happens across to the rates of one row.

    ``padded`` and ``scratch`` are longer than the row by 6 and by 1.
    """
    _spread(R, K.D_y, K.dy, K.joined_sides, padded, scratch, R_rate)
    _bend(u, R, K.kappa_y, K.saturation, K.dy, K.joined_sides, padded, scratch)
    _add(K.kappa_y, -1.0, scratch, u_rate)
    _add(K.kappa_y, 1.0, scratch, R_rate)


@inner
def add_rise_of_foot(foot, R, K, padded, scratch, foot_rate):
    """u on the open foot, which is a boundary value, follows its curvature across too."""
    _bend(foot, R, K.kappa_y, K.saturation, K.dy, K.joined_sides, padded, scratch)
    _add(K.kappa_y, -1.0, scratch, foot_rate)


@inner
def _pad(row, padded, joined):
    m = row.size
    for j in range(m):
        padded[j + GHOSTS] = row[j]
    for ghost in range(GHOSTS):
        padded[ghost] = row[m - GHOSTS + ghost] if joined else row[GHOSTS - 1 - ghost]
        padded[m + GHOSTS + ghost] = row[ghost] if joined else row[m - 1 - ghost]


@inner
def _spread(R, D, dy, joined, padded, flux, R_rate):
    if D == 0.0:
        return
    _pad(R, padded, joined)
    spread = D / (180 * dy)
    R0, R1, R2 = padded[0:], padded[1:], padded[2:]
    R3, R4, R5 = padded[3:], padded[4:], padded[5:]
    for f in range(R.size + 1):
        difference = 245 * (R3[f] - R2[f]) - 25 * (R4[f] - R1[f]) + 2 * (R5[f] - R0[f])
        flux[f] = -spread * difference
    beyond = flux[1:]
    for j in range(R.size):
        R_rate[j] += (flux[j] - beyond[j]) / dy


@inner
def _bend(u, R, kappa, saturation, dy, joined, padded, gained):
    if kappa is None:
        return
    _pad(u, padded, joined)
    curve = kappa / (180 * dy * dy)
    u0, u1, u2, u3 = padded[0:], padded[1:], padded[2:], padded[3:]
    u4, u5, u6 = padded[4:], padded[5:], padded[6:]
    for j in range(R.size):
        near = (u2[j] - u3[j]) + (u4[j] - u3[j])
        further = (u1[j] - u3[j]) + (u5[j] - u3[j])
        furthest = (u0[j] - u3[j]) + (u6[j] - u3[j])
        curvature = curve * (270 * near - 27 * further + 2 * furthest)
        gained[j] = -exchanging(R[j], saturation) * curvature


@inner
def _add(kappa, sign, gained, rate):
    if kappa is None:
        return
    for j in range(rate.size):
        rate[j] += sign * gained[j]
