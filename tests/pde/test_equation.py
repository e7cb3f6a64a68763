import math
import subprocess
import sys

import numpy as np
import pytest
from pde import CartesianGrid

from bcre_pde import (
    Material,
    Problem,
    SolveError,
    largest_explicit_step,
    solve,
    solve_refined,
)
from bcre_pde.equation import BCRE, coefficients
from bcre_pde.explicit import FEHLBERG
from bcre_pde.line import fluxes
from bcre_pde.line.marched import MarchedOnLine

MATERIAL = {"v": 1.0, "D": 0.2, "gamma": 0.3, "Sc": 0.5, "kappa": 0.1}
CLASSICAL = np.diag([0.5, 0.5, 1.0], -1), np.array([1, 2, 2, 1]) / 6


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
    """Rounding-size noise on a uniform layer must not grow in steps of a method of order 4."""
    material, noise = Material(**(MATERIAL | changes)), 1e-9
    u, ripple = noise * np.random.default_rng(1).uniform(-1, 1, (2, 40))
    dt = largest_explicit_step(material, 0.5, largest_R)
    for increments, weights in (CLASSICAL, FEHLBERG[:2]):
        layers = np.array([u, largest_R + ripple, np.zeros(40)])
        bcre = coefficients(material, 0.5, True)
        fluxes.march(layers, dt, 200, increments, weights, *bcre)
        assert np.abs(layers[0]).max() < 10 * noise
        assert np.abs(layers[1] - largest_R).max() < 10 * noise


def test_equation_that_moves_nothing_has_no_largest_step():
    assert largest_explicit_step(Material(0.0, 0.0, 0.0, 0.5), 1.0, 9.0) == math.inf
    grid = BCRE.grid(20.0, 40, "open")
    equation = BCRE(Material(**MATERIAL), grid)
    assert equation.largest_explicit_step(9.0) == largest_explicit_step(
        Material(**MATERIAL), 0.5, 9.0
    )


class Carried(MarchedOnLine):
    """dR/dt + v dR/dx = 0, dh/dt = 0 by upwind differences: a model of a few lines."""

    def rate(self, layers, out):
        R = layers[1]
        before = np.roll(R, 1)
        if not self.periodic:
            before[0] = 0.0
        out[...] = 0.0
        out[1] = -self.material.v * (R - before) / self.dx
        if not self.periodic:
            out[2, -1] = self.material.v * R[-1] / (self.cells * self.dx)

    def largest_explicit_step(self, largest_R):
        return self.dx / self.material.v


@pytest.mark.parametrize("ends", ["open", "periodic"])
@pytest.mark.parametrize("method", ["runge-kutta", "RK45", "BDF"])
def test_another_model_is_solved_like_bcre(method, ends):
    """Its layer moves by 4 and keeps its area, and its surface stays as it is."""

    def initial(x):
        return 3 - 0.4 * x, np.exp(-(((x - 10) / 3) ** 2))

    problem = Problem(initial, Material(**MATERIAL), 40.0, ends)
    solution = solve(problem, [0.0, 4.0], 200, method, equation=Carried)
    mass = solution.mass() + solution.outflow
    assert mass == pytest.approx(np.full(2, mass[0]), rel=1e-12)
    assert np.ptp(solution.u, axis=0).max() < 1e-13
    centres = solution.R @ solution.x / solution.R.sum(axis=1)
    assert np.diff(centres)[0] == pytest.approx(4.0, rel=1e-4)
    refined = solve_refined(
        problem, [4.0], lambda s: s.R[-1].max(), lambda value: 0.1, 50, equation=Carried
    )
    assert refined.order == pytest.approx(1, abs=0.3)


def test_failure_of_another_model_names_its_cell():
    class Broken(Carried):
        def rate(self, layers, out):
            super().rate(layers, out)
            out[1, 7] = math.nan

    problem = Problem(lambda x: (-0.5 * x, np.ones_like(x)), Material(**MATERIAL), 10.0)
    with pytest.raises(SolveError, match=r"in cell 7 \(x = 3.75\)"):
        solve(problem, [1.0], 20, equation=Broken)


LIGHT = """
import sys, bcre_pde, bcre_pde.exact, bcre_pde.explicit, bcre_pde.fixed_step, bcre_pde.theory
bcre_pde.Problem(lambda x: (x, x), bcre_pde.Material(0.1, 0.1, 0.01, 0.5), 100.0)
bcre_pde.theory.stable(0.1, 0.1, 0.1, "runge-kutta")
print(*{"pde", "numba", "pandas", "matplotlib"} & set(sys.modules))
"""


def test_what_needs_no_solver_imports_neither_py_pde_nor_numba():
    loaded = subprocess.run(
        [sys.executable, "-c", LIGHT], capture_output=True, check=True, text=True
    )
    assert loaded.stdout.split() == []
