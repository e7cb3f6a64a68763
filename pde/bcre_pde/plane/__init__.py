"""BCRE on a surface: a tilted plane here, heaps about an axis in :mod:`bcre_pde.plane.radial`.

Start at :mod:`bcre_pde.plane.equation` for the equations, :mod:`bcre_pde.plane.fluxes` for their
right-hand side, :mod:`bcre_pde.plane.solve` for solving them, and :mod:`bcre_pde.plane.theory` and
:mod:`bcre_pde.plane.exact` for what is known in closed form.

Nothing imported here needs py-pde or numba; ``march`` imports them.
"""

from bcre_pde.plane.material import Material
from bcre_pde.plane.problem import Frame, Problem, Sides, Solution
from bcre_pde.plane.solve import march, solve

__all__ = ["Frame", "Material", "Problem", "Sides", "Solution", "march", "solve"]
