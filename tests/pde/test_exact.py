import math

import numpy as np
import pytest
import sympy as sp

from bcre_pde import Material, exact, solve

GAMMA, LENGTH, UNTIL = 0.5, 20.0, 2.0
HUMP = exact.climbing_hump(1.0, GAMMA, 0.3, 1.5, LENGTH, UNTIL)


THICK = Material(1.0, 0.0, GAMMA, 0.5, v_up=0.8, Gamma=0.7)


def error(cells, tolerance=1e-12):
    """Of R, and of h apart from its mean."""
    solution = solve(HUMP.problem, [UNTIL], cells, tolerance=tolerance)
    h, R = HUMP.layers(solution.x, UNTIL)
    gap = solution.h[-1] - h
    return np.abs(solution.R[-1] - R).mean(), np.abs(gap - gap.mean()).mean()


def test_order_of_pde_on_the_climbing_wave_is_at_least_four_and_a_half():
    cells = [100, 200, 400, 800]
    errors = np.array([error(n) for n in cells])
    orders = -np.polyfit(np.log(cells), np.log(errors), 1)[0]
    assert (orders > 4.5).all()
    assert errors[2, 0] < 2.6e-8
    assert errors[3, 0] < 1.1e-9


def test_error_at_400_cells_and_default_tolerance_is_far_below_a_millionth():
    assert max(error(400, 1e-6)) < 1e-7


def test_invariant_is_carried_at_the_drift_speed():
    """w = R + u + (v/gamma) ln R obeys w_t + v w_x = 0 wherever D = kappa = 0."""
    x, t, v, gamma = sp.symbols("x t v gamma", positive=True)
    u, R = sp.Function("u")(x, t), sp.Function("R")(x, t)
    w = R + u + v / gamma * sp.log(R)
    u_t = gamma * R * u.diff(x)
    R_t = -v * R.diff(x) - gamma * R * u.diff(x)
    carried = (w.diff(t) + v * w.diff(x)).subs({R.diff(t): R_t, u.diff(t): u_t})
    assert sp.simplify(carried) == 0


CASES = {
    "rolling_mode": lambda: exact.rolling_mode(2 * math.pi / 10, v=1.0, D=0.2),
    "surface_mode": lambda: exact.surface_mode(2 * math.pi / 10, gamma=0.5, kappa=0.1, v=1.0),
    "frozen_slope_release": lambda: exact.frozen_slope_release(2.0, v=1.0, D=0.5, gamma=0.05),
    "climbing_hump": lambda: HUMP,
    "thick_climbing_hump": lambda: exact.simple_wave_of_hump(THICK, 0.3, 1.5, LENGTH, UNTIL),
    "tilted_climbing_wave": lambda: exact.tilted_climbing_wave(0.2, 1.0, 0.5, 0.3, 3.0),
    "steady_filling": lambda: exact.steady_filling(0.05, 1.0, 0.1),
    "saturated_flow": lambda: exact.saturated_flow(0.25, 0.4, v=1.3, v_up=0.6),
}


@pytest.mark.parametrize("case", list(CASES))
def test_exact_solution_obeys_the_differential_equations(case):
    """Fourth-order differences of the closed form, at five places inside its window."""
    solution = CASES[case]()
    material = solution.material
    x = np.linspace(*solution.window, 7)[1:-1]
    t, step = 0.6 * solution.until, 0.02

    def layers(place, time):
        h, R = solution.layers(place, time)
        return np.array([h + material.Sc * place, R])

    def first(f):
        return (8 * (f(step) - f(-step)) - (f(2 * step) - f(-2 * step))) / (12 * step)

    def second(f):
        return (16 * (f(step) + f(-step)) - (f(2 * step) + f(-2 * step)) - 30 * f(0)) / (
            12 * step**2
        )

    u, R = layers(x, t)
    u_t, R_t = first(lambda s: layers(x, t + s))
    u_x, R_x = first(lambda s: layers(x + s, t))
    u_xx, R_xx = second(lambda s: layers(x + s, t))
    exchanging = R / (1 + material.gamma * R / material.v_up)
    E = -exchanging * (material.gamma * u_x + material.kappa * u_xx)
    size = np.abs(E).max() + np.abs(material.v * R_x).max()
    height = 1e-15 * np.abs(solution.layers(x, t)[0]).max() + 1e-15 * np.abs(u).max()
    rounding = height / step * (1 + exchanging.max() * (material.gamma + material.kappa / step))
    assert np.abs(u_t + E).max() < 1e-5 * size + rounding
    drift = material.v + material.Gamma * R
    residual = R_t + drift * R_x - material.D * R_xx - E
    assert np.abs(residual).max() < 1e-5 * size + min(rounding, 1e-14 * R.max() / step**2)


@pytest.mark.parametrize("case", list(CASES))
def test_solver_converges_to_the_exact_solution(case):
    solution = CASES[case]()
    errors = []
    for cells in (100, 200):
        found = solve(solution.problem, [solution.until], cells, tolerance=1e-12)
        inside = (found.x > solution.window[0]) & (found.x < solution.window[1])
        _, R = solution.layers(found.x, solution.until)
        errors.append(np.abs(found.R[-1] - R)[inside].mean())
    scale = np.abs(R[inside] - R[inside].mean()).mean()
    assert errors[1] < 1e-3 * scale + solution.floor
    assert errors[1] < errors[0] / 16 or errors[1] < max(1e-9 * scale, solution.floor)
