import cmath
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bcre_ca import Rule, evolve, theory

positive = st.floats(0.01, 5)


@pytest.mark.parametrize(
    ("v", "D", "gamma", "d", "expected"),
    [
        (0.1, 0.1, 0.01, 1.0, 1.715729),
        (0.3, 0.1, 0.05, 1.0, 2.000000),
        (0.3, 0.1, 0.05, 0.25, 3.335958),
        (0.2, 0.4, 0.02, 0.5, 1.114562),
        (2.5, 0.1, 0.01, 1.0, 168.0196),
    ],
)
def test_second_critical_slope_of_the_parameter_rows(v, D, gamma, d, expected):
    assert theory.second_critical_excess(v, D, gamma, d) == pytest.approx(expected, rel=5e-7)


@given(v=positive, D=positive, gamma=positive, d=positive)
def test_second_critical_slope_is_the_continuous_one_times_a_function_of_the_cell_peclet_number(
    v, D, gamma, d
):
    peclet = v * d / D
    ratio = 4 * (math.sqrt(1 + peclet) - 1) ** 2 / peclet**2
    expected = ratio * v**2 / (4 * D * gamma)
    assert theory.second_critical_excess(v, D, gamma, d) == pytest.approx(expected, rel=1e-9)


@given(v=positive, D=positive, gamma=positive)
def test_second_critical_slope_tends_to_the_continuous_one(v, D, gamma):
    continuous = v**2 / (4 * D * gamma)
    errors = [
        continuous - theory.second_critical_excess(v, D, gamma, peclet * D / v)
        for peclet in (1e-2, 1e-3)
    ]
    assert errors[0] / continuous == pytest.approx(0.5e-2, rel=0.02)
    assert errors[0] / errors[1] == pytest.approx(10, rel=0.02)


def test_second_critical_slope_is_infinite_without_exchange():
    assert theory.second_critical_excess(0.1, 0.1, 0.0, 1.0) == math.inf


@given(v=positive, D=positive, d=positive, part=st.floats(0.01, 0.99))
def test_second_critical_slope_does_not_depend_on_the_step(v, D, d, part):
    sigma = theory.second_critical_excess(v, D, 1.0, d)
    dt = part * theory.max_stable_step(v, D, 1.0, d)
    assert theory.growth_rate_at_a_fixed_place(v, D, sigma, d, dt) * dt == pytest.approx(
        0, abs=1e-12
    )
    assert theory.uphill_front_speed(v, D, sigma, d, dt) * dt / d == pytest.approx(0, abs=1e-9)


@given(v=positive, D=positive, sigma=positive)
def test_growth_at_a_fixed_place_tends_to_the_continuous_one(v, D, sigma):
    d = 1e-4 * D / v
    dt = 1e-5 / (sigma + v**2 / D) * min(1.0, d * v / D)
    expected = sigma - v**2 / (4 * D)
    measured = theory.growth_rate_at_a_fixed_place(v, D, sigma, d, dt)
    assert measured == pytest.approx(expected, abs=1e-3 * (sigma + v**2 / D))


@pytest.mark.parametrize("sigma", [0.01, 0.03, 0.2])
def test_uphill_front_speed_tends_to_the_continuous_one_at_first_order(sigma):
    v, D = 0.1, 0.1
    expected = 2 * math.sqrt(D * sigma) - v
    errors = [
        theory.uphill_front_speed(v, D, sigma, d, 0.1 * d**2) - expected for d in (0.02, 0.01)
    ]
    assert abs(errors[1]) < 2e-3
    assert errors[0] / errors[1] == pytest.approx(2, rel=0.02)


def test_uphill_front_speed_is_the_smallest_over_all_profiles():
    v, D, sigma, d, dt = 0.3, 0.1, 0.15, 0.5, 0.4
    m = np.linspace(0.05, 12, 200_001)
    growth = (
        1
        + dt * sigma
        - v * dt / d * (1 - np.exp(-m * d))
        + D * dt / d**2 * (np.exp(m * d) - 2 + np.exp(-m * d))
    )
    speeds = np.log(growth) / (m * dt)
    assert theory.uphill_front_speed(v, D, sigma, d, dt) == pytest.approx(speeds.min(), rel=1e-7)


@pytest.mark.parametrize("sigma", [0.0, -0.1, math.nan])
def test_layer_that_does_not_grow_has_no_front(sigma):
    with pytest.raises(ValueError, match=f"^sigma = {sigma!r}"):
        theory.uphill_front_speed(0.1, 0.1, sigma, 1.0, 1.0)


@pytest.mark.parametrize(("cells", "wave"), [(32, 1), (32, 5), (32, 16), (45, 11)])
@pytest.mark.parametrize(("d", "dt"), [(1.0, 1.0), (0.5, 0.4)])
def test_rolling_modes_grow_by_the_amplification_factor(cells, wave, d, dt):
    """Without exchange and on the repose slope; the base layer keeps R positive."""
    rule = Rule(v=0.1, D=0.1, gamma=0.0, Sc=0.5, d=d, dt=dt)
    i, k = np.arange(cells), 2 * math.pi * wave / (cells * d)
    _, R = evolve(-0.5 * d * i, 1 + 0.3 * np.cos(k * d * i), rule, 1, "periodic")
    start = np.fft.fft(0.3 * np.cos(k * d * i))[wave]
    factor = np.fft.fft(R - 1)[wave] / start
    assert factor == pytest.approx(
        theory.amplification(0.1, 0.1, 0.0, d, dt, cmath.exp(-1j * k * d)), abs=1e-10
    )
    if wave < cells / 2:
        rate = theory.rolling_mode_rate(0.1, 0.1, d, dt, k)
        assert cmath.exp(rate * dt) == pytest.approx(factor, abs=1e-10)


@pytest.mark.parametrize("excess", [0.7, 1.7, -0.4])
def test_frozen_slope_multiplies_a_rolling_mode_by_the_amplification_factor(plain_march, excess):
    """A sloping tail e^(m x) is the factor at z = e^(-m d); R of 1e-150 freezes the surface too."""
    rule = Rule(v=0.1, D=0.1, gamma=0.05, Sc=0.5, d=0.5, dt=0.4)
    i, m = np.arange(40), 0.6
    h = -(0.5 + excess) * 0.5 * i
    G = theory.amplification(0.1, 0.1, 0.05 * excess, 0.5, 0.4, math.exp(-m * 0.5))
    for size, frozen in ((1e-150, None), (1.0, h)):
        R0 = size * np.exp(m * 0.5 * i)
        _, R, _ = plain_march(h, R0, rule, 1, "open", frozen)
        assert (R / R0)[2:-2] == pytest.approx(np.full(36, G.real), rel=1e-12)
    _, R, _ = plain_march(h, R0, rule, 5, "open", h)
    assert (R / R0)[6:-6] == pytest.approx(np.full(28, G.real**5), rel=1e-12)


@pytest.mark.parametrize(("cells", "wave"), [(32, 1), (32, 5), (32, 15), (45, 11)])
@pytest.mark.parametrize("R0", [1.0, 25.0, 60.0])
def test_surface_modes_grow_by_the_factor_of_the_linearised_rule(cells, wave, R0):
    """A wave of 1e-7 keeps the nonlinear rest below 1e-14, 1e-7 of the wave."""
    d, dt, gamma = 0.5, 0.4, 0.01
    rule = Rule(v=0.1, D=0.1, gamma=gamma, Sc=0.0, d=d, dt=dt)
    i, k = np.arange(cells), 2 * math.pi * wave / (cells * d)
    h0 = 1e-7 * np.cos(k * d * i)
    h, _ = evolve(h0, np.full(cells, R0), rule, 1, "periodic")
    factor = np.fft.fft(h)[wave] / np.fft.fft(h0)[wave]
    c = gamma * R0 * dt / d
    assert factor == pytest.approx(1 - c + c * cmath.exp(1j * k * d), abs=1e-10)
    rate = theory.surface_mode_rate(gamma, R0, d, dt, k)
    assert cmath.exp(rate * dt) == pytest.approx(factor, abs=1e-10)
    assert abs(factor) ** 2 == pytest.approx(1 - 2 * c * (1 - c) * (1 - math.cos(k * d)), abs=1e-9)


def test_mode_rates_tend_to_the_continuous_ones_at_first_order():
    v, D, gamma, R0, k = 0.3, 0.1, 0.02, 5.0, 1.7
    rolling = [theory.rolling_mode_rate(v, D, d, 0.01 * d, k) for d in (1e-3, 5e-4)]
    surface = [theory.surface_mode_rate(gamma, R0, d, 0.01 * d, k) for d in (1e-3, 5e-4)]
    for rates, continuous in [
        (rolling, complex(-D * k**2, -v * k)),
        (surface, complex(0, gamma * R0 * k)),
    ]:
        errors = [abs(rate - continuous) for rate in rates]
        assert errors[1] < 1e-3
        assert errors[0] / errors[1] == pytest.approx(2, rel=0.01)


def test_long_waves_decay_by_the_effective_diffusion_and_the_effective_curvature():
    v, D, gamma, R0, d, dt = 0.3, 0.1, 0.02, 20.0, 0.5, 0.4
    k = 1e-3
    rolling = -theory.rolling_mode_rate(v, D, d, dt, k).real / k**2
    surface = -theory.surface_mode_rate(gamma, R0, d, dt, k).real / (R0 * k**2)
    assert rolling == pytest.approx(theory.effective_diffusion(v, D, d, dt), rel=1e-5)
    assert rolling == pytest.approx(D + v * d / 2 * (1 - v * dt / d), rel=1e-5)
    assert surface == pytest.approx(theory.effective_curvature(gamma, d, dt, R0), rel=1e-5)
    assert surface == pytest.approx(gamma * d / 2 * (1 - gamma * R0 * dt / d), rel=1e-5)


@pytest.mark.parametrize(
    ("v", "D", "gamma", "d", "excess"),
    [
        (0.1, 0.1, 0.01, 1.0, 1.5),
        (0.1, 0.1, 0.01, 1.0, 2.1),
        (0.3, 0.1, 0.05, 0.5, 3.2),
        (0.2, 0.4, 0.02, 0.5, 1.2),
    ],
)
def test_growth_measured_at_a_fixed_cell_is_that_of_the_saddle(
    growth_at_a_fixed_cell, v, D, gamma, d, excess
):
    dt = 0.6 * theory.max_stable_step(v, D, gamma, d)
    rate = growth_at_a_fixed_cell(Rule(v=v, D=D, gamma=gamma, Sc=0.5, d=d, dt=dt), excess)
    expected = theory.growth_rate_at_a_fixed_place(v, D, gamma * excess, d, dt)
    assert rate == pytest.approx(expected, abs=1e-5 * v / d)


def test_growth_changes_sign_at_the_second_critical_slope():
    v, D, gamma, d = 0.1, 0.1, 0.01, 1.0
    critical = theory.second_critical_excess(v, D, gamma, d)
    for excess, sign in [(critical * 0.999, -1), (critical * 1.001, 1)]:
        rate = theory.growth_rate_at_a_fixed_place(v, D, gamma * excess, d, 1.0)
        assert math.copysign(1, rate) == sign
        assert math.copysign(1, theory.uphill_front_speed(v, D, gamma * excess, d, 1.0)) == sign


def test_step_bounds_are_those_of_the_weights():
    assert theory.max_stable_step(2.5, 0.1, 0.01, 1.0) == pytest.approx(0.370, abs=5e-4)
    assert theory.max_stable_step(0.1, 0.1, 0.01, 1.0, largest_R=200.0) == pytest.approx(0.5)
    assert theory.max_stable_step(0.1, 0.1, 0.1, 1.0, deficit=7.0) == pytest.approx(1.0)
    assert theory.max_stable_step(0.0, 0.0, 0.0, 1.0) == math.inf


def test_effective_diffusion_vanishes_with_the_cell_and_at_a_courant_number_of_one():
    assert theory.effective_diffusion(0.3, 0.1, 1e-9, 0.0) == pytest.approx(0.1, rel=1e-8)
    assert theory.effective_diffusion(2.0, 0.1, 1.0, 0.5) == 0.1


def test_climb_of_a_surface_wave_is_first_order_against_the_exact_solution(plain_march):
    """R(x, t) = R0(x + gamma R t), D = 0; 1.95e-3 at 400 cells with dt = d/2v."""
    v, gamma, Sc, length, until = 1.0, 0.5, 0.5, 20.0, 2.0

    def R0(x):
        distance = (x - 10 + length / 2) % length - length / 2
        return 1 + 0.3 * np.exp(-((distance / 1.5) ** 2))

    errors = []
    for cells in (200, 400, 800):
        d = length / cells
        x = (np.arange(cells) + 0.5) * d
        R = R0(x)
        h = -Sc * x - R - v / gamma * np.log(R)
        rule = Rule(v=v, D=0.0, gamma=gamma, Sc=Sc, d=d, dt=d / (2 * v))
        _, computed, _ = plain_march(h, R, rule, round(until / rule.dt), "periodic")
        exact = R
        for _ in range(200):
            exact = R0(x + gamma * exact * until)
        errors.append(np.abs(computed - exact).mean())
    assert errors[1] == pytest.approx(1.95e-3, rel=0.05)
    assert math.log2(errors[1] / errors[2]) == pytest.approx(1.0, abs=0.1)
    assert math.log2(errors[0] / errors[1]) == pytest.approx(1.0, abs=0.1)
