r"""BCRE about an axis as a py-pde equation: heaps, silos, cones.

    dR/dt + (1/r) d/dr (r (v n R - D dR/dr)) = E + w        dh/dt = -E
    E = gamma R (abs(dh/dr) - Sc)

Sand rolls along the steepest descent: outwards (n = 1) where the surface falls outwards or is
level, inwards (n = -1) in a hollow. As BCRE has no solution where n jumps, n falls from 1 to -1 as
the slope against the grains rises from 0 to a small s. A source lets w fall.
"""

from __future__ import annotations

import math

import numpy as np
from pde import FieldCollection, PolarSymGrid, ScalarField

from bcre_pde.exchange import exchanging
from bcre_pde.marched import Marched
from bcre_pde.material import Material
from bcre_pde.plane.radial import fluxes
from bcre_pde.plane.radial.problem import Source
from bcre_pde.problem import Array


class BCRE(Marched):
    """Radially symmetric BCRE; the state holds the fields h, R and "ends".

    h and R are means over the rings of the grid. The third field accounts for the volume: in its
    first cell what was supplied and in its last one what has left, divided by the area of the disc.

    Parameters
    ----------
    material: the coefficients; kappa must be 0.
    grid: rings from r = 0, at least 8.
    closed: whether a wall stands at the rim.
    turning: s, the slope against which grains turn back, > 0.
    most_evaluations: how often the right-hand side may be evaluated.
    """

    fields = ("h", "R")

    def __init__(
        self,
        material: Material,
        grid: PolarSymGrid,
        turning: float,
        closed: bool = False,
        most_evaluations: float = math.inf,
    ) -> None:
        (cells,) = grid.shape
        super().__init__(self.state(grid, np.zeros(cells), np.zeros(cells)), most_evaluations)
        self.dr = float(grid.discretization[0])
        self.material = material
        self.turning = turning
        self.supply = np.zeros(cells)
        self._coefficients = fluxes.Coefficients(
            v=material.v,
            D=material.D,
            gamma=material.gamma,
            Sc=material.Sc,
            saturation=material.saturation,
            dr=self.dr,
            closed=closed,
            turning=turning,
        )

    @staticmethod
    def state(grid: PolarSymGrid, h: Array, R: Array) -> FieldCollection:
        """Initial state: means of h and R over the rings, shape (N,), nothing supplied yet."""
        rows = {"h": h, "R": R, "ends": np.zeros_like(R)}
        return FieldCollection([ScalarField(grid, row, label=name) for name, row in rows.items()])

    def pour(self, source: Source | None) -> None:
        """Let this source fall from now on; rings that it covers in part get their share."""
        self.supply[:] = 0.0
        if source is not None:
            edges = self.dr * np.arange(self.supply.size + 1)
            covered = np.diff(np.minimum(edges, source.radius) ** 2)
            falling = source.rate / (math.pi * source.radius**2)
            self.supply[:] = falling * covered / np.diff(edges**2)

    def rate(self, layers: Array, out: Array) -> None:
        """Write the time derivative of h, R and ends, shape (3, N), into ``out``."""
        fluxes.rate(layers, out, self.supply, self._coefficients)

    def largest_explicit_step(self, largest_R: float) -> float:
        """The bound of the line; in the innermost ring drift counts twice.

        Where grains turn back, R and h make waves of the speed sqrt(2 gamma Sc v R/s) besides.
        """
        m = self.material
        wet = exchanging(largest_R, m.saturation)
        fastest = max(2 * m.v, m.gamma * wet)
        fastest += math.sqrt(2 * m.gamma * m.Sc * m.v * wet / self.turning)
        rate = 32 / 15 * fastest / self.dr + 272 / 45 * m.D / self.dr**2
        return 2.78 / rate if rate > 0 else math.inf

    def place(self, cell: int) -> str:
        """Its r."""
        return f"r = {(cell + 0.5) * self.dr:.6g}"
