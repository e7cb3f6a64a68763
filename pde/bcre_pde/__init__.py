"""The BCRE equations of sandpile surfaces on py-pde.

Start at :mod:`bcre_pde.equation` for the equations. Their coefficients are in
:mod:`bcre_pde.material`, and their right-hand side is in :mod:`bcre_pde.exchange`,
:mod:`bcre_pde.stencils` and :mod:`bcre_pde.line`. :mod:`bcre_pde.solve` solves them,
:mod:`bcre_pde.fixed_step` takes steps of fixed length, :mod:`bcre_pde.refine` refines grids until
the error by :mod:`bcre_pde.convergence` is small.
:mod:`bcre_pde.theory` and :mod:`bcre_pde.exact` hold what is known in closed form.

Nothing imported here needs py-pde or numba, which take seconds; ``solve`` imports them.
"""

from bcre_pde.convergence import error_of_finest, grid_convergence_index, jump_stands
from bcre_pde.failure import SolveError
from bcre_pde.material import Material
from bcre_pde.problem import SMALLEST_GRID, Ends, Method, Problem, Solution
from bcre_pde.refine import (
    COARSEST,
    LEAST_GRIDS,
    Measured,
    measure_refined,
    solve_refined,
    solve_refined_each,
)
from bcre_pde.solve import solve
from bcre_pde.theory import largest_explicit_step, second_critical_slope

__all__ = [
    "COARSEST",
    "LEAST_GRIDS",
    "SMALLEST_GRID",
    "Ends",
    "Material",
    "Measured",
    "Method",
    "Problem",
    "Solution",
    "SolveError",
    "error_of_finest",
    "grid_convergence_index",
    "jump_stands",
    "largest_explicit_step",
    "measure_refined",
    "second_critical_slope",
    "solve",
    "solve_refined",
    "solve_refined_each",
]
