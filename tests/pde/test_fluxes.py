import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from bcre_pde.line import fluxes
from bcre_pde.stencils import face_value

HALF = sp.Rational(1, 2)


def rate(
    u, R, v=0.0, D=0.0, gamma=0.0, kappa=None, dx=1.0, periodic=False, foot=0.0, saturation=None
):
    """du/dt, dR/dt, du_foot/dt and the flux through the foot."""
    n = len(u)
    state = np.zeros((3, n))
    state[0], state[1], state[2, 0] = u, R, foot
    out = np.full((3, n), np.nan)
    scratch = np.empty((2, n + 6)), np.empty((2, n + 1))
    fluxes.rate(
        state, out, *scratch, v, D, gamma, kappa, dx, periodic, saturation, None, None, None
    )
    return out[0], out[1], out[2, 0], out[2, -1] * n * dx


def cells(n, dx):
    return (np.arange(n) + 0.5) * dx


def cell_means(power, n, dx):
    edges = np.arange(n + 1) * dx
    return np.diff(edges ** (power + 1)) / ((power + 1) * dx)


layers = st.lists(st.floats(0, 5), min_size=8, max_size=40)


@given(data=st.data(), periodic=st.booleans(), dx=st.floats(0.05, 3))
def test_mass_changes_by_the_flux_through_the_ends_alone(data, periodic, dx):
    R = np.array(data.draw(layers))
    heights = st.lists(st.floats(-20, 20), min_size=R.size, max_size=R.size)
    u = np.array(data.draw(heights))
    v, D, gamma, kappa = (data.draw(st.floats(0, 2)) for _ in range(4))
    du, dR, _, outflow = rate(u, R, v, D, gamma, kappa, dx, periodic, foot=1.3)
    change = dx * (du.sum() + dR.sum())
    assert outflow == pytest.approx(0.0 if periodic else v * R[-1], rel=1e-14)
    scale = dx * (np.abs(du).sum() + np.abs(dR).sum()) + D * R.max() / dx + v * R.max()
    assert abs(change + outflow) <= 1e-13 * scale + 1e-300


@given(shift=st.integers(1, 20), seed=st.integers(0, 1000))
def test_periodic_rates_move_with_the_state_to_the_bit(shift, seed):
    rng = np.random.default_rng(seed)
    u, R = rng.uniform(-1, 1, 21), rng.uniform(0, 1, 21)
    here = rate(u, R, 1.0, 0.3, 0.5, 0.2, 0.7, periodic=True)
    there = rate(np.roll(u, shift), np.roll(R, shift), 1.0, 0.3, 0.5, 0.2, 0.7, periodic=True)
    assert np.array_equal(np.roll(here[0], shift), there[0])
    assert np.array_equal(np.roll(here[1], shift), there[1])


def test_uniform_layer_on_the_repose_slope_is_steady():
    du, dR, _, _ = rate(np.full(20, 3.0), np.full(20, 2.0), 1.0, 0.3, 0.5, 0.2, 0.1, periodic=True)
    assert np.abs(du).max() < 1e-12
    assert np.abs(dR).max() < 1e-12


def test_negative_layer_exchanges_nothing():
    du, _, foot, _ = rate(np.linspace(5, 0, 12), np.full(12, -1.0), gamma=1.0, kappa=1.0)
    assert (du == 0).all()
    assert foot == 0


@given(steps=st.lists(st.floats(0, 10), min_size=4, max_size=4), start=st.floats(-10, 10))
def test_face_value_of_monotone_data_lies_between_its_neighbours(steps, start):
    values = start + np.cumsum([0.0, *steps])
    for five in (values, values[::-1]):
        face = face_value(*five)
        low, high = sorted(five[2:4])
        assert low - 1e-13 * 50 <= face <= high + 1e-13 * 50


@pytest.mark.parametrize("power", [0, 1, 2, 3, 4])
def test_face_value_of_smooth_data_is_exact_for_polynomials_of_degree_four(power):
    edges = np.arange(10.0, 16.0)
    means = np.diff(edges ** (power + 1)) / (power + 1)
    assert face_value(*means) == pytest.approx(13.0**power, rel=1e-12)


def test_stencil_of_the_inner_face_is_the_fifth_order_one():
    x = sp.symbols("x")
    c = sp.symbols("c0:5")
    polynomial = sum(c[k] * x**k for k in range(5))
    means = [sp.integrate(polynomial, (x, k - 3, k - 2)) for k in range(5)]
    weights = [sp.Rational(w, 60) for w in (2, -13, 47, 27, -3)]
    value = sum(w * mean for w, mean in zip(weights, means, strict=True))
    assert sp.expand(value - polynomial.subs(x, 0)) == 0


@pytest.mark.parametrize("power", [0, 1, 2, 3, 4, 5])
def test_inner_spread_is_exact_for_polynomials_of_degree_five(power):
    """dx^2 R_xx of a degree-5 polynomial; six central weights."""
    n, dx = 14, 0.5
    _, dR, _, _ = rate(np.zeros(n), cell_means(power, n, dx), D=1.0, dx=dx)
    edges = np.arange(n + 1) * dx
    slope = power * edges ** max(power - 1, 0)
    expected = np.diff(slope) / dx
    assert dR[3:-3] == pytest.approx(expected[3:-3], rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("power", [0, 1, 2, 3, 4, 5, 6])
def test_inner_curvature_of_u_is_exact_for_polynomials_of_degree_six(power):
    n, dx = 14, 0.5
    x = cells(n, dx)
    du, _, _, _ = rate(x**power, np.ones(n), kappa=1.0, dx=dx)
    expected = power * (power - 1) * x ** max(power - 2, 0)
    assert du[3:-3] == pytest.approx(expected[3:-3], rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("power", [0, 1, 2, 3])
def test_gradient_of_u_is_exact_for_cubics_also_at_the_open_ends(power):
    n, dx = 14, 0.5
    x = cells(n, dx)
    du, _, _, _ = rate(x**power, np.ones(n), gamma=1.0, dx=dx, foot=(n * dx) ** power)
    assert du == pytest.approx(power * x ** max(power - 1, 0), rel=1e-11, abs=1e-11)


@pytest.mark.parametrize("power", [0, 1, 2, 3])
def test_curvature_of_u_is_exact_for_cubics_at_the_open_foot_and_nothing_at_the_top(power):
    n, dx = 14, 0.5
    x = cells(n, dx)
    du, _, _, _ = rate(x**power, np.ones(n), kappa=1.0, dx=dx, foot=(n * dx) ** power)
    expected = power * (power - 1) * x ** max(power - 2, 0)
    assert du[1:] == pytest.approx(expected[1:], rel=1e-10, abs=1e-10)
    assert du[0] == 0


def test_curvature_on_the_foot_is_exact_for_cubics_with_no_slope_there():
    n, dx, kappa, R = 14, 0.5, 0.3, 2.0
    below = n * dx - cells(n, dx)
    for shape, curvature in [(below**2, 2.0), (below**3, 0.0), (0 * below + 1, 0.0)]:
        _, _, foot, _ = rate(
            7.0 + shape, np.full(n, R), kappa=kappa, dx=dx, foot=7.0 + (shape.min() == 1.0)
        )
        assert foot == pytest.approx(kappa * R * curvature, rel=1e-11, abs=1e-11)


def test_foot_keeps_its_height_without_curvature_term():
    _, _, foot, _ = rate(np.linspace(5, 0, 12), np.ones(12), 1.0, 0.3, 0.5, None, 0.1, foot=-2.0)
    assert foot == 0


@pytest.mark.parametrize(
    ("positions", "derivative", "weights"),
    [
        ([0, 1, 2, 3], 1, ["-11/6", "3", "-3/2", "1/3"]),
        ([-1, 0, 1, 2], 1, ["-1/3", "-1/2", "1", "-1/6"]),
        ([-1, 0, 1, 3 * HALF], 1, ["-3/10", "-2/3", "3/2", "-8/15"]),
        ([-2, -1, 0, HALF], 1, ["1/10", "-2/3", "-1/2", "16/15"]),
        ([-2, -1, 0, HALF], 2, ["-1/5", "2", "-5", "16/5"]),
    ],
)
def test_weights_of_the_one_sided_stencils_follow_from_taylors_theorem(
    positions, derivative, weights
):
    """What the two tests above measure, derived: these are the numbers written into the kernel."""
    n = len(positions)
    powers = sp.Matrix(
        n, n, lambda i, j: sp.Integer(1) if i == 0 else sp.sympify(positions[j]) ** i
    )
    unit = sp.zeros(n, 1)
    unit[derivative] = sp.factorial(derivative)
    assert list(powers.LUsolve(unit)) == [sp.Rational(w) for w in weights]


def test_foot_curvature_follows_from_the_cubic_through_the_last_two_cells():
    B, C, near, far = sp.symbols("B C near far")
    fit = sp.solve([B * HALF**2 - C * HALF**3 - near, B * 9 / 4 - C * 27 / 8 - far], [B, C])
    assert sp.expand(2 * fit[B] - (108 * near - 4 * far) / 9) == 0


@pytest.mark.parametrize("power", [0, 1, 2])
def test_drift_through_the_faces_next_to_open_ends_is_exact_for_low_degrees(power):
    """Linear next to the closed top; quadratic elsewhere. The foot itself takes v R of its cell."""
    n, dx, v = 14, 0.5, 2.0
    R = cell_means(power, n, dx) + 1
    _, dR, _, outflow = rate(np.zeros(n), R, v=v, dx=dx)
    flux = -dx * np.cumsum(dR)
    exact = v * ((np.arange(1, n + 1) * dx) ** power + 1)
    inner = slice(1 if power == 2 else 0, n - 1)
    assert flux[inner] == pytest.approx(exact[inner], rel=1e-11)
    assert flux[-1] == pytest.approx(v * R[-1], rel=1e-11)
    assert outflow == pytest.approx(v * R[-1], rel=1e-14)


@pytest.mark.parametrize("power", [0, 1, 2])
def test_spread_through_the_faces_next_to_open_ends_is_exact_for_quadratics(power):
    n, dx, D = 14, 0.5, 2.0
    _, dR, _, _ = rate(np.zeros(n), cell_means(power, n, dx), D=D, dx=dx)
    flux = -dx * np.cumsum(dR)
    exact = -D * power * (np.arange(1, n + 1) * dx) ** max(power - 1, 0)
    assert flux[:-1] == pytest.approx(exact[:-1], rel=1e-10, abs=1e-10)
    assert flux[-1] == pytest.approx(0, abs=1e-10)


def test_spread_next_to_the_outermost_faces_is_exact_for_quartics():
    n, dx = 14, 0.5
    _, dR, _, _ = rate(np.zeros(n), cell_means(4, n, dx), D=1.0, dx=dx)
    flux = -dx * np.cumsum(dR)
    exact = -4 * (np.arange(1, n + 1) * dx) ** 3
    assert flux[1:-2] == pytest.approx(exact[1:-2], rel=1e-10)


@pytest.mark.parametrize(
    ("coefficient", "expected"),
    [
        ("v", lambda u, R, ux, uxx, Rx, Rxx: -Rx),
        ("D", lambda u, R, ux, uxx, Rx, Rxx: Rxx),
        ("gamma", lambda u, R, ux, uxx, Rx, Rxx: -R * ux),
        ("kappa", lambda u, R, ux, uxx, Rx, Rxx: -R * uxx),
    ],
)
def test_each_term_converges_to_its_derivative_at_fifth_order(coefficient, expected):
    errors = []
    for n in (40, 80):
        x = cells(n, 2 * np.pi / n)
        u, ux, uxx = np.sin(x), np.cos(x), -np.sin(x)
        R, Rx, Rxx = 2 + np.cos(x + 1), -np.sin(x + 1), -np.cos(x + 1)
        _, dR, _, _ = rate(u, R, dx=2 * np.pi / n, periodic=True, **{coefficient: 1.0})
        errors.append(np.abs(dR - expected(u, R, ux, uxx, Rx, Rxx)).mean())
    assert errors[1] < 2e-6
    assert np.log2(errors[0] / errors[1]) > 4.7


@pytest.mark.parametrize("periodic", [True, False])
def test_saturated_law_is_the_linear_law_of_a_thinner_layer(periodic):
    rng = np.random.default_rng(5)
    u, R = np.sort(rng.uniform(0, 9, 30))[::-1], rng.uniform(0, 4, 30)
    gamma, v_up = 0.7, 0.4
    saturated, _, _, _ = rate(u, R, gamma=gamma, periodic=periodic, saturation=gamma / v_up)
    linear, _, _, _ = rate(u, R / (1 + gamma * R / v_up), gamma=gamma, periodic=periodic)
    assert saturated == pytest.approx(linear, rel=1e-13)
    steepest = np.abs(rate(u, np.ones(30), gamma=1.0, periodic=periodic)[0])
    assert (np.abs(saturated) <= v_up * steepest * (1 + 1e-12)).all()
