r"""BCRE as py-pde's documentation has its users write equations: expressions in ``PDE({...})``.

    u_t = R (gamma u_x + kappa u_xx)        R_t = -v R_x + D R_xx - R (gamma u_x + kappa u_xx)

"central"  central differences; adaptive Euler steps, as py-pde chooses where no dt is given
"upwind"   R_x backward and u_x forward, in Euler steps of a fixed dt: with kappa = 0 this is the
           automaton's own scheme

Open ends: the upwind scheme's are the automaton's own, as py-pde takes conditions operator by
operator: through the top nothing drifts (R = 0 in the cell before it) nor diffuses; beyond the
foot R and u go on as they are. The central scheme's are v R = D R_x and u_xx = 0 at the top,
R_x = 0 and u_x = 0 at the foot, all to second order. What is approximated is the balance of
mass: its drift is not a difference of fluxes, so that sand crosses an end to the error of the
scheme wherever it rolls there. Where R rolls off zero it undershoots, as central schemes do.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

import numpy as np
from pde import PDE, CartesianGrid, FieldCollection, ScalarField
from pde.solvers import EulerSolver

from bcre_pde import Problem
from bcre_studies.performance.rivals.rivals import (
    Array,
    EndState,
    Solve,
    centres,
    start_above_repose,
    whole_steps,
)

Scheme = Literal["central", "upwind"]

FIRST_DT = 1e-3
"""py-pde's own first step where none is given."""


def solve(problem: Problem, until: float, cells: int, dt: float | None = None) -> EndState:
    """``PDE.solve`` as a user calls it: the equation is compiled again at every call.

    Parameters
    ----------
    dt: the step of the upwind scheme, which must divide ``until``; left out, the central scheme
        in adaptive steps at py-pde's default tolerance.
    """
    equation, state = _equation(problem, cells, dt)
    if dt is not None:
        whole_steps(until, dt)
    end, info = equation.solve(
        state, until, dt=dt, backend="numba", solver="euler", tracker=None, ret_info=True
    )
    return _end_state(problem, end, info["solver"]["steps"])


def prepare(
    problem: Problem,
    until: float,
    cells: int,
    dt: float | None = None,
    tolerance: float = 1e-4,
) -> Solve:
    """The same, but the compiled stepper of the first call is kept for the later ones.

    Parameters
    ----------
    dt: as in :func:`solve`.
    tolerance: absolute local error per step of the adaptive solver; the default is py-pde's.
    """
    if dt is not None:
        whole_steps(until, dt)
    kept: list[tuple[EulerSolver, FieldCollection, Array, Callable[..., float]]] = []

    def solve_kept() -> EndState:
        if not kept:
            equation, state = _equation(problem, cells, dt)
            solver = EulerSolver(
                equation, backend="numba", adaptive=dt is None, tolerance=tolerance
            )
            stepper = solver.make_stepper(state, dt=FIRST_DT if dt is None else dt)
            kept.append((solver, state, state.data.copy(), stepper))
        solver, state, initial, stepper = kept[0]
        state.data[...] = initial
        solver.info["dt"], solver.info["steps"] = FIRST_DT if dt is None else dt, 0
        stepper(state, 0.0, until)
        return _end_state(problem, state, solver.info["steps"])

    return solve_kept


def _equation(problem: Problem, cells: int, dt: float | None) -> tuple[PDE, FieldCollection]:
    periodic = problem.ends == "periodic"
    grid = CartesianGrid([[0.0, problem.length]], cells, periodic=periodic)
    u, R = start_above_repose(problem, centres(problem, cells))
    state = FieldCollection([ScalarField(grid, u, label="u"), ScalarField(grid, R, label="R")])
    scheme: Scheme = "central" if dt is None else "upwind"
    return PDE(_expressions(problem, scheme), **_conditions(problem, scheme)), state


def _expressions(problem: Problem, scheme: Scheme) -> dict[str, str]:
    material = problem.material
    R_x, u_x = "d_dx(R)", "d_dx(u)"
    if scheme == "upwind":
        R_x, u_x = "d_dx_backward(R)", "d_dx_forward(u)"
    elif problem.ends == "open":
        # The same central difference, but with conditions of its own: they go by operator.
        u_x = "(d_dx_forward(u) + d_dx_backward(u)) / 2"
    settled = f"{material.gamma!r} * R * {u_x}"
    if material.kappa > 0:
        settled += f" + {material.kappa!r} * R * d2_dx2(u)"
    return {
        "u": settled,
        "R": f"{material.D!r} * laplace(R) - {material.v!r} * {R_x} - ({settled})",
    }


def _conditions(problem: Problem, scheme: Scheme) -> dict[str, Any]:
    """Conditions at the ends by operator: ``laplace`` acts on R only, ``d2_dx2`` on u only."""
    if problem.ends == "periodic":
        return {"bc": "periodic"}
    material = problem.material
    level = {"derivative": 0}
    surface = {"x-": {"curvature": 0}, "x+": level}
    if scheme == "upwind":
        drift = {"x-": {"virtual_point": "0"}, "x+": level}
        by_operator = {"d_dx_backward": drift, "d2_dx2": surface}
    else:
        no_flux: dict[str, object] = {"value": 0}
        if material.D > 0:
            no_flux = {"type": "mixed", "value": material.v / material.D, "const": 0}
        rolling = {"x-": no_flux, "x+": level}
        by_operator = {
            "d_dx": rolling,
            "laplace": rolling,
            "d_dx_backward": surface,
            "d2_dx2": surface,
        }
    return {"bc": level, "bc_ops": {f"*:{name}": ends for name, ends in by_operator.items()}}


def _end_state(problem: Problem, state: FieldCollection, steps: int) -> EndState:
    x = np.array(state.grid.cell_coords[:, 0])
    u, R = state.data.copy()
    return EndState(x, u - problem.material.Sc * x, R, int(steps), int(steps))
