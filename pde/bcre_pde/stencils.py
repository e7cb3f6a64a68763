r"""Finite differences of BCRE on one row of cells along the flow; a line has one, a plane many.

* A value on a face: :func:`face_value`, of fifth order, upwind-biased and monotone.
* Next to open ends: the stencils of order 2 and 3 that the domain still offers.

Fluxes and values on faces are numbered by the cell downhill of them: face f lies between cells
f - 1 and f. ``cells`` is the number of cells.
"""

from __future__ import annotations

import numba

from bcre_pde.exchange import exchange
from bcre_pde.inner import inner

GHOSTS = 3
"""Cells that the widest stencil reaches beyond its own."""

_inlined = numba.njit(error_model="numpy", inline="always")


@_inlined
def _between(one, other):
    """The one nearer to zero where signs agree, else zero (minmod)."""
    return max(min(one, other), 0.0) + min(max(one, other), 0.0)


@_inlined
def face_value(upwind_3, upwind_2, upwind, downwind, downwind_2):
    """Value on the face between ``upwind`` and ``downwind`` from five cells in a row.

    The fifth-order value, moved into the interval that monotone data allow and that is widened at
    smooth extrema (MP5; Suresh and Huynh 1997).
    """
    value = (2 * upwind_3 - 13 * upwind_2 + 47 * upwind + 27 * downwind - 3 * downwind_2) / 60
    bend_behind = upwind_3 - 2 * upwind_2 + upwind
    bend_here = upwind_2 - 2 * upwind + downwind
    bend_ahead = upwind - 2 * downwind + downwind_2
    ahead = _between(
        _between(4 * bend_here - bend_ahead, 4 * bend_ahead - bend_here),
        _between(bend_here, bend_ahead),
    )
    behind = _between(
        _between(4 * bend_here - bend_behind, 4 * bend_behind - bend_here),
        _between(bend_here, bend_behind),
    )
    upper = upwind + 4 * (upwind - upwind_2)
    median = (upwind + downwind - ahead) / 2
    large = upwind + (upwind - upwind_2) / 2 + behind * 4 / 3
    lowest = max(min(upwind, downwind, median), min(upwind, upper, large))
    highest = min(max(upwind, downwind, median), max(upwind, upper, large))
    return value + _between(lowest - value, highest - value)


@inner
def rolling_flux_at_open_ends(R, flux, v, D, dx, cells):
    """F on the three faces next to either end, written into ``flux``, shape (cells + 1,)."""
    flux[0] = 0.0
    flux[1] = v * (R[0] + R[1]) / 2 - D * (R[1] - R[0]) / dx
    flux[cells] = v * R[cells - 1]
    flux[cells - 1] = _third_order_drift(R, cells - 1, v) - D * (R[cells - 1] - R[cells - 2]) / dx
    flux[2] = _third_order_drift(R, 2, v) - _fourth_order_spread(R, 2, D, dx)
    carried = face_value(R[cells - 5], R[cells - 4], R[cells - 3], R[cells - 2], R[cells - 1])
    flux[cells - 2] = v * carried - _fourth_order_spread(R, cells - 2, D, dx)


@inner
def _third_order_drift(R, face, v):
    return v * (2 * R[face] + 5 * R[face - 1] - R[face - 2]) / 6


@inner
def _fourth_order_spread(R, face, D, dx):
    return D * (15 * (R[face] - R[face - 1]) - (R[face + 1] - R[face - 2])) / (12 * dx)


@inner
def change_at_open_ends(u, R, flux, rates, gamma, kappa, dx, cells, foot, saturation):
    """Rates of u and R, rows 0 and 1 of ``rates``, in the three cells next to either end."""
    last = cells - 1
    per_gradient = gamma / dx
    per_curvature = None if kappa is None else kappa / dx**2
    for i, gradient, curvature in (
        (0, (-11 * u[0] + 18 * u[1] - 9 * u[2] + 2 * u[3]) / 6, 0.0),
        (1, _third_order_gradient(u, 1), u[0] - 2 * u[1] + u[2]),
        (2, _third_order_gradient(u, 2), u[1] - 2 * u[2] + u[3]),
        (
            last - 2,
            _third_order_gradient(u, last - 2),
            u[last - 3] - 2 * u[last - 2] + u[last - 1],
        ),
        (
            last - 1,
            -0.3 * u[last - 2] - u[last - 1] / 1.5 + 1.5 * u[last] - foot / 1.875,
            u[last - 2] - 2 * u[last - 1] + u[last],
        ),
        (
            last,
            0.1 * u[last - 2] - u[last - 1] / 1.5 - 0.5 * u[last] + foot / 0.9375,
            -0.2 * u[last - 2] + 2 * u[last - 1] - 5 * u[last] + 3.2 * foot,
        ),
    ):
        gained = exchange(R[i], gradient, curvature, per_gradient, per_curvature, saturation)
        rates[0, i] = -gained
        rates[1, i] = (flux[i] - flux[i + 1]) / dx + gained


@inner
def _third_order_gradient(u, i):
    return (6 * u[i + 1] - 3 * u[i] - 2 * u[i - 1] - u[i + 2]) / 6


@inner
def curvature_on_foot(u, foot, dx, cells):
    """u_xx at x = cells dx of the cubic with u_x = 0 there through the last two cells."""
    return (108 * (u[cells - 1] - foot) - 4 * (u[cells - 2] - foot)) / (9 * dx**2)
