r"""The compiled right-hand side of BCRE on a line: fifth order, upwind-biased, conservative.

With u = h + Sc x the system is

    u_t = -E        R_t = -F_x + E        E = -R (gamma u_x + kappa u_xx)        F = v R - D R_x

* R on a face leans uphill, because R is carried downhill; u on a face leans downhill, because the
  surface wave u_t = gamma R u_x climbs. Both are the fifth-order value of
  :func:`bcre_pde.stencils.face_value`, whose limiter leaves smooth profiles alone and keeps steps
  free of overshoot.
* R_x on a face and u_xx in a cell are central, of order 6.

The same E leaves u and enters R, and F_x is a difference of face values, so dx sum(u + R) changes
by the flux through the ends alone. E itself is the law of :mod:`bcre_pde.exchange`.

Open ends: no flux through the top, and u_xx = 0 there; the advective flux v R through the foot,
beyond which the surface goes on at repose. So u_x = 0 on the foot, where u obeys
du_foot/dt = kappa R u_xx and stays as it is if kappa = 0. The stencils that would reach past an
open end are those of :mod:`bcre_pde.stencils`; the flux through the foot itself is of order 1, as
R_x = 0 there. Periodic ends wrap.
"""

from __future__ import annotations

import numba
import numpy as np

from bcre_pde import stencils
from bcre_pde.exchange import exchange, exchanging
from bcre_pde.kept import SOURCES
from bcre_pde.stencils import GHOSTS, face_value
from bcre_pde.sums import weighted_sum

_compiled = numba.njit(error_model="numpy")


@_compiled
def _rate(  # type: ignore[no-untyped-def]
    state, out, padded, faces, v, D, gamma, kappa, dx, periodic, saturation
):
    """:func:`rate`, as it is compiled into its callers."""
    cells = state.shape[1]
    _pad(state, padded, cells)
    u_face, flux = faces[0], faces[1]
    _climbing_face(padded[0], u_face, cells)
    _rolling_flux(padded[1], flux, v, D, dx, cells)
    if not periodic:
        spread = 0.0 if D is None else D
        stencils.rolling_flux_at_open_ends(state[1], flux, v, spread, dx, cells)
    _change(padded[0], state[1], u_face, flux, out, gamma, kappa, dx, cells, saturation)
    if not periodic:
        u, R, foot = state[0], state[1], state[2, 0]
        stencils.change_at_open_ends(u, R, flux, out, gamma, kappa, dx, cells, foot, saturation)
        if kappa is not None:
            curvature = stencils.curvature_on_foot(u, foot, dx, cells)
            out[2, 0] = kappa * exchanging(R[cells - 1], saturation) * curvature
        out[2, cells - 1] = flux[cells] / (cells * dx)


@_compiled
def _pad(state, padded, cells):  # type: ignore[no-untyped-def]
    """u and R with ghost cells that wrap."""
    for field in range(2):
        for i in range(cells):
            padded[field, i + 3] = state[field, i]
        for ghost in range(3):
            padded[field, ghost] = state[field, cells - 3 + ghost]
            padded[field, cells + 3 + ghost] = state[field, ghost]


# Arrays are shifted by slicing, and loops start at 0: only so are they vectorised.


@_compiled
def _climbing_face(u, face, cells):  # type: ignore[no-untyped-def]
    """u on every face, as seen from downhill; u carries three ghost cells."""
    u1, u2, u3, u4, u5 = u[1:], u[2:], u[3:], u[4:], u[5:]
    for f in range(cells + 1):
        face[f] = face_value(u5[f], u4[f], u3[f], u2[f], u1[f])


@_compiled
def _rolling_flux(R, flux, v, D, dx, cells):  # type: ignore[no-untyped-def]
    """F on every face; R carries three ghost cells."""
    spread = None if D is None else D / (180 * dx)
    R0, R1, R2, R3, R4, R5 = R[0:], R[1:], R[2:], R[3:], R[4:], R[5:]
    for f in range(cells + 1):
        carried = face_value(R0[f], R1[f], R2[f], R3[f], R4[f])
        difference = 245 * (R3[f] - R2[f]) - 25 * (R4[f] - R1[f]) + 2 * (R5[f] - R0[f])
        flux[f] = v * carried if spread is None else v * carried - spread * difference


@_compiled
def _change(  # type: ignore[no-untyped-def]
    u, R, u_face, flux, out, gamma, kappa, dx, cells, saturation
):
    """Rates of u and R in every cell; u carries three ghost cells."""
    u0, u1, u2, u3, u4, u5, u6 = u[0:], u[1:], u[2:], u[3:], u[4:], u[5:], u[6:]
    u_face_out, flux_out = u_face[1:], flux[1:]
    u_rate, R_rate, ends_rate = out[0], out[1], out[2]
    per_gradient = gamma / dx
    per_curvature = None if kappa is None else kappa / (180 * dx * dx)
    for i in range(cells):
        gradient = u_face_out[i] - u_face[i]
        curvature = 2 * (u0[i] + u6[i]) - 27 * (u1[i] + u5[i]) + 270 * (u2[i] + u4[i]) - 490 * u3[i]
        gained = exchange(R[i], gradient, curvature, per_gradient, per_curvature, saturation)
        u_rate[i] = -gained
        R_rate[i] = (flux[i] - flux_out[i]) / dx + gained
        ends_rate[i] = 0.0


def entries(sources: str):  # type: ignore[no-untyped-def]
    """The compiled right-hand side, and steps of fixed length taken with it.

    Both close over ``sources``, a part of the key of their machine code: see :mod:`bcre_pde.kept`.
    """

    @numba.njit(cache=True, error_model="numpy")
    def rate(  # type: ignore[no-untyped-def]
        state, out, padded, faces, v, D, gamma, kappa, dx, periodic, saturation
    ):
        """Write the time derivative of ``state`` into ``out``.

        Parameters
        ----------
        state, out: shape (3, N): u; R; and of the third row, used for open ends only, the first
            cell holds u on the foot and the last one the outflow so far divided by N dx.
        padded, faces: scratch of shapes (2, N + 6) and (2, N + 1).
        v, D, gamma, kappa: the material, D or kappa None without that term; dx the cell length.
        periodic: whether the ends are joined.
        saturation: gamma/v_up, or None for the linear exchange law.
        """
        sources  # noqa: B018
        _rate(state, out, padded, faces, v, D, gamma, kappa, dx, periodic, saturation)

    @numba.njit(cache=True, error_model="numpy")
    def march(  # type: ignore[no-untyped-def]
        state, dt, steps, increments, weights, v, D, gamma, kappa, dx, periodic, saturation
    ):
        """Take ``steps`` explicit Runge-Kutta steps of length ``dt`` in place.

        Parameters
        ----------
        increments, weights: a (s, s) and b (s,) of :class:`bcre_pde.explicit.Tableau`.
        state and the others: as for ``rate``.
        """
        sources  # noqa: B018
        stages, cells = weights.size, state.shape[1]
        rates = np.empty((stages, 3, cells))
        stage, new = np.empty((3, cells)), np.empty((3, cells))
        padded, faces = np.empty((2, cells + 2 * GHOSTS)), np.empty((2, cells + 1))
        for _ in range(steps):
            for i in range(stages):
                weighted_sum(state, rates, increments[i], i, dt, stage)
                _rate(stage, rates[i], padded, faces, v, D, gamma, kappa, dx, periodic, saturation)
            weighted_sum(state, rates, weights, stages, dt, new)
            state[:, :] = new

    return rate, march


rate, march = entries(SOURCES)
