r"""The BCRE equations on a line.

    dR/dt + d/dx (v R - D dR/dx) = E        dh/dt = -E
    E = gamma R (S - Sc) - kappa R d2h/dx2,   S = -dh/dx

(Bouchaud, Cates, Prakash, Edwards, J. Phys. I France 4 (1994) 1383), in u = h + Sc x, the height
above the repose line: E = -R (gamma u_x + kappa u_xx), the law of :mod:`bcre_pde.exchange`.

A further model on a line is a file like this one: its equations, and a class with their right-hand
side and the largest stable step, to be given to :func:`bcre_pde.solve` as ``equation``.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from bcre_pde import theory
from bcre_pde.line import fluxes
from bcre_pde.line.marched import MarchedOnLine
from bcre_pde.material import Material
from bcre_pde.problem import Array
from bcre_pde.stencils import GHOSTS

if TYPE_CHECKING:
    from pde import CartesianGrid


class BCRE(MarchedOnLine):
    """BCRE on a line, for py-pde's solvers; the parameters are those of ``MarchedOnLine``."""

    def __init__(
        self,
        material: Material,
        grid: CartesianGrid,
        most_evaluations: float = math.inf,
        walled: bool = False,
    ) -> None:
        super().__init__(material, grid, most_evaluations, walled)
        rows = 3 if material.Gamma else 2
        self._scratch = np.empty((rows, self.cells + 2 * GHOSTS)), np.empty((rows, self.cells + 1))
        self._coefficients = coefficients(material, self.dx, self.periodic, self.walled)

    def rate(self, layers: Array, out: Array) -> None:
        """Write the time derivative of the rows u, R and ends, shape (3, N), into ``out``."""
        fluxes.rate(layers, out, *self._scratch, *self._coefficients, self.supply)

    def largest_explicit_step(self, largest_R: float) -> float:
        """:func:`bcre_pde.theory.largest_explicit_step` on this grid."""
        return theory.largest_explicit_step(self.material, self.dx, largest_R)


def coefficients(
    material: Material, dx: float, periodic: bool, walled: bool = False
) -> fluxes.Coefficients:
    """A material on a grid as :mod:`bcre_pde.line.fluxes` takes it.

    A term of zero is None, so that it is not in the compiled code.
    """
    return fluxes.Coefficients(
        material.v,
        material.D or None,
        material.gamma,
        material.kappa or None,
        dx,
        periodic,
        material.saturation,
        material.Gamma or None,
        material.Sc if walled else None,
    )
