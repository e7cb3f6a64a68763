import math

import numpy as np
import pytest
from pde import CartesianGrid
from pde.solvers import RungeKuttaSolver
from scipy import integrate

from bcre_pde import Material
from bcre_pde.bounded import BoundedRungeKutta, layer_scale
from bcre_pde.equation import BCRE
from bcre_pde.explicit import FEHLBERG, FEHLBERG_ERROR, Step, tableau

LENGTH, CELLS = 20.0, 50
METHODS = ["runge-kutta", "RK45", "DOP853"]


def start(periodic=False):
    grid = CartesianGrid([[0, LENGTH]], CELLS, periodic=periodic)
    x = grid.cell_coords[:, 0]
    state = BCRE.state(grid, 0.3 * (LENGTH - x), np.exp(-(((x - 8) / 2) ** 2)), 0.0)
    return BCRE(Material(1.0, 0.2, 0.3, 0.5, 0.05), grid), state


@pytest.mark.parametrize("method", METHODS)
def test_stages_stand_at_the_sums_of_their_rows_and_the_weights_sum_to_one(method):
    a, b, c = tableau(method)
    assert np.array_equal(a, np.tril(a, -1))
    assert a.sum(axis=1) == pytest.approx(c, abs=1e-14)
    assert b.sum() == pytest.approx(1, abs=1e-14)


def test_fehlberg_error_is_the_fifth_order_formula_less_the_fourth_order_one():
    a, b, c = FEHLBERG
    fifth = b + FEHLBERG_ERROR
    for power in range(5):
        assert fifth @ c**power == pytest.approx(1 / (power + 1), abs=1e-14)
    assert fifth @ (a @ (a @ (a @ c))) == pytest.approx(1 / 120, abs=1e-14)
    assert abs(b @ c**4 - 1 / 5) > 1e-4


def test_implicit_method_has_no_explicit_coefficients():
    with pytest.raises(ValueError, match=r"^method = 'LSODA': must be explicit"):
        tableau("LSODA")


@pytest.mark.parametrize("dt", [1e-3, 0.05, 0.5])
def test_step_and_its_error_are_those_of_py_pde_to_the_bit(dt):
    equation, state = start()
    solver = BoundedRungeKutta(equation, dt_max=1.0, dt_min=1e-10, tolerance=1e-6)
    solver._select_backend(state)
    theirs = RungeKuttaSolver._make_single_step_error_estimate(solver, state)
    ours = solver._make_single_step_error_estimate(state)
    layers = state.data.copy()
    for _ in range(5):
        expected, error = theirs(layers, 0.0, dt)
        found, relative = ours(layers, 0.0, dt)
        assert np.array_equal(found, expected)
        assert relative == error / layer_scale(expected[1])
        layers = expected


@pytest.mark.parametrize("method", ["RK45", "DOP853"])
def test_step_is_the_one_scipy_takes(method):
    equation, state = start()
    dt = 0.05

    def rate(_, flat):
        out = np.empty_like(state.data)
        equation.write_rate(flat.reshape(out.shape), out)
        return out.ravel()

    loose = {"rtol": 1e3, "atol": 1e3}  # so that the first step is accepted as it is
    solver = getattr(integrate, method)(rate, 0.0, state.data.ravel(), 1.0, first_step=dt, **loose)
    solver.step()
    assert solver.t == dt
    found = np.empty_like(state.data)
    Step(equation, tableau(method))(state.data, 0.0, dt, found)
    assert found.ravel() == pytest.approx(solver.y, rel=1e-13, abs=1e-14)


def test_step_that_meets_no_number_has_no_error_estimate():
    equation, state = start()
    solver = BoundedRungeKutta(equation, dt_max=1.0, dt_min=1e-10, tolerance=1e-6)
    state.data[1, 7] = math.nan
    _, error = solver._make_single_step_error_estimate(state)(state.data, 0.0, 0.1)
    assert math.isnan(error)


def test_scale_of_errors_is_the_largest_layer_or_one():
    assert layer_scale(np.array([0.0, -3.0, 1.0])) == 3.0
    assert layer_scale(np.zeros(4)) == 1.0
