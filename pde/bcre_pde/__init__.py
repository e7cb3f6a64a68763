"""The BCRE equations of sandpile surfaces on py-pde.

Start at :mod:`bcre_pde.equation` for the equations, :mod:`bcre_pde.exchange` and
:mod:`bcre_pde.fluxes` for their right-hand side, :mod:`bcre_pde.solve` for solving them,
:mod:`bcre_pde.fixed_step` for steps of fixed length, :mod:`bcre_pde.refine` for the error of a
solution, and :mod:`bcre_pde.theory` and :mod:`bcre_pde.exact` for what is known in closed form.
"""

from bcre_pde.equation import BCRE, Material, largest_explicit_step
from bcre_pde.failure import SolveError
from bcre_pde.fluxes import SMALLEST_GRID
from bcre_pde.refine import Refined, grid_convergence_index, solve_refined
from bcre_pde.solve import Problem, Solution, solve
from bcre_pde.theory import second_critical_slope

__all__ = [
    "BCRE",
    "SMALLEST_GRID",
    "Material",
    "Problem",
    "Refined",
    "Solution",
    "SolveError",
    "grid_convergence_index",
    "largest_explicit_step",
    "second_critical_slope",
    "solve",
    "solve_refined",
]
