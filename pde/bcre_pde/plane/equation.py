r"""BCRE on a tilted plane as a py-pde equation.

    dR/dt + d/dx (v R - D_x dR/dx) - d/dy (D_y dR/dy) = E        dh/dt = -E
    E = gamma R (S - Sc) - R (kappa_x d2h/dx2 + kappa_y d2h/dy2),   S = -dh/dx

(Bouchaud and Cates, Granular Matter 1 (1998) 101), x downhill, y across, in u = h + Sc x.
"""

from __future__ import annotations

import math

import numpy as np
from pde import CartesianGrid, FieldCollection, ScalarField

from bcre_pde.marched import Marched
from bcre_pde.plane import fluxes, sums, theory
from bcre_pde.plane.material import Material
from bcre_pde.plane.problem import checked_cells
from bcre_pde.problem import Array


class BCRE(Marched):
    """BCRE on a plane; the state holds the fields u, R and "ends".

    As on a line, the third field serves open ends: u on the foot in its first row; in its last one
    the outflow of every column so far, divided by the length of the plane.

    Parameters
    ----------
    material: the coefficients.
    grid: at least 8 cells along x and 3 across y, from x = y = 0, each periodic or not.
    most_evaluations: how often the right-hand side may be evaluated.
    threads: on how many it is evaluated, >= 1; the numbers are the same on any.
    bed: u of a rigid base, (Nx, Ny), and the grain of the layer on it: see
        :mod:`bcre_pde.plane.bed`.
    """

    def __init__(
        self,
        material: Material,
        grid: CartesianGrid,
        most_evaluations: float = math.inf,
        threads: int = 1,
        bed: tuple[Array, float] | None = None,
    ) -> None:
        checked_cells(grid.shape)
        if threads < 1:
            raise ValueError(f"threads = {threads!r}: must be at least 1")
        nothing = np.zeros(grid.shape)
        super().__init__(self.state(grid, nothing, nothing, nothing[0]), most_evaluations)
        self.material = material
        self.dx, self.dy = (float(length) for length in grid.discretization)
        self.columns = int(grid.shape[1])
        self.threads = threads
        bends = material.kappa_x > 0 or material.kappa_y > 0
        self._base = None if bed is None else bed[0]
        self._coefficients = fluxes.Coefficients(
            v=material.v,
            D_x=material.D_x,
            D_y=material.D_y,
            gamma=material.gamma,
            kappa_x=material.kappa_x if bends else None,
            kappa_y=material.kappa_y if bends else None,
            saturation=material.along.saturation,
            dx=self.dx,
            dy=self.dy,
            joined_ends=bool(grid.periodic[0]),
            joined_sides=bool(grid.periodic[1]),
            grain=math.inf if bed is None else bed[1],
        )

    @staticmethod
    def grid(
        length: float, width: float, cells: tuple[int, int], joined: tuple[bool, bool]
    ) -> CartesianGrid:
        """The plane; ``joined``: whether its ends and its sides are periodic."""
        return CartesianGrid([[0.0, length], [0.0, width]], cells, periodic=list(joined))

    @staticmethod
    def state(grid: CartesianGrid, u: Array, R: Array, u_foot: Array) -> FieldCollection:
        """Initial state: u and R at the cell centres, (Nx, Ny); u on the foot, (Ny,)."""
        ends = np.zeros(grid.shape)
        ends[0] = u_foot
        rows = {"u": u, "R": R, "ends": ends}
        return FieldCollection([ScalarField(grid, row, label=name) for name, row in rows.items()])

    def rate(self, layers: Array, out: Array) -> None:
        """Write the time derivative of u, R and ends, shape (3, Nx, Ny), into ``out``."""
        if self.threads == 1:
            fluxes.rate(layers, out, self._base, self._coefficients)
        else:
            fluxes.rate_on_threads(layers, out, self._base, self._coefficients, self.threads)

    def weighted_sum(
        self, start: Array, terms: Array, weights: Array, count: int, dt: float, out: Array
    ) -> None:
        """See :func:`bcre_pde.plane.sums.weighted_sum`."""
        if self.threads == 1:
            sums.weighted_sum(start, terms, weights, count, dt, out)
        else:
            sums.weighted_sum_on_threads(start, terms, weights, count, dt, out, self.threads)

    def compile(self, state: FieldCollection) -> None:
        """Compile what a march calls, or load it from disk; counts as nothing."""
        layers = np.array(state.data)
        terms = np.zeros((1, *layers.shape))
        self.rate(layers, terms[0])
        self.weighted_sum(layers, terms, np.zeros(1), 1, 0.0, np.zeros_like(layers))

    def largest_explicit_step(self, largest_R: float) -> float:
        """:func:`bcre_pde.plane.theory.largest_explicit_step` on this grid."""
        return theory.largest_explicit_step(self.material, self.dx, self.dy, largest_R)

    def cell(self, cell: int) -> tuple[int, int]:
        """(i, j), along and across."""
        return divmod(cell, self.columns)

    def place(self, cell: int) -> str:
        """Its x and y."""
        i, j = self.cell(cell)
        return f"x = {(i + 0.5) * self.dx:.6g}, y = {(j + 0.5) * self.dy:.6g}"
