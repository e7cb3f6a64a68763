r"""The compiled right-hand side of BCRE: fifth order, upwind-biased, monotone, conservative.

With u = h + Sc x the system is

    u_t = -E        R_t = -F_x + E        E = -R (gamma u_x + kappa u_xx)        F = v R - D R_x

* R at a face leans uphill, because R is carried downhill; u at a face leans downhill, because the
  surface wave u_t = gamma R u_x climbs. Both are the fifth-order value of :func:`_face_value`,
  whose limiter leaves smooth profiles alone and keeps steps free of overshoot.
* R_x at a face and u_xx in a cell are central, order 6.

The same E leaves u and enters R, and F_x is a difference of face values, so dx sum(u + R) changes
by the flux through the ends alone. E itself is the law of :mod:`bcre_pde.exchange`.

Open ends: no flux through the top, and u_xx = 0 there; the advective flux v R through the foot,
beyond which the surface goes on at repose: u_x = 0 on the foot, so that u there obeys
du_foot/dt = kappa R u_xx and stays where it is if kappa = 0. The stencils that would reach past an
open end are replaced by those of order 2 and 3 that the domain offers (the flux through the foot
itself by order 1, as R_x = 0 there). Periodic ends wrap.
"""

from __future__ import annotations

import hashlib
from pathlib import Path

import numba

from bcre_pde.exchange import exchange, exchanging

GHOSTS = 3
SMALLEST_GRID = 8

_compiled = numba.njit(error_model="numpy")


@_compiled
def _rate(  # type: ignore[no-untyped-def]
    state, out, padded, faces, v, D, gamma, kappa, dx, periodic, saturation
):
    """:func:`rate`, as it is compiled into its callers."""
    n = state.shape[1]
    _pad(state, padded, n)
    u_face, flux = faces[0], faces[1]
    _climbing_face(padded[0], u_face, n)
    _rolling_flux(padded[1], flux, v, D, dx, n)
    if not periodic:
        _rolling_flux_at_open_ends(state[1], flux, v, 0.0 if D is None else D, dx, n)
    _change(padded[0], state[1], u_face, flux, out, gamma, kappa, dx, n, saturation)
    if not periodic:
        foot = state[2, 0]
        _change_at_open_ends(state[0], state[1], flux, out, gamma, kappa, dx, n, foot, saturation)
        if kappa is not None:
            curvature = _curvature_on_foot(state[0], foot, dx, n)
            out[2, 0] = kappa * exchanging(state[1, n - 1], saturation) * curvature
        out[2, n - 1] = flux[n] / (n * dx)


@_compiled
def _pad(state, padded, n):  # type: ignore[no-untyped-def]
    for field in range(2):
        for i in range(n):
            padded[field, i + 3] = state[field, i]
        for ghost in range(3):
            padded[field, ghost] = state[field, n - 3 + ghost]
            padded[field, n + 3 + ghost] = state[field, ghost]


@numba.njit(error_model="numpy", inline="always")
def _between(a, b):  # type: ignore[no-untyped-def]
    """The one nearer to zero where signs agree, else zero (minmod)."""
    return max(min(a, b), 0.0) + min(max(a, b), 0.0)


@numba.njit(error_model="numpy", inline="always")
def _face_value(a, b, c, d, e):  # type: ignore[no-untyped-def]
    """Value between c and d from five cells, a farthest upwind (Suresh and Huynh 1997, MP5).

    The fifth-order value, moved into the interval that monotone data allow and that is widened
    at smooth extrema.
    """
    value = (2 * a - 13 * b + 47 * c + 27 * d - 3 * e) / 60
    bend_b, bend_c, bend_d = a - 2 * b + c, b - 2 * c + d, c - 2 * d + e
    ahead = _between(_between(4 * bend_c - bend_d, 4 * bend_d - bend_c), _between(bend_c, bend_d))
    behind = _between(_between(4 * bend_c - bend_b, 4 * bend_b - bend_c), _between(bend_c, bend_b))
    upper = c + 4 * (c - b)
    median = (c + d - ahead) / 2
    large = c + (c - b) / 2 + behind * 4 / 3
    lowest = max(min(c, d, median), min(c, upper, large))
    highest = min(max(c, d, median), max(c, upper, large))
    return value + _between(lowest - value, highest - value)


@_compiled
def _climbing_face(u, face, n):  # type: ignore[no-untyped-def]
    """u at face f, between cells f - 1 and f, seen from downhill; u carries three ghost cells."""
    u1, u2, u3, u4, u5 = u[1:], u[2:], u[3:], u[4:], u[5:]
    for f in range(n + 1):
        face[f] = _face_value(u5[f], u4[f], u3[f], u2[f], u1[f])


@_compiled
def _rolling_flux(R, flux, v, D, dx, n):  # type: ignore[no-untyped-def]
    """F at face f, between cells f - 1 and f; R carries three ghost cells."""
    spread = None if D is None else D / (180 * dx)
    R0, R1, R2, R3, R4, R5 = R[0:], R[1:], R[2:], R[3:], R[4:], R[5:]
    for f in range(n + 1):
        carried = _face_value(R0[f], R1[f], R2[f], R3[f], R4[f])
        difference = 245 * (R3[f] - R2[f]) - 25 * (R4[f] - R1[f]) + 2 * (R5[f] - R0[f])
        flux[f] = v * carried if spread is None else v * carried - spread * difference


@_compiled
def _rolling_flux_at_open_ends(R, flux, v, D, dx, n):  # type: ignore[no-untyped-def]
    flux[0] = 0.0
    flux[1] = v * (R[0] + R[1]) / 2 - D * (R[1] - R[0]) / dx
    flux[n] = v * R[n - 1]
    flux[n - 1] = _third_order_drift(R, n - 1, v) - D * (R[n - 1] - R[n - 2]) / dx
    flux[2] = _third_order_drift(R, 2, v) - _fourth_order_spread(R, 2, D, dx)
    carried = _face_value(R[n - 5], R[n - 4], R[n - 3], R[n - 2], R[n - 1])
    flux[n - 2] = v * carried - _fourth_order_spread(R, n - 2, D, dx)


@_compiled
def _third_order_drift(R, f, v):  # type: ignore[no-untyped-def]
    return v * (2 * R[f] + 5 * R[f - 1] - R[f - 2]) / 6


@_compiled
def _fourth_order_spread(R, f, D, dx):  # type: ignore[no-untyped-def]
    return D * (15 * (R[f] - R[f - 1]) - (R[f + 1] - R[f - 2])) / (12 * dx)


@_compiled
def _change(  # type: ignore[no-untyped-def]
    u, R, u_face, flux, out, gamma, kappa, dx, n, saturation
):
    u0, u1, u2, u3, u4, u5, u6 = u[0:], u[1:], u[2:], u[3:], u[4:], u[5:], u[6:]
    u_face_out, flux_out = u_face[1:], flux[1:]
    u_rate, R_rate, ends_rate = out[0], out[1], out[2]
    slope = gamma / dx
    bend = None if kappa is None else kappa / (180 * dx * dx)
    for i in range(n):
        gradient = u_face_out[i] - u_face[i]
        curvature = 2 * (u0[i] + u6[i]) - 27 * (u1[i] + u5[i]) + 270 * (u2[i] + u4[i]) - 490 * u3[i]
        gained = exchange(R[i], gradient, curvature, slope, bend, saturation)
        u_rate[i] = -gained
        R_rate[i] = (flux[i] - flux_out[i]) / dx + gained
        ends_rate[i] = 0.0


@_compiled
def _change_at_open_ends(  # type: ignore[no-untyped-def]
    u, R, flux, out, gamma, kappa, dx, n, foot, saturation
):
    """The cells whose stencils would reach past an end."""
    z = n - 1
    slope = gamma / dx
    bend = None if kappa is None else kappa / dx**2
    for i, gradient, curvature in (
        (0, (-11 * u[0] + 18 * u[1] - 9 * u[2] + 2 * u[3]) / 6, 0.0),
        (1, _third_order_gradient(u, 1), u[0] - 2 * u[1] + u[2]),
        (2, _third_order_gradient(u, 2), u[1] - 2 * u[2] + u[3]),
        (z - 2, _third_order_gradient(u, z - 2), u[z - 3] - 2 * u[z - 2] + u[z - 1]),
        (
            z - 1,
            -0.3 * u[z - 2] - u[z - 1] / 1.5 + 1.5 * u[z] - foot / 1.875,
            u[z - 2] - 2 * u[z - 1] + u[z],
        ),
        (
            z,
            0.1 * u[z - 2] - u[z - 1] / 1.5 - 0.5 * u[z] + foot / 0.9375,
            -0.2 * u[z - 2] + 2 * u[z - 1] - 5 * u[z] + 3.2 * foot,
        ),
    ):
        gained = exchange(R[i], gradient, curvature, slope, bend, saturation)
        out[0, i] = -gained
        out[1, i] = (flux[i] - flux[i + 1]) / dx + gained


@_compiled
def _curvature_on_foot(u, foot, dx, n):  # type: ignore[no-untyped-def]
    """u_xx at x = N dx of the cubic with u_x = 0 there through the last two cells."""
    return (108 * (u[n - 1] - foot) - 4 * (u[n - 2] - foot)) / (9 * dx**2)


@_compiled
def _third_order_gradient(u, i):  # type: ignore[no-untyped-def]
    return (6 * u[i + 1] - 3 * u[i] - 2 * u[i - 1] - u[i + 2]) / 6


def _digest() -> str:
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()


def entry(sources: str):  # type: ignore[no-untyped-def]
    """The compiled right-hand side.

    Its machine code is kept on disk, under a key in which the values that a function closes over
    count but the files of the functions it calls do not: hence ``sources``, a digest of those.
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

    return rate


rate = entry(_digest())
