r"""The compiled right-hand side of BCRE on a line: fifth order, upwind-biased, conservative.

With u = h + Sc x the system is

    u_t = -E        R_t = -F_x + E + w        E = -R (gamma u_x + kappa u_xx)        F = J - D R_x

with J = v R, or v R + Gamma R^2/2 in a thick flow, and w what sources pour.

* R on a face leans uphill, because R is carried downhill; u on a face leans downhill, because the
  surface wave u_t = gamma R u_x climbs. Both are the fifth-order value of
  :func:`bcre_pde.stencils.face_value`, whose limiter leaves smooth profiles alone and keeps steps
  free of overshoot. Where J is not linear its cell values J(R), not J of the face's R, are so
  reconstructed: the latter falls to order 2.
* R_x on a face and u_xx in a cell are central, of order 6.

The same E leaves u and enters R, and F_x is a difference of face values, so dx sum(u + R) changes
by the flux through the ends alone. E itself is the law of :mod:`bcre_pde.exchange`.

Open ends: no flux through the top, and u_xx = 0 there; the advective flux v R through the foot,
beyond which the surface goes on at repose. So u_x = 0 on the foot, where u obeys
du_foot/dt = kappa R u_xx and stays as it is if kappa = 0. The stencils that would reach past an
open end are those of :mod:`bcre_pde.stencils`; the flux through the foot itself is of order 1, as
R_x = 0 there. A wall at the foot is a mirror: no flux, and a surface that is level against it, u_x
= Sc. Periodic ends wrap.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from bcre_pde import stencils
from bcre_pde.exchange import exchange, exchanging
from bcre_pde.inner import inner
from bcre_pde.kept import SOURCES, kept
from bcre_pde.stencils import GHOSTS, face_value
from bcre_pde.sums import weighted_sum


class Coefficients(NamedTuple):
    """What :func:`rate` takes as so many arguments; see there."""

    v: float
    D: float | None
    gamma: float
    kappa: float | None
    dx: float
    periodic: bool
    saturation: float | None
    Gamma: float | None = None
    wall: float | None = None


@inner
def _rate(state, out, padded, faces, K, supply):
    """:func:`rate`, as it is compiled into its callers."""
    cells = state.shape[1]
    _pad(state, padded, K.wall, K.dx, cells)
    u_face, flux = faces[0], faces[1]
    _climbing_face(padded[0], u_face, cells)
    _flux(padded, flux, K.v, K.D, K.Gamma, K.dx, cells)
    if not K.periodic:
        _close(state[1], padded, faces, K.v, K.D, K.Gamma, K.wall, K.dx, cells)
    _change(padded[0], state[1], u_face, flux, out, K.gamma, K.kappa, K.dx, cells, K.saturation)
    if not K.periodic:
        _change_at_open_ends(state, flux, out, K.gamma, K.kappa, K.dx, cells, K.saturation, K.wall)
    if supply is not None:
        for i in range(cells):
            out[1, i] += supply[i]


# By the type of an argument, not of an attribute, the compiler leaves code out.


@inner
def _pad(state, padded, wall, dx, cells):
    """u and R with ghost cells: wrapped, or between a closed top and a wall at the foot."""
    for field in range(2):
        for i in range(cells):
            padded[field, i + 3] = state[field, i]
        for ghost in range(3):
            padded[field, ghost] = state[field, cells - 3 + ghost]
            padded[field, cells + 3 + ghost] = state[field, ghost]
    if wall is not None:
        u, R = padded[0], padded[1]
        for ghost in range(3):
            u[2 - ghost] = u[3] + (ghost + 1) * (u[3] - u[4])
            R[2 - ghost] = R[3 + ghost]
            u[cells + 3 + ghost] = u[cells + 2 - ghost] + (2 * ghost + 1) * wall * dx
            R[cells + 3 + ghost] = R[cells + 2 - ghost]


# Arrays are shifted by slicing, and loops start at 0: only so are they vectorised.


@inner
def _climbing_face(u, face, cells):
    """u on every face, as seen from downhill; u carries three ghost cells."""
    u1, u2, u3, u4, u5 = u[1:], u[2:], u[3:], u[4:], u[5:]
    for f in range(cells + 1):
        face[f] = face_value(u5[f], u4[f], u3[f], u2[f], u1[f])


@inner
def _flux(padded, flux, v, D, Gamma, dx, cells):
    """F on every face; the third row of ``padded`` takes J of a thick layer."""
    if Gamma is None:
        _rolling_flux(padded[1], padded[1], flux, v, D, dx, cells)
    else:
        R, J = padded[1], padded[2]
        for i in range(R.size):
            J[i] = v * R[i] + 0.5 * Gamma * R[i] * R[i]
        _rolling_flux(R, J, flux, 1.0, D, dx, cells)


@inner
def _rolling_flux(R, J, flux, v, D, dx, cells):
    """F = v J - D R_x on every face; R and J, which may be R, carry three ghost cells."""
    spread = None if D is None else D / (180 * dx)
    R0, R1, R2, R3, R4, R5 = R[0:], R[1:], R[2:], R[3:], R[4:], R[5:]
    J0, J1, J2, J3, J4 = J[0:], J[1:], J[2:], J[3:], J[4:]
    for f in range(cells + 1):
        carried = face_value(J0[f], J1[f], J2[f], J3[f], J4[f])
        difference = 245 * (R3[f] - R2[f]) - 25 * (R4[f] - R1[f]) + 2 * (R5[f] - R0[f])
        flux[f] = v * carried if spread is None else v * carried - spread * difference


@inner
def _close(R, padded, faces, v, D, Gamma, wall, dx, cells):
    """F on the faces next to ends that are not joined, into faces[1]."""
    flux = faces[1]
    if wall is not None:
        flux[0] = flux[cells] = 0.0
    else:
        spread = 0.0 if D is None else D
        _flux_at_open_ends(R, padded, flux, faces, v, spread, Gamma, dx, cells)


@inner
def _flux_at_open_ends(R, padded, flux, faces, v, D, Gamma, dx, cells):
    if Gamma is None:
        stencils.rolling_flux_at_open_ends(R, flux, v, D, dx, cells)
    else:
        J, spreading = padded[2, GHOSTS:], faces[2]
        stencils.rolling_flux_at_open_ends(J, flux, 1.0, 0.0, dx, cells)
        stencils.rolling_flux_at_open_ends(R, spreading, 0.0, D, dx, cells)
        for face in (0, 1, 2, cells - 2, cells - 1, cells):
            flux[face] += spreading[face]


@inner
def _change(u, R, u_face, flux, out, gamma, kappa, dx, cells, saturation):
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


@inner
def _change_at_open_ends(state, flux, out, gamma, kappa, dx, cells, saturation, wall):
    """Rates of u and R next to either open end, of u on the foot, and of the outflow."""
    if wall is not None:
        return
    u, R, foot = state[0], state[1], state[2, 0]
    stencils.change_at_open_ends(u, R, flux, out, gamma, kappa, dx, cells, foot, saturation)
    if kappa is not None:
        curvature = stencils.curvature_on_foot(u, foot, dx, cells)
        out[2, 0] = kappa * exchanging(R[cells - 1], saturation) * curvature
    out[2, cells - 1] = flux[cells] / (cells * dx)


def entries(sources: str):
    """The compiled right-hand side, and steps of fixed length taken with it.

    Both close over ``sources``, a part of the key of their machine code: see :mod:`bcre_pde.kept`.
    """

    @kept()
    def rate(
        state,
        out,
        padded,
        faces,
        v,
        D,
        gamma,
        kappa,
        dx,
        periodic,
        saturation,
        Gamma=None,
        wall=None,
        supply=None,
    ):
        """Write the time derivative of ``state`` into ``out``.

        Parameters
        ----------
        state, out: shape (3, N): u; R; and of the third row, used for open ends only, the first
            cell holds u on the foot and the last one the outflow so far divided by N dx.
        padded, faces: scratch of shapes (2, N + 6) and (2, N + 1), of three rows where there is
            Gamma.
        v, D, gamma, kappa: the material, D or kappa None without that term; dx the cell length.
        periodic: whether the ends are joined.
        saturation: gamma/v_up, or None for the linear exchange law.
        Gamma: velocity gradient of a thick layer, or None.
        wall: Sc where a wall closes the foot, None where that is open.
        supply: what sources pour into each cell, length/time, shape (N,), or None.
        """
        sources  # noqa: B018
        K = Coefficients(v, D, gamma, kappa, dx, periodic, saturation, Gamma, wall)
        _rate(state, out, padded, faces, K, supply)

    @kept()
    def march(
        state,
        dt,
        steps,
        increments,
        weights,
        v,
        D,
        gamma,
        kappa,
        dx,
        periodic,
        saturation,
        Gamma=None,
        wall=None,
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
        padded, faces = np.empty((3, cells + 2 * GHOSTS)), np.empty((3, cells + 1))
        K = Coefficients(v, D, gamma, kappa, dx, periodic, saturation, Gamma, wall)
        for _ in range(steps):
            for i in range(stages):
                weighted_sum(state, rates, increments[i], i, dt, stage)
                _rate(stage, rates[i], padded, faces, K, None)
            weighted_sum(state, rates, weights, stages, dt, new)
            state[:, :] = new

    return rate, march


rate, march = entries(SOURCES)
