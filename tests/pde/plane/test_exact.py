"""The solver on a plane against exact solutions."""

import math

import numpy as np
import pytest

from bcre_pde import exact as line
from bcre_pde.plane import Material, exact, solve

FREE = Material(1.0, 0.0, 0.0, 0.5, 0.5, kappa_x=0.1, kappa_y=0.2)
K_X, K_Y = 2 * math.pi / 10, 2 * math.pi / 6
CASES = {
    "gaussian": exact.frozen_slope_release(2.0, Material(1.0, 0.2, 0.1, 0.05, 0.5)),
    "between closed sides": exact.frozen_slope_release(
        2.0, Material(1.0, 0.2, 0.4, 0.05, 0.5), "closed"
    ),
    "rolling mode": exact.oblique_rolling_mode(K_X, K_Y, Material(1.0, 0.2, 0.3, 0.5, 0.5), 4.0),
    "surface mode": exact.oblique_surface_mode(K_X, K_Y, FREE, 4.0),
    "oblique climbing wave": exact.oblique_climbing_wave(1.0, 0.5, 0.3, 3.0, 20.0, 12.0, 2.0),
    "climbing wave": exact.extruded(line.climbing_hump(1.0, 0.5, 0.3, 1.5, 20.0, 2.0), 9.0, 0.3),
    "steady filling": exact.extruded(line.steady_filling(0.05, 1.0, 0.1), 9.0, 0.3),
    "tilted climbing wave": exact.extruded(
        line.tilted_climbing_wave(0.2, 1.0, 0.5, 0.3, 3.0), 9.0, 0.3
    ),
}


def relative_error(case, cells):
    solution = solve(case.problem, [case.until], cells, 1e-10)
    x, y = np.meshgrid(solution.x, solution.y, indexing="ij")
    _, R = case.layers(x, y, case.until)
    inside = (solution.x > case.window[0]) & (solution.x < case.window[1])
    spread = np.abs(R - R.mean())[inside].mean()
    return np.abs(solution.R[0] - R)[inside].mean() / spread


@pytest.mark.parametrize(
    ("case", "finest"),
    [
        ("gaussian", 3.5e-6),
        ("between closed sides", 4e-6),
        ("rolling mode", 5e-9),
        ("oblique climbing wave", 1e-5),
        ("climbing wave", 1e-5),
    ],
)
def test_order_on_a_plane_is_at_least_four_and_a_half(case, finest):
    grids = [(40, 24), (80, 48), (160, 96)]
    errors = [relative_error(CASES[case], cells) for cells in grids]
    order = -np.polyfit(np.log([rows for rows, _ in grids]), np.log(errors), 1)[0]
    assert order > 4.5
    assert errors[-1] < finest


@pytest.mark.parametrize(
    ("case", "rows", "error"),
    [
        ("surface mode", 80, 2e-7),
        ("steady filling", 80, 3e-5),
        ("tilted climbing wave", 200, 5e-4),
    ],
)
def test_solver_converges_to_the_exact_solution(case, rows, error):
    coarse, fine = (relative_error(CASES[case], (n, n // 8)) for n in (rows // 2, rows))
    if case == "surface mode":
        fine = relative_error(CASES[case], (rows, rows * 6 // 10))
    assert fine < error
    assert fine < coarse / 16 or fine < 1e-9


@pytest.mark.parametrize("name", list(CASES))
def test_exact_solution_obeys_the_differential_equations(name):
    """Fourth-order differences of the closed form, at some places inside its window."""
    case = CASES[name]
    m = case.material
    x, y = np.meshgrid(np.linspace(*case.window, 7)[1:-1], [0.7, 2.9], indexing="ij")
    t, step = 0.6 * case.until, 0.02

    def layers(dx=0.0, dy=0.0, dt=0.0):
        h, R = case.layers(x + dx, y + dy, t + dt)
        return np.array([h + m.Sc * (x + dx), R])

    def first(f):
        return (8 * (f(step) - f(-step)) - (f(2 * step) - f(-2 * step))) / (12 * step)

    def second(f):
        near, far = f(step) + f(-step), f(2 * step) + f(-2 * step)
        return (16 * near - far - 30 * f(0)) / (12 * step**2)

    u, R = layers()
    u_t, R_t = first(lambda s: layers(dt=s))
    u_x, R_x = first(lambda s: layers(dx=s))
    (u_xx, R_xx), (u_yy, R_yy) = (
        second(lambda s, axis=axis: layers(**{axis: s})) for axis in ("dx", "dy")
    )
    E = -R * (m.gamma * u_x + m.kappa_x * u_xx + m.kappa_y * u_yy)
    size = np.abs(E).max() + np.abs(m.v * R_x).max()
    height = 1e-15 * np.abs(case.layers(x, y, t)[0]).max() + 1e-15 * np.abs(u).max()
    kappa = m.kappa_x + m.kappa_y
    rounding = height / step * (1 + R.max() * (m.gamma + kappa / step))
    assert np.abs(u_t + E).max() < 1e-5 * size + rounding
    residual = R_t + m.v * R_x - m.D_x * R_xx - m.D_y * R_yy - E
    floor = min(rounding, 1e-14 * R.max() / step**2)
    assert np.abs(residual).max() < 1e-5 * size + floor
