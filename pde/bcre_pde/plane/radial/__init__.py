"""Radially symmetric BCRE on py-pde's ``PolarSymGrid``: the reference for heaps on a free surface.

Start at :mod:`bcre_pde.plane.radial.equation` for the equations,
:mod:`bcre_pde.plane.radial.fluxes` for their right-hand side, and
:mod:`bcre_pde.plane.radial.theory` for what is known in closed form.
"""

from bcre_pde.plane.radial.problem import Problem, Rim, Solution, Source
from bcre_pde.plane.radial.solve import solve

__all__ = ["Problem", "Rim", "Solution", "Source", "solve"]
