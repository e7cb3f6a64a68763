import cmath
import math

import numpy as np
import pytest
import sympy as sp

from bcre_pde import Material, Problem, second_critical_slope, solve, theory


def test_second_critical_slope_of_the_parameter_rows():
    for v, D, gamma, excess in [
        (0.1, 0.1, 0.01, 2.5),
        (0.3, 0.1, 0.05, 4.5),
        (0.2, 0.4, 0.02, 1.25),
        (2.5, 0.1, 0.01, 1562.5),
    ]:
        assert second_critical_slope(v, D, gamma, 0.5) == pytest.approx(0.5 + excess, rel=1e-14)


def test_second_critical_slope_at_the_edges_of_its_parameters():
    assert second_critical_slope(0.0, 0.1, 0.1, 0.5) == 0.5
    assert second_critical_slope(0.1, 0.0, 0.1, 0.5) == math.inf
    assert second_critical_slope(0.1, 0.1, 0.0, 0.5) == math.inf


def test_growth_and_front_change_sign_at_the_second_critical_slope():
    v, D, gamma = 0.3, 0.1, 0.05
    sigma = gamma * (second_critical_slope(v, D, gamma, 0.5) - 0.5)
    assert theory.growth_rate_at_a_fixed_place(v, D, sigma) == pytest.approx(0, abs=1e-15)
    assert theory.uphill_front_speed(v, D, sigma) == pytest.approx(0, abs=1e-15)
    assert theory.growth_rate_at_a_fixed_place(v, D, 1.1 * sigma) == pytest.approx(0.1 * sigma)
    assert theory.uphill_front_speed(v, D, 1.21 * sigma) == pytest.approx(0.1 * v)


@pytest.mark.parametrize("sigma", [0.0, -1.0, math.nan])
def test_layer_that_does_not_grow_has_no_front(sigma):
    with pytest.raises(ValueError, match=f"^sigma = {sigma!r}"):
        theory.uphill_front_speed(0.1, 0.1, sigma)


def test_release_on_a_frozen_slope_obeys_its_equation_and_holds_its_area():
    x, t, M, v, D, s = sp.symbols("x t M v D s", positive=True)
    R = M / sp.sqrt(4 * sp.pi * D * t) * sp.exp(s * t - (x - v * t) ** 2 / (4 * D * t))
    residual = R.diff(t) + v * R.diff(x) - D * R.diff(x, 2) - s * R
    assert sp.simplify(residual / R) == 0
    numbers = {x: 1.3, t: 2.0, M: 3.0, v: 0.4, D: 0.1, s: 0.2}
    assert theory.frozen_slope_release(1.3, 2.0, 3.0, 0.4, 0.1, 0.2) == pytest.approx(
        float(R.subs(numbers)), rel=1e-14
    )
    places = np.linspace(-10, 12, 4001)
    area = np.trapezoid(theory.frozen_slope_release(places, 2.0, 3.0, 0.4, 0.1, 0.2), places)
    assert area == pytest.approx(3 * math.exp(0.4), rel=1e-10)


def test_growth_at_a_fixed_place_is_that_of_the_release():
    v, D, sigma = 0.3, 0.1, 0.4
    times = np.array([200.0, 400.0])
    R = [float(theory.frozen_slope_release(0.0, t, 1.0, v, D, sigma)) for t in times]
    logs = np.log(R) + np.log(times) / 2
    assert np.diff(logs)[0] / 200 == pytest.approx(
        theory.growth_rate_at_a_fixed_place(v, D, sigma), rel=1e-12
    )


def periodic_solution(material, u, R, length, until, cells=64, tolerance=1e-11):
    problem = Problem(lambda x: (u(x) - material.Sc * x, R(x)), material, length, ends="periodic")
    return solve(problem, [0.0, until], cells, tolerance=tolerance)


@pytest.mark.parametrize("wave", [1, 3])
def test_rolling_mode_on_the_repose_slope_decays_and_drifts_at_its_rate(wave):
    length, until = 2 * math.pi, 0.7
    material = Material(v=1.3, D=0.2, gamma=0.4, Sc=0.5, kappa=0.1)
    solution = periodic_solution(
        material, np.zeros_like, lambda x: 1 + 0.3 * np.cos(wave * x), length, until
    )
    modes = np.fft.rfft(solution.R, axis=1)[:, wave]
    rate = cmath.log(modes[1] / modes[0]) / until
    assert rate == pytest.approx(theory.rolling_mode_rate(1.3, 0.2, wave), abs=2e-6 * wave**6)
    assert rate.real == pytest.approx(-0.2 * wave**2, abs=2e-6 * wave**6)
    assert rate.imag == pytest.approx(-1.3 * wave, abs=2e-6 * wave**6)


@pytest.mark.parametrize("kappa", [0.0, 0.15])
@pytest.mark.parametrize("wave", [1, 2])
def test_surface_mode_climbs_at_gamma_R_and_decays_by_kappa_only(kappa, wave):
    length, until, R0, gamma = 2 * math.pi, 0.6, 2.0, 0.5
    material = Material(v=1.0, D=0.0, gamma=gamma, Sc=0.5, kappa=kappa)
    solution = periodic_solution(
        material, lambda x: 1e-8 * np.cos(wave * x), lambda x: R0 + 0 * x, length, until
    )
    modes = np.fft.rfft(solution.u, axis=1)[:, wave]
    rate = cmath.log(modes[1] / modes[0]) / until
    assert rate == pytest.approx(theory.surface_mode_rate(gamma, kappa, R0, wave), abs=2e-4)
    assert rate.real == pytest.approx(-kappa * R0 * wave**2, abs=2e-4)
    assert rate.imag == pytest.approx(gamma * R0 * wave, abs=2e-4)
