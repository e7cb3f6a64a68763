import numba
import numpy as np
import pytest
from pde import PDE, CartesianGrid, FieldCollection, ScalarField

from bcre_pde import Material, Problem, solve

LENGTH, UNTIL = 20.0, 2.0
V, D, GAMMA, KAPPA, SC = 1.0, 0.2, 0.3, 0.1, 0.5


def start(x):
    k = 2 * np.pi / LENGTH
    u = 0.3 * np.sin(k * x) + 0.1 * np.cos(2 * k * x)
    return u - SC * x, 1 + 0.4 * np.cos(k * x + 0.3)


def by_expressions(cells):
    """u and R at the end by py-pde's own central differences of second order."""
    grid = CartesianGrid([[0, LENGTH]], cells, periodic=True)
    x = grid.cell_coords[:, 0]
    h, R = start(x)
    gain = f"R * ({GAMMA} * d_dx(u) + {KAPPA} * d2_dx2(u))"
    equation = PDE({"u": gain, "R": f"{D} * d2_dx2(R) - {V} * d_dx(R) - {gain}"})
    state = FieldCollection([ScalarField(grid, h + SC * x), ScalarField(grid, R)])
    end = equation.solve(
        state,
        UNTIL,
        solver="scipy",
        method="DOP853",
        rtol=1e-9,
        atol=1e-10,
        backend="numpy",
        tracker=None,
    )
    return end.data


@pytest.mark.parametrize("method", ["runge-kutta", "LSODA"])
def test_py_pdes_own_expressions_converge_to_our_solution_at_second_order(monkeypatch, method):
    cells = [25, 50, 100]
    problem = Problem(start, Material(V, D, GAMMA, SC, KAPPA), LENGTH, "periodic")
    ours = [solve(problem, [UNTIL], n, method, 1e-9) for n in cells]
    # Without this py-pde compiles its operators for every grid, which takes 5 s each.
    monkeypatch.setattr(numba.config, "DISABLE_JIT", True)
    gaps = []
    for solution, n in zip(ours, cells, strict=True):
        u, R = by_expressions(n)
        gaps.append([np.abs(u - solution.u[0]).mean(), np.abs(R - solution.R[0]).mean()])
    orders = np.log2(np.array(gaps[:-1]) / np.array(gaps[1:]))
    assert orders == pytest.approx(np.full((2, 2), 2.0), abs=0.1)
    assert max(gaps[-1]) < 2e-4
