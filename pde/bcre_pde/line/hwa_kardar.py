r"""A driven surface of one variable (Hwa and Kardar, Phys. Rev. Lett. 62 (1989) 1813).

    dw/dt = nu d2w/dx2 - (lambda/2) d(w^2)/dx + noise,   w = u - level,   u = h + Sc x

w is the height above the repose line through ``level``; there is no rolling layer. Where w differs
from 0 the surface is carried downhill, dips and bumps alike, and waves of w move at lambda w: so
it comes to rest at repose only, and from below. The noise is white, of given variance.

* With phi_t = nu phi_xx, w = -(2 nu/lambda) phi_x/phi solves the equation without noise (Cole and
  Hopf; :func:`decaying_wave`).
* The right-hand side, fifth order: (lambda/2) w^2 is split into two parts, (lambda/2) (w^2 +- a
  w)/2 with a = max abs(w), each with the face value of :func:`bcre_pde.stencils.face_value` from
  its own side; w_x on a face is central, of order 6.
* Open ends: no flux through the top; beyond the foot w goes on evenly. A wall is a mirror.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pde import CartesianGrid, FieldCollection, SDEBase

from bcre_pde.advance import advance_with_noise
from bcre_pde.gate import is_finite, require_not_negative
from bcre_pde.inner import inner
from bcre_pde.kept import SOURCES, kept
from bcre_pde.line.marched import MarchedOnLine
from bcre_pde.problem import Array, Problem
from bcre_pde.stencils import GHOSTS, face_value


@dataclass(frozen=True)
class Surface:
    """The coefficients.

    Parameters
    ----------
    nu: diffusion of the height, length^2/time, >= 0.
    lam: lambda, speed per unit of height, 1/time, >= 0.
    Sc: repose slope, tangent of the angle of repose, >= 0.
    level: h + Sc x of a surface at rest, a length.
    noise: variance of the noise, length^3/time, >= 0; :func:`evolve_with_noise` alone heeds it.

    Raises
    ------
    ValueError
        naming the parameter, its value and what is allowed.
    """

    nu: float
    lam: float
    Sc: float
    level: float = 0.0
    noise: float = 0.0

    def __post_init__(self) -> None:
        for name in ("nu", "lam", "Sc", "noise"):
            require_not_negative(name, getattr(self, name))
        if not is_finite(self.level):
            raise ValueError(f"level = {self.level!r}: must be a finite number")


class HwaKardar(MarchedOnLine, SDEBase):  # type: ignore[misc]
    """The model on a line, for py-pde's solvers; R of the state is 0 and stays so.

    The material is a :class:`Surface`.
    """

    material: Surface

    def __init__(
        self,
        material: Surface,
        grid: CartesianGrid,
        most_evaluations: float = math.inf,
        walled: bool = False,
    ) -> None:
        super().__init__(material, grid, most_evaluations, walled)
        self._scratch = np.empty((3, self.cells + 2 * GHOSTS)), np.empty(self.cells + 1)
        self.supply = np.zeros(self.cells)

    def rate(self, layers: Array, out: Array) -> None:
        """Write the time derivative of the rows u, R and ends, shape (3, N), into ``out``."""
        m, closed = self.material, self.walled or self.periodic
        rate(
            layers,
            out,
            *self._scratch,
            self.supply,
            m.nu,
            m.lam,
            m.level,
            self.dx,
            closed,
            self.periodic,
        )

    def largest_explicit_step(self, largest_R: float) -> float:
        """Step at which an explicit method of order 4 is still stable, for the w of the moment."""
        m = self.material
        fastest = m.lam * float(np.abs(self.last_layers[0] - m.level).max())
        bound = 32 / 15 * fastest / self.dx + 272 / 45 * m.nu / self.dx**2
        return 2.78 / bound if bound > 0 else math.inf


@inner
def _extend(row, cells, periodic, walled):
    first, last = GHOSTS, GHOSTS + cells - 1
    for k in range(1, GHOSTS + 1):
        if periodic:
            row[first - k], row[last + k] = row[last + 1 - k], row[first - 1 + k]
        else:
            row[first - k] = row[first + k - 1]
            row[last + k] = row[last + 1 - k] if walled else row[last]


def entry(sources: str):
    """The compiled right-hand side; ``sources`` is a part of the key of its machine code."""

    @kept()
    def rate(state, out, padded, flux, supply, nu, lam, level, dx, closed, periodic):
        """Write the time derivative of ``state`` into ``out``.

        Parameters
        ----------
        state, out: as for :func:`bcre_pde.line.fluxes.rate`.
        padded, flux: scratch of shapes (3, N + 6) and (N + 1,).
        supply: what sources pour into each cell, length/time, shape (N,).
        nu, lam, level, dx: the coefficients, and the cell length.
        closed, periodic: whether nothing leaves, and whether the ends are joined.
        """
        sources  # noqa: B018
        cells = state.shape[1]
        w, down, up = padded[0], padded[1], padded[2]
        for i in range(cells):
            w[i + GHOSTS] = state[0, i] - level
        _extend(w, cells, periodic, closed)
        fastest = np.abs(w).max()
        for i in range(w.size):
            down[i] = 0.25 * lam * w[i] * (w[i] + fastest)
            up[i] = 0.25 * lam * w[i] * (w[i] - fastest)
        for f in range(cells + 1):
            carried = face_value(down[f], down[f + 1], down[f + 2], down[f + 3], down[f + 4])
            carried += face_value(up[f + 5], up[f + 4], up[f + 3], up[f + 2], up[f + 1])
            climb = 245 * (w[f + 3] - w[f + 2]) - 25 * (w[f + 4] - w[f + 1]) + 2 * (w[f + 5] - w[f])
            flux[f] = carried - nu / (180 * dx) * climb
        if not periodic:
            flux[0] = 0.0
            if closed:
                flux[cells] = 0.0
        for i in range(cells):
            out[0, i] = (flux[i] - flux[i + 1]) / dx + supply[i]
            out[1, i] = out[2, i] = 0.0
        if not closed:
            out[2, cells - 1] = flux[cells] / (cells * dx)

    return rate


rate = entry(SOURCES)


def evolve_with_noise(
    problem: Problem, times: Sequence[float], cells: int, dt: float, seed: int
) -> Array:
    """w at the ascending ``times``, shape (T, N), by Euler-Maruyama steps of about ``dt``.

    py-pde draws the noise from ``seed``; no solver of it with noise is more accurate.

    Parameters
    ----------
    problem: whose initial R is 0; its material is a :class:`Surface`.
    dt: step, > 0; with c = lambda max abs(w), at most nu/c^2 and dx^2/(8 nu).
    """
    m: Surface = problem.material  # type: ignore[assignment]
    grid = HwaKardar.grid(problem.length, cells, problem.ends)
    equation = HwaKardar(m, grid, walled=problem.ends == "wall")
    equation.noise = np.array([m.noise, 0.0, 0.0])
    equation.rng = np.random.default_rng(seed)
    x = grid.cell_coords[:, 0]
    h, R = problem.initial(x)
    state: FieldCollection = equation.state(grid, h + m.Sc * x, R)
    frames, now = [], 0.0
    for then in times:
        if then > now:
            state, now = advance_with_noise(equation, state, (now, then), dt), then
        frames.append(state[0].data - m.level)
    return np.array(frames)


def decaying_wave(x: Array, t: float, surface: Surface, amplitude: float, k: float) -> Array:
    r"""w = -(2 nu/lambda) phi_x/phi with phi = 1 + a e^(-nu k^2 t) cos k x, abs(a) < 1; (N,)."""
    decayed = amplitude * math.exp(-surface.nu * k**2 * t)
    phi = 1 + decayed * np.cos(k * x)
    return np.asarray(2 * surface.nu / surface.lam * decayed * k * np.sin(k * x) / phi)
