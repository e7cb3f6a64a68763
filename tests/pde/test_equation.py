import math

import numpy as np
import pytest
from pde import CartesianGrid

from bcre_pde import BCRE, Material

MATERIAL = {"v": 1.0, "D": 0.2, "gamma": 0.3, "Sc": 0.5, "kappa": 0.1}


@pytest.mark.parametrize("name", ["v", "D", "gamma", "Sc", "kappa"])
@pytest.mark.parametrize("value", [-0.1, math.nan, math.inf])
def test_coefficients_must_be_finite_and_not_negative(name, value):
    with pytest.raises(ValueError, match=rf"^{name} = {value!r}: must be a finite number >= 0$"):
        Material(**(MATERIAL | {name: value}))


def test_curvature_term_is_left_out_unless_asked_for():
    assert Material(1.0, 0.2, 0.3, 0.5).kappa == 0.0
    assert Material(1.0, 0.2, 0.3, 0.5).v_up == float("inf")


@pytest.mark.parametrize("value", [0.0, -1.0, float("nan")])
def test_material_refuses_a_climbing_speed_that_is_not_positive(value):
    with pytest.raises(ValueError, match=r"v_up = .*must be > 0"):
        Material(**MATERIAL, v_up=value)


def test_grid_must_hold_the_widest_stencil():
    with pytest.raises(ValueError, match=r"^cells = 7: BCRE needs at least 8 cells"):
        BCRE(Material(**MATERIAL), CartesianGrid([[0, 1]], 7))


@pytest.mark.parametrize("periodic", [True, False])
def test_evolution_rate_is_the_equation(periodic):
    """At smooth data and away from open ends, to the error of 200 cells."""
    grid = CartesianGrid([[0, 2 * math.pi]], 200, periodic=periodic)
    x = grid.cell_coords[:, 0]
    equation = BCRE(Material(**MATERIAL), grid)
    u, R = np.sin(x), 2 + np.cos(x)
    out = equation.evolution_rate(BCRE.state(grid, u, R, u_foot=0.0))
    E = -R * (0.3 * np.cos(x) - 0.1 * np.sin(x))
    dR = np.sin(x) - 0.2 * np.cos(x) + E
    inner = slice(None) if periodic else slice(3, -3)
    assert out[0].data[inner] == pytest.approx(-E[inner], abs=1e-7)
    assert out[1].data[inner] == pytest.approx(dR[inner], abs=1e-7)


def test_evolution_rate_leaves_the_state_alone_and_is_counted():
    grid = CartesianGrid([[0, 10]], 16)
    equation = BCRE(Material(**MATERIAL), grid)
    rng = np.random.default_rng(0)
    state = BCRE.state(grid, rng.uniform(-1, 1, 16), rng.uniform(0, 1, 16), 0.3)
    before = state.data.copy()
    equation.evolution_rate(state)
    equation.evolution_rate(state)
    assert np.array_equal(state.data, before)
    assert equation.evaluations == 2


@pytest.mark.parametrize(
    ("changes", "largest_R"),
    [({"D": 0.0, "kappa": 0.0}, 1.0), ({"v": 0.01}, 1.0), ({"v": 0.0}, 40.0), ({}, 10.0)],
)
def test_largest_explicit_step_keeps_every_small_wave_stable(changes, largest_R):
    """Rounding-size noise on a uniform layer must not grow in classical Runge-Kutta steps."""
    material = Material(**(MATERIAL | changes))
    grid = CartesianGrid([[0, 20]], 40, periodic=True)
    equation = BCRE(material, grid)
    dt = equation.largest_explicit_step(largest_R)
    rng = np.random.default_rng(1)
    noise = 1e-9
    state = BCRE.state(
        grid, noise * rng.uniform(-1, 1, 40), largest_R + noise * rng.uniform(-1, 1, 40)
    )

    def slope(data):
        probe = state.copy()
        probe.data[...] = data
        return equation.evolution_rate(probe).data.copy()

    y = state.data.copy()
    for _ in range(200):
        k1 = slope(y)
        k2 = slope(y + dt / 2 * k1)
        k3 = slope(y + dt / 2 * k2)
        k4 = slope(y + dt * k3)
        y = y + dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    assert np.abs(y[0]).max() < 10 * noise
    assert np.abs(y[1] - largest_R).max() < 10 * noise


def test_equation_that_moves_nothing_has_no_largest_step():
    grid = CartesianGrid([[0, 1]], 8)
    assert BCRE(Material(0.0, 0.0, 0.0, 0.5), grid).largest_explicit_step(9.0) == math.inf
