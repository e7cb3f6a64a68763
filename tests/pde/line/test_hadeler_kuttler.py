"""Hadeler and Kuttler's model: exact solutions, orders, silos, heaps."""

import math

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from bcre_pde import Material, Problem, solve
from bcre_pde.equation import BCRE
from bcre_pde.line import hadeler_kuttler as hk
from bcre_pde.source import Source

M = hk.SlopeDriven(beta=0.9, gamma=0.35, Sc=0.45)


def found(material, initial, length, ends, times, cells, sources=(), tolerance=1e-6):
    problem = Problem(initial, material, length, ends, sources)
    return solve(problem, times, cells, tolerance=tolerance, equation=hk.HadelerKuttler)


def slope(solution, at):
    """S between the cells around a place."""
    S = -np.diff(solution.h[-1]) / solution.dx
    return np.interp(at, solution.x[:-1] + solution.dx / 2, S)


def test_exponential_slope_and_silo_obey_the_equations():
    x, t, R0, A, L, w = sp.symbols("x t R0 A L w", positive=True)
    beta, gamma, Sc = sp.symbols("beta gamma Sc", positive=True)
    s = A * sp.exp(gamma / beta * (x + gamma * R0 * t))
    h = -Sc * x - sp.integrate(s, x)
    E = gamma * R0 * s
    assert sp.simplify(h.diff(t) + E) == 0
    assert sp.simplify(sp.diff(beta * R0 * (Sc + s), x) - E) == 0
    S = Sc * (L - x) / (L - x + beta / gamma)
    R = w * (L - x + beta / gamma) / (beta * Sc)
    assert sp.simplify(gamma * R * (S - Sc) + w) == 0
    assert sp.simplify(sp.diff(beta * R * S, x) + w) == 0
    place, length = 3.0, 8.0
    values = {beta: M.beta, gamma: M.gamma, Sc: M.Sc, x: place, L: length, w: 0.2}
    assert hk.silo_slope(place, M, length) == pytest.approx(float(S.subs(values)), rel=1e-14)
    assert hk.silo_layer(place, M, length, 0.2) == pytest.approx(float(R.subs(values)), rel=1e-14)


def test_order_of_pde_on_the_exponential_slope_is_at_least_four():
    """In a window that the ends, whose influence moves at beta S and gamma R0, have not reached."""
    R0, A, rate, length, until = 0.8, 1e-3, M.gamma / M.beta, 16.0, 2.0

    def surface(x, t):
        return -A / rate * np.exp(rate * (x + M.gamma * R0 * t))

    def initial(x):
        return surface(x, 0.0) - M.Sc * x, np.full_like(x, R0)

    errors, cells = [], [50, 100, 200]
    for n in cells:
        solution = found(M, initial, length, "open", [until], n, tolerance=1e-10)
        inside = (solution.x > 6) & (solution.x < 10)
        u = solution.u[-1] - surface(solution.x, until)
        errors.append([np.abs(solution.R[-1] - R0)[inside].max(), np.ptp(u[inside])])
    orders = -np.polyfit(np.log(cells), np.log(errors), 1)[0]
    assert (orders > 4.5).all()
    assert np.max(errors[-1]) < 1e-8


@pytest.mark.parametrize(("w", "length"), [(0.1, 10.0), (0.05, 7.0)])
def test_silo_fills_at_its_closed_form_to_within_a_hundredth(w, length):
    source = Source(w * length, 0.025 * length, 0.05 * length)
    solution = found(
        M, lambda x: (0 * x, 0 * x), length, "wall", [0.0, 2400 / length], 100, (source,)
    )
    at = np.array([0.5, 0.95]) * length
    assert slope(solution, at) == pytest.approx(hk.silo_slope(at, M, length), rel=1e-2)
    R = np.interp(at, solution.x, solution.R[-1])
    assert pytest.approx(hk.silo_layer(at, M, length, w), rel=1e-2) == R
    balance = solution.mass() - solution.inflow - solution.mass()[0]
    assert np.abs(balance).max() <= 1e-12 * solution.inflow[-1]


@pytest.mark.parametrize("cells", [60, 150])
def test_floor_is_covered_on_every_grid_without_waves_of_a_few_cells(cells):
    """Sand spreads over a bare, level floor: a front, behind which the layer stays smooth."""
    material, length = hk.SlopeDriven(1.0, 0.35, 0.45), 7.0
    source = Source(0.35, 0.2, 0.4)
    solution = found(
        material, lambda x: (0 * x, 0 * x), length, "wall", [20.0, 60.0], cells, (source,)
    )
    assert solution.R.min() > -1e-12
    settled = solution.R[-1][solution.x > 0.5]
    assert np.abs(np.diff(settled, 2)).max() < 0.02 * settled.max()


@given(seed=st.integers(0, 1000), walled=st.booleans())
def test_what_leaves_one_cell_enters_the_next(seed, walled):
    rng = np.random.default_rng(seed)
    grid = hk.HadelerKuttler.grid(10.0, 21, "open")
    equation = hk.HadelerKuttler(M, grid, walled=walled)
    out = np.empty((3, 21))
    layers = np.array([rng.uniform(-3, 3, 21), rng.uniform(0, 1, 21), np.zeros(21)])
    equation.rate(layers, out)
    outflow = out[2, -1] * 10.0
    assert equation.dx * out[:2].sum() + outflow == pytest.approx(0, abs=1e-12 * np.abs(out).max())
    assert (outflow == 0) or not walled


def test_heap_in_the_middle_is_two_silos_back_to_back():
    length = 12.0
    solution = found(
        M, lambda x: (0 * x, 0 * x), length, "wall", [0.0, 200.0], 60, (Source(0.6, 6.0, 0.8),)
    )
    assert solution.h[-1] == pytest.approx(solution.h[-1][::-1], abs=1e-6)
    assert solution.R[-1] == pytest.approx(solution.R[-1][::-1], abs=1e-6)
    assert slope(solution, 8.0) == pytest.approx(hk.silo_slope(2.0, M, 6.0), rel=1e-2)
    assert slope(solution, 4.0) == pytest.approx(-hk.silo_slope(2.0, M, 6.0), rel=1e-2)


def test_right_hand_side_is_that_of_bcre_where_the_speed_is_the_same_everywhere():
    """On an even slope beta S = v: R is carried, spread and grown as in BCRE, to rounding."""
    S, v, D = 0.8, 0.6, 0.07
    grid = BCRE.grid(10.0, 40, "periodic")
    x = grid.cell_coords[:, 0]
    R = 1 + 0.3 * np.sin(2 * math.pi * x / 10)
    u = (M.Sc - S) * x
    layers, out, expected = np.array([u, R, 0 * R]), np.empty((3, 40)), np.empty((3, 40))
    slow = hk.SlopeDriven(v / S, M.gamma, M.Sc, D)
    hk.HadelerKuttler(slow, grid).rate(layers, out)
    BCRE(Material(v, D, M.gamma, M.Sc), grid).rate(layers, expected)
    inside = slice(7, -7)  # beyond which u is not even where the ends are joined
    assert out[:2, inside] == pytest.approx(expected[:2, inside], rel=1e-12, abs=1e-13)


def test_small_waves_move_at_the_speeds_of_the_module():
    R, S, beta, gamma, Sc = sp.symbols("R S beta gamma Sc", positive=True)
    # R_t = -beta (R S)_x, S_t = (gamma R (S - Sc))_x, as a matrix of R_x and S_x
    matrix = sp.Matrix([[-beta * S, -beta * R], [gamma * (S - Sc), gamma * R]])
    c = sp.symbols("c")
    root = sp.sqrt((gamma * R - beta * S) ** 2 + 4 * beta * gamma * R * Sc)
    expected = sp.expand(
        (c - (beta * S - gamma * R + root) / 2) * (c - (beta * S - gamma * R - root) / 2)
    )
    assert sp.simplify((c * sp.eye(2) + matrix).det() - expected) == 0


@given(
    beta=st.floats(0.01, 2), gamma=st.floats(0.01, 2), Sc=st.floats(0.05, 2), D=st.floats(1e-3, 5)
)
def test_ends_of_the_band_are_where_growth_and_drift_balance(beta, gamma, Sc, D):
    band = hk.critical_slopes(hk.SlopeDriven(beta, gamma, Sc, D))
    assert (band is None) or D * gamma >= beta**2 * Sc * (1 - 1e-12)
    for S in band or ():
        assert gamma * (S - Sc) == pytest.approx((beta * S) ** 2 / (4 * D), rel=1e-6, abs=1e-9)


def test_band_of_figure_1_has_the_drift_of_the_paper_at_its_slope():
    band = hk.critical_slopes(hk.SlopeDriven(0.1 / 3.7, 0.01, 0.5, 0.1))
    assert band == pytest.approx((0.5566, 4.9199), abs=1e-3)
    assert hk.critical_slopes(hk.SlopeDriven(0.1 / 3.7, 0.01, 0.5)) is None
    assert hk.critical_slopes(hk.SlopeDriven(0.0, 0.01, 0.5)) == (0.5, math.inf)


@pytest.mark.parametrize("name", ["beta", "gamma", "Sc", "D"])
def test_impossible_coefficients_are_refused_by_name(name):
    with pytest.raises(ValueError, match=f"{name} = -1.0: must be a finite number >= 0"):
        hk.SlopeDriven(**({"beta": 1.0, "gamma": 1.0, "Sc": 1.0} | {name: -1.0}))
