"""Simple waves and scarps: BCRE, saturated exchange and thick flows by one law."""

import math

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from bcre_pde import Material, Problem, exact, simple_wave, solve
from bcre_pde.line.aradian import thick

LENGTH = 20.0
CLOSURES = {
    "BCRE": Material(1.0, 0.0, 0.5, 0.5),
    "saturated": Material(1.0, 0.0, 0.5, 0.5, v_up=0.6),
    "thick": Material(1.2, 0.0, 0.4, 0.3, v_up=0.9, Gamma=0.7),
}


def test_wave_and_surface_follow_from_the_equations_of_any_closure():
    x, t = sp.symbols("x t")
    R = sp.Function("R")(x, t)
    J, c = (sp.Function(name)(R) for name in ("J", "c"))
    # u = -R - int J'/c dR, with R_t = c R_x
    U = -1 - J.diff(R) / c
    R_t = c * R.diff(x)
    u_x, u_t = U * R.diff(x), U * R_t
    assert sp.simplify(u_t - c * u_x) == 0
    assert sp.simplify(R_t + J.diff(R) * R.diff(x) + c * u_x) == 0


@pytest.mark.parametrize("closure", CLOSURES)
def test_surface_holds_the_integral_of_what_is_carried_over_the_climb(closure):
    material, R = CLOSURES[closure], np.linspace(0.5, 3.0, 6)
    step = 1e-4
    h = [simple_wave.surface(material, np.zeros(6), R + shift) for shift in (-step, step)]
    J = [simple_wave.carried(material, R + shift) for shift in (-step, step)]
    slope = -1 - (J[1] - J[0]) / (2 * step) / simple_wave.climb(material, R)
    assert (h[1] - h[0]) / (2 * step) == pytest.approx(slope, rel=1e-7)


@pytest.mark.parametrize("closure", CLOSURES)
def test_layer_obeys_its_implicit_equation_until_it_breaks(closure):
    material = CLOSURES[closure]

    def R0(x):
        return 1 + 0.3 * np.exp(-(((x % LENGTH - 10) / 1.5) ** 2))

    def speed(R):
        return simple_wave.climb(material, R)

    x = np.linspace(0, LENGTH, 10_000, endpoint=False)
    breaking = simple_wave.breaking_time(float(np.gradient(speed(R0(x)), x).max()))
    for t in (0.0, 0.3 * breaking, 0.99 * breaking):
        R = simple_wave.layer(x, t, R0, speed, 1.3)
        assert pytest.approx(R0(x + speed(R) * t), rel=1e-13) == R
    assert np.gradient(R, x).max() > 30 * np.gradient(R0(x), x).max()


def test_breaking_time_of_bcre_is_that_of_its_steepest_rise():
    places = np.linspace(0, LENGTH, 200_001)
    R0 = 1 + 0.3 * np.exp(-(((places - 10) / 1.5) ** 2))
    steepest = 0.5 * np.gradient(R0, places).max()
    expected = 1.5 / (0.5 * 0.3 * math.sqrt(2 / math.e))
    assert simple_wave.breaking_time(steepest) == pytest.approx(expected, rel=1e-6)
    assert simple_wave.breaking_time(0.0) == math.inf


@pytest.mark.parametrize("closure", ["saturated", "thick"])
def test_order_of_pde_on_the_simple_wave_is_at_least_four(closure):
    wave = exact.simple_wave_of_hump(CLOSURES[closure], 0.4, 1.7, 22.0, 1.5)
    cells = [100, 200, 400]
    errors = []
    for n in cells:
        found = solve(wave.problem, [wave.until], n, tolerance=1e-12)
        h, R = wave.layers(found.x, wave.until)
        gap = found.h[-1] - h
        errors.append([np.abs(found.R[-1] - R).mean(), np.abs(gap - gap.mean()).mean()])
    orders = -np.polyfit(np.log(cells), np.log(errors), 1)[0]
    assert (orders > 4.5).all()
    assert np.max(errors[-1]) < 1e-8


@given(
    H=st.floats(0.01, 1e3),
    v=st.floats(0.01, 10),
    gamma=st.floats(0.01, 10),
    Gamma=st.floats(0, 10),
    v_up=st.floats(0.01, 10) | st.just(math.inf),
)
def test_scarp_balances_what_it_erodes_with_what_grows_and_leaves(H, v, gamma, Gamma, v_up):
    material = Material(v, 0.0, gamma, 0.5, v_up=v_up, Gamma=Gamma)
    R = simple_wave.scarp_layer(material, H)
    if v / gamma * (1 + 1e-9) > H:
        assert pytest.approx(0.0, abs=1e-8 * H) == R
        return
    c = simple_wave.scarp_speed(material, H)
    assert c == simple_wave.climb(material, R)
    assert c * H == pytest.approx(c * R + simple_wave.carried(material, R), rel=1e-6)


def test_scarp_of_bcre_climbs_at_gamma_H_less_v():
    material = Material(0.1, 0.0, 0.01, 0.5)
    assert simple_wave.scarp_speed(material, 50.0) == pytest.approx(0.4, rel=1e-14)
    assert simple_wave.scarp_speed(material, 9.0) == 0.0


@pytest.mark.parametrize("closure", ["BCRE", "thick"])
def test_scarp_of_a_step_climbs_at_the_scarp_law(closure):
    """D = 1 makes D/(v + c) a length of cells; the law is that of a sharp scarp."""
    H, material = 50.0, Material(v=0.1, D=1.0, gamma=0.01, Sc=0.5)
    if closure == "thick":
        material = thick(material)
    R = simple_wave.scarp_layer(material, H)

    def initial(x):
        below = (1 + np.tanh(x - 70)) / 2
        return H * (1 - below) - 0.5 * x, R * below

    expected = simple_wave.scarp_speed(material, H)
    shortfall = []
    for cells in (200, 400):
        times = [20 / expected, 36 / expected]
        found = solve(Problem(initial, material, 100.0), times, cells)
        places = [np.interp(-H / 2, -u, found.x) for u in found.u]
        shortfall.append(1 - (places[0] - places[1]) / 16)
        assert found.R[:, found.x < 75].max() == pytest.approx(R, rel=0.06)
    assert abs(shortfall[1]) < 0.1
    assert abs(shortfall[1]) <= abs(shortfall[0]) + 0.005
