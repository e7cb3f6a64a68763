r"""BCRE once more, by methods that are not those of the package: simple, slower, independent.

    R_t + (v R - D R_x)_x = E      u_t = -E      E = -X(R) (gamma u_x + kappa u_xx),  u = h + Sc x

:func:`finite_volumes`: cell averages, faces by van Leer's limited differences (second order), steps
by the three-stage Runge-Kutta method of Shu and Osher; for all ends, and past a scarp.
:func:`fourier`: derivatives by the fast Fourier transform, time by SciPy's DOP853; for joined ends
and smooth layers only, where it is exact to rounding.

Open ends: no flux through the top, and u_xx = 0 there; v R leaves through the foot, beyond which
the surface goes on at repose: u_x = 0 on it, so that u there changes by kappa X u_xx alone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.interpolate import make_interp_spline

from sand import Sand

Array = NDArray[np.float64]


@dataclass
class History:
    """u and R at cell centres x (N,) and times t (T,), and what has left through the foot (T,)."""

    x: Array
    t: Array
    u: Array
    R: Array
    outflow: Array
    length: float
    periodic: bool

    def at(self, x: Array) -> tuple[Array, Array]:
        """u and R at positions x, by cubics between the cells, shape (T, x.size)."""
        places, u, R = self.x, self.u, self.R
        if self.periodic:
            places = np.concatenate([places[-3:] - self.length, places, places[:3] + self.length])
            u, R = (np.hstack([rows[:, -3:], rows, rows[:, :3]]) for rows in (u, R))
        return tuple(make_interp_spline(places, rows, k=3, axis=1)(x) for rows in (u, R))


def finite_volumes(
    sand: Sand,
    u: Array,
    R: Array,
    foot: float,
    length: float,
    times: Sequence[float],
    periodic: bool,
    part: float = 0.8,
) -> History:
    """The layers at the ascending times, from cell averages u and R and from u on the foot.

    ``part`` is the step as a part of the one at which the surface wave, the drift or the diffusion
    would cross a cell.
    """
    n = u.size
    dx = length / n
    state = np.concatenate([u, R, [foot, 0.0]])
    wide = np.empty((2, n + 4))

    def rate(y: Array) -> Array:
        u, R, foot = y[:n], y[n:-2], y[-2]
        X = sand.exchanging(np.maximum(R, 0.0))
        wide[0, 2:-2], wide[1, 2:-2] = u, R
        if periodic:
            wide[:, :2], wide[:, -2:] = wide[:, -4:-2], wide[:, 2:4]
        else:
            wide[0, :2] = u[0] + (u[0] - u[1]) * np.array([2, 1])
            wide[0, -2:] = 2 * foot - u[[-1, -2]]
            wide[1, :2], wide[1, -2:] = R[0], R[-1]
        difference = np.diff(wide)
        half = van_leer(difference) / 2
        u_face = wide[0, 2 : n + 3] - half[0, 1 : n + 2]
        R_face = wide[1, 1 : n + 2] + half[1, : n + 1]
        bend = (difference[0, 2 : n + 2] - difference[0, 1 : n + 1]) / dx**2
        flux = sand.v * R_face - sand.D * difference[1, 1 : n + 2] / dx
        foot_rate = 0.0
        if not periodic:
            u_face[n] = foot
            bend[0], bend[-1] = 0.0, (u[-2] - u[-1]) / dx**2
            flux[0], flux[n] = 0.0, sand.v * R[-1]
            foot_rate = sand.kappa * X[-1] * 8 * (u[-1] - foot) / dx**2
        E = -X * (sand.gamma * np.diff(u_face) / dx + sand.kappa * bend)
        return np.concatenate([-E, E - np.diff(flux) / dx, [foot_rate, flux[n]]])

    def longest() -> float:
        X = sand.exchanging(max(float(state[n:-2].max()), 0.0))
        wave = max(sand.v, sand.gamma * X) / dx
        return part / (wave + 2 * max(sand.D, sand.kappa * X) / dx**2 + 1e-300)

    now, frames = 0.0, []
    for then in times:
        while now < then - 1e-12 * times[-1]:
            dt = min(longest(), then - now)
            first = state + dt * rate(state)
            second = (3 * state + first + dt * rate(first)) / 4
            state = (state + 2 * (second + dt * rate(second))) / 3
            now += dt
        frames.append(state.copy())
    rows = np.array(frames)
    x = (np.arange(n) + 0.5) * dx
    outflow = np.zeros(len(frames)) if periodic else rows[:, -1]
    return History(x, np.array(times), rows[:, :n], rows[:, n:-2], outflow, length, periodic)


def van_leer(differences: Array) -> Array:
    """Limited differences across cells, from those to their neighbours (monotonized central)."""
    a, b = differences[:, :-1], differences[:, 1:]
    size = np.minimum(2 * np.minimum(np.abs(a), np.abs(b)), np.abs(a + b) / 2)
    return np.where(a * b > 0, np.sign(a) * size, 0.0)


def fourier(
    sand: Sand, u: Array, R: Array, length: float, times: Sequence[float], tolerance: float = 1e-10
) -> History:
    """The layers at the ascending times, from values at cell centres."""
    n = u.size
    wave = 2j * np.pi * np.fft.rfftfreq(n, length / n)

    def rate(_t: float, y: Array) -> Array:
        u, R = y[:n], y[n:]
        u_hat, R_hat = np.fft.rfft(u), np.fft.rfft(R)
        u_x = np.fft.irfft(wave * u_hat, n)
        u_xx = np.fft.irfft(wave**2 * u_hat, n)
        carried = np.fft.irfft((sand.v * wave - sand.D * wave**2) * R_hat, n)
        E = -sand.exchanging(R) * (sand.gamma * u_x + sand.kappa * u_xx)
        return np.concatenate([-E, E - carried])

    solution = solve_ivp(
        rate,
        (0.0, times[-1]),
        np.concatenate([u, R]),
        "DOP853",
        t_eval=times,
        rtol=tolerance,
        atol=tolerance * float(np.abs(R).max() or 1.0),
    )
    rows = solution.y.T
    x = (np.arange(n) + 0.5) * length / n
    nothing = np.zeros(len(times))
    return History(x, np.array(times), rows[:, :n], rows[:, n:], nothing, length, True)


def by_two_grids(
    solve: Callable[[int], History], cells: int, x: Array
) -> tuple[Array, Array, Array, Array]:
    """u and R at x on ``2 cells``, and how far they are from those on ``cells``."""
    coarse, fine = solve(cells).at(x), solve(2 * cells).at(x)
    return fine[0], fine[1], np.abs(fine[0] - coarse[0]), np.abs(fine[1] - coarse[1])
