r"""The automaton's own difference in space, given to SciPy's LSODA: the method of lines.

    dR_i/dt = (F_(i-1) - F_i)/d + E_i       F_i = v R_i - D (R_(i+1) - R_i)/d
    du_i/dt = -E_i                          E_i = -R_i (gamma (u_(i+1) - u_i)/d
                                                        + kappa (u_(i+1) - 2 u_i + u_(i-1))/d^2)

LSODA takes steps of its own choice, implicit ones where they pay. The unknowns are interleaved,
u_0, R_0, u_1, R_1, ..., so that the Jacobian has a band: R_i depends on R_(i-1) two places below
and on R_(i+1) two above (three below with kappa, u_(i-1)). Periodic ends break the band, and the
Jacobian is then a full matrix of 2 N columns.

Ends as in :mod:`bcre_ca.step`; u_xx = 0 in the first cell.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from bcre_pde import Problem
from bcre_studies.performance.rivals.rivals import (
    Array,
    EndState,
    Solve,
    centres,
    start_above_repose,
)


def prepare(
    problem: Problem, until: float, cells: int, tolerance: float = 1e-6, banded: bool = True
) -> Solve:
    """LSODA up to ``until``.

    Parameters
    ----------
    tolerance: local error per step, relative to each value and to the largest rolling layer.
    banded: whether LSODA may use the band; with periodic ends the matrix has none.

    Raises
    ------
    RuntimeError
        where LSODA gave up (raised by the function that this returns).
    """
    x = centres(problem, cells)
    u, R = start_above_repose(problem, x)
    initial = np.column_stack([u, R]).ravel()
    options: dict[str, Any] = {"rtol": tolerance, "atol": tolerance * (float(R.max()) or 1.0)}
    if banded and problem.ends == "open":
        options |= {"lband": 3 if problem.material.kappa > 0 else 2, "uband": 2}
    rate = make_rate(problem, cells)

    def solve() -> EndState:
        found = solve_ivp(rate, (0.0, until), initial, method="LSODA", **options)
        if not found.success:
            raise RuntimeError(f"LSODA gave up: {found.message}")
        u, R = found.y[:, -1].reshape(cells, 2).T.copy()
        return EndState(x, u - problem.material.Sc * x, R, found.t.size - 1, int(found.nfev))

    return solve


def make_rate(problem: Problem, cells: int) -> Callable[[float, Array], Array]:
    """The time derivative of the interleaved unknowns, shape (2 N,), in plain NumPy."""
    material, d, periodic = problem.material, problem.length / cells, problem.ends == "periodic"
    climb, bend = material.gamma / d, material.kappa / d**2
    forth, back = material.v / d + material.D / d**2, material.D / d**2
    rise, flux = np.zeros(cells + 1), np.zeros(cells + 1)

    def rate(_: float, state: Array) -> Array:
        u, R = state[0::2], state[1::2]
        np.subtract(u[1:], u[:-1], out=rise[1:-1])
        np.subtract(forth * R[:-1], back * R[1:], out=flux[1:-1])
        if periodic:
            rise[0] = rise[-1] = u[0] - u[-1]
            flux[0] = flux[-1] = forth * R[-1] - back * R[0]
        else:
            flux[-1] = material.v / d * R[-1]
            rise[0] = rise[1]  # so that u_xx = 0 in the first cell
        settled = climb * rise[1:]
        if bend > 0:
            settled += bend * (rise[1:] - rise[:-1])
        settled *= R
        out = np.empty_like(state)
        out[0::2] = settled
        np.subtract(flux[:-1], flux[1:], out=out[1::2])
        out[1::2] -= settled
        return out

    return rate
