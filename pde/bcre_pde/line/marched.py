"""What all equations on a line have in common; a model adds its right-hand side and its bound."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from pde import CartesianGrid, FieldCollection, ScalarField

from bcre_pde.marched import Marched
from bcre_pde.problem import SMALLEST_GRID, Array, Ends
from bcre_pde.source import Source


class MarchedOnLine(Marched):
    """An equation for u and R on a line; the state holds the fields u, R and "ends".

    Of the third field the first cell is u on the foot, and the last one the outflow so far divided
    by the length of the domain. So ``length (mean(u) + mean(R) + ends[-1])`` is constant to
    rounding.

    Parameters
    ----------
    material: the coefficients of the model.
    grid: a line of N >= 8 cells from x = 0, periodic or not.
    most_evaluations: how often the right-hand side may be evaluated.
    walled: whether a wall stands at the foot.
    """

    def __init__(
        self,
        material: Any,
        grid: CartesianGrid,
        most_evaluations: float = math.inf,
        walled: bool = False,
    ) -> None:
        (cells,) = grid.shape
        if cells < SMALLEST_GRID:
            raise ValueError(f"cells = {cells}: BCRE needs at least {SMALLEST_GRID} cells")
        super().__init__(self.state(grid, np.zeros(cells), np.zeros(cells)), most_evaluations)
        self.material = material
        self.cells = cells
        self.dx = float(grid.discretization[0])
        self.periodic = bool(grid.periodic[0])
        self.walled = walled
        self.supply: Array | None = None

    @staticmethod
    def grid(length: float, cells: int, ends: Ends) -> CartesianGrid:
        """The line 0 <= x <= length."""
        return CartesianGrid([[0.0, length]], cells, periodic=ends == "periodic")

    @staticmethod
    def state(grid: CartesianGrid, u: Array, R: Array, u_foot: float = 0.0) -> FieldCollection:
        """Initial state: u and R at the cell centres, shape (N,), u on the foot, no outflow yet."""
        ends = np.zeros_like(R)
        ends[0] = u_foot
        rows = {"u": u, "R": R, "ends": ends}
        return FieldCollection([ScalarField(grid, row, label=name) for name, row in rows.items()])

    def pour(self, sources: Sequence[Source]) -> None:
        """Let these sources fall from now on: ``supply`` holds what each cell gets of them."""
        edges = self.dx * np.arange(self.cells + 1)
        self.supply = sum((source.over(edges) for source in sources), np.zeros(self.cells))

    def place(self, cell: int) -> str:
        """Its x."""
        return f"x = {(cell + 0.5) * self.dx:.6g}"
