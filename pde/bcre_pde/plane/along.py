r"""Along the flow: the line's right-hand side for all columns of a row at once.

    F = v R - D_x R_x        E = -X(R) (gamma u_x + kappa_x u_xx)

Values on the faces, the exchange law and what happens at open ends are those of
:mod:`bcre_pde.line.fluxes`, in the same order of operations. Rows wrap; where the ends are open,
those whose stencils would are left to :func:`rates_at_open_ends`.
"""

from __future__ import annotations

import numpy as np

from bcre_pde import stencils
from bcre_pde.exchange import exchange, exchanging
from bcre_pde.inner import inner
from bcre_pde.stencils import face_value


@inner
def faces(u, R, f, K, flux, face):
    """F and u on the faces between rows f - 1 and f, u as seen from downhill."""
    _rolling_fluxes(R, f, K.v, K.D_x, K.dx, flux)
    n = u.shape[0]
    u1, u2, u3 = u[f - 2], u[f - 1], u[f % n]
    u4, u5 = u[(f + 1) % n], u[(f + 2) % n]
    for j in range(face.size):
        face[j] = face_value(u5[j], u4[j], u3[j], u2[j], u1[j])


@inner
def _rolling_fluxes(R, f, v, D, dx, flux):
    n = R.shape[0]
    spread = D / (180 * dx)
    R0, R1, R2, R3 = R[f - 3], R[f - 2], R[f - 1], R[f % n]
    R4, R5 = R[(f + 1) % n], R[(f + 2) % n]
    for j in range(flux.size):
        carried = face_value(R0[j], R1[j], R2[j], R3[j], R4[j])
        difference = 245 * (R3[j] - R2[j]) - 25 * (R4[j] - R1[j]) + 2 * (R5[j] - R0[j])
        flux[j] = v * carried - spread * difference


@inner
def change(layers, i, flux, face, K, bend, rates):
    """Rates of u and R in row i; its upper faces in the rows i % 2 of ``flux`` and ``face``."""
    u, R = layers[0], layers[1]
    above, below = i % 2, (i + 1) % 2
    _bends(u, i, K.kappa_x, bend)
    _change(
        R[i],
        flux[above],
        flux[below],
        face[above],
        face[below],
        bend,
        K.gamma,
        K.kappa_x,
        K.saturation,
        K.dx,
        rates[0, i],
        rates[1, i],
    )


@inner
def _bends(u, i, kappa, bend):
    """180 dx^2 u_xx in row i, where it is needed."""
    if kappa is None:
        return
    n = u.shape[0]
    u0, u1, u2, u3 = u[i - 3], u[i - 2], u[i - 1], u[i]
    u4, u5, u6 = u[(i + 1) % n], u[(i + 2) % n], u[(i + 3) % n]
    for j in range(bend.size):
        outer = 2 * (u0[j] + u6[j]) - 27 * (u1[j] + u5[j])
        bend[j] = outer + 270 * (u2[j] + u4[j]) - 490 * u3[j]


@inner
def _change(R, above, below, u_above, u_below, bend, gamma, kappa, saturation, dx, u_rate, R_rate):
    slope = gamma / dx
    curve = None if kappa is None else kappa / (180 * dx * dx)
    for j in range(R.size):
        gained = exchange(R[j], u_below[j] - u_above[j], bend[j], slope, curve, saturation)
        u_rate[j] = -gained
        R_rate[j] = (above[j] - below[j]) / dx + gained


@inner
def rates_at_open_ends(layers, K, rates):
    """Rates of the three rows next to each open end, of u on the foot and of the outflow."""
    n, columns = layers.shape[1], layers.shape[2]
    flux, inner = np.empty(n + 1), np.empty((2, columns))
    _rolling_fluxes(layers[1], 3, K.v, K.D_x, K.dx, inner[0])
    _rolling_fluxes(layers[1], n - 3, K.v, K.D_x, K.dx, inner[1])
    for j in range(columns):
        u, R, foot = layers[0, :, j], layers[1, :, j], layers[2, 0, j]
        flux[3], flux[n - 3] = inner[0, j], inner[1, j]
        stencils.rolling_flux_at_open_ends(R, flux, K.v, K.D_x, K.dx, n)
        stencils.change_at_open_ends(
            u, R, flux, rates[:, :, j], K.gamma, K.kappa_x, K.dx, n, foot, K.saturation
        )
        rates[2, 0, j] = _rise_of_foot(u, R, foot, K.kappa_x, K.saturation, K.dx, n)
        rates[2, n - 1, j] = flux[n] / (n * K.dx)


@inner
def _rise_of_foot(u, R, foot, kappa, saturation, dx, n):
    if kappa is None:
        return 0.0
    return kappa * exchanging(R[n - 1], saturation) * stencils.curvature_on_foot(u, foot, dx, n)
