r"""The BCRE equations as a py-pde equation.

    dR/dt + d/dx (v R - D dR/dx) = E        dh/dt = -E
    E = gamma R (S - Sc) - kappa R d2h/dx2,   S = -dh/dx

(Bouchaud, Cates, Prakash, Edwards, J. Phys. I France 4 (1994) 1383), in u = h + Sc x, the height
above the repose line: E = -R (gamma u_x + kappa u_xx), the law of :mod:`bcre_pde.exchange`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pde import CartesianGrid, FieldCollection, ScalarField

from bcre_pde import fluxes
from bcre_pde.exchange import exchanging
from bcre_pde.marched import Marched

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Material:
    """What the sand is: the coefficients of BCRE.

    Parameters
    ----------
    v: drift speed of the rolling layer, length/time, >= 0.
    D: diffusion of the rolling layer, length^2/time, >= 0.
    gamma: exchange rate, 1/time, >= 0.
    Sc: repose slope, tangent of the angle of repose, >= 0.
    kappa: curvature term of the exchange, length/time, >= 0.
    v_up: largest speed of the climbing wave, length/time, > 0: for thick flows, in which only the
        grains next to the static layer exchange, gamma R becomes gamma R/(1 + gamma R/v_up)
        (Boutreux, Raphaël and de Gennes 1998). Infinite, the default, is the linear law.

    Raises
    ------
    ValueError
        naming the parameter, its value and what is allowed.
    """

    v: float
    D: float
    gamma: float
    Sc: float
    kappa: float = 0.0
    v_up: float = math.inf

    @property
    def saturation(self) -> float | None:
        """gamma/v_up, or None for the linear exchange law."""
        return None if math.isinf(self.v_up) else self.gamma / self.v_up

    def __post_init__(self) -> None:
        for name in ("v", "D", "gamma", "Sc", "kappa"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= 0):
                raise ValueError(f"{name} = {value!r}: must be a finite number >= 0")
        if not self.v_up > 0:
            raise ValueError(f"v_up = {self.v_up!r}: must be > 0")


class BCRE(Marched):
    """BCRE on a line; the state holds the fields u, R and "ends".

    The third field serves open ends: its first cell is u on the foot, its last one the outflow so
    far divided by the length of the domain. As part of the state the outflow is integrated by the
    same solver, so that ``length (mean(u) + mean(R) + ends[-1])`` is constant to rounding.

    Parameters
    ----------
    material: the coefficients.
    grid: a line of N >= 8 cells from x = 0, periodic or not.
    most_evaluations: how often the right-hand side may be evaluated.
    """

    def __init__(
        self, material: Material, grid: CartesianGrid, most_evaluations: float = math.inf
    ) -> None:
        (cells,) = grid.shape
        if cells < fluxes.SMALLEST_GRID:
            raise ValueError(f"cells = {cells}: BCRE needs at least {fluxes.SMALLEST_GRID} cells")
        super().__init__(self.state(grid, np.zeros(cells), np.zeros(cells)), most_evaluations)
        self.material = material
        self.dx = float(grid.discretization[0])
        self._scratch = np.empty((2, cells + 2 * fluxes.GHOSTS)), np.empty((2, cells + 1))
        self._coefficients = (
            material.v,
            material.D or None,
            material.gamma,
            material.kappa or None,
            self.dx,
            bool(grid.periodic[0]),
            material.saturation,
        )

    @staticmethod
    def state(grid: CartesianGrid, u: Array, R: Array, u_foot: float = 0.0) -> FieldCollection:
        """Initial state: u and R at the cell centres, shape (N,), u on the foot, no outflow yet."""
        names = ("u", "R", "ends")
        ends = np.zeros_like(R)
        ends[0] = u_foot
        rows = (u, R, ends)
        return FieldCollection(
            [ScalarField(grid, row, label=name) for name, row in zip(names, rows, strict=True)]
        )

    def rate(self, layers: Array, out: Array) -> None:
        """Write the time derivative of the rows u, R and ends, shape (3, N), into ``out``."""
        fluxes.rate(layers, out, *self._scratch, *self._coefficients)

    def largest_explicit_step(self, largest_R: float) -> float:
        """:func:`largest_explicit_step` on this grid."""
        return largest_explicit_step(self.material, self.dx, largest_R)

    def place(self, cell: int) -> str:
        """Its x."""
        return f"x = {(cell + 0.5) * self.dx:.6g}"


def largest_explicit_step(material: Material, dx: float, largest_R: float) -> float:
    """Step at which an explicit Runge-Kutta method of order 4 is still stable.

    On the negative real axis the spectra of the stencils reach 32/15 for the drift v/dx and the
    climb gamma R/dx, 272/45 for the spreads D/dx^2 and kappa R/dx^2, and the method 2.78.
    """
    wet = exchanging.py_func(largest_R, material.saturation)
    drift = max(material.v, material.gamma * wet)
    spread = max(material.D, material.kappa * wet)
    rate = 32 / 15 * drift / dx + 272 / 45 * spread / dx**2
    return 2.78 / rate if rate > 0 else math.inf
