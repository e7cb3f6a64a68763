"""How the schemes converge, and what diffusion they have of their own."""

import math
from dataclasses import replace

import numpy as np
import pytest

from bcre_ca import Pile, Rule, advance, theory

LENGTH = 20.0


def nonlinear_wave(scheme, cells, until=1.0, **terms):
    """h and R, means over 50 equal stretches, after a smooth wave has rolled and climbed."""
    d = LENGTH / cells
    x, k = (np.arange(cells) + 0.5) * d, 2 * math.pi / LENGTH
    h, R = -0.5 * x + 0.3 * np.sin(2 * k * x), 1 + 0.4 * np.cos(k * x)
    rule = Rule(v=1.0, D=0.02, gamma=0.5, Sc=0.5, d=d, dt=1.0, scheme=scheme, **terms)
    steps = math.ceil(until / (0.6 * rule.max_stable_step(3.0, 0.3, 0.2)))
    end = advance(Pile(h, R), replace(rule, dt=until / steps), steps, "periodic")
    assert np.abs(end.R - R).max() > 0.1
    return np.array([layer.reshape(50, -1).mean(axis=1) for layer in (end.h, end.R)])


@pytest.mark.parametrize(
    ("scheme", "terms", "least", "most", "largest"),
    [
        ("upwind", {}, 0.9, 1.1, 5e-3),
        ("limited", {"kappa": 0.02, "v_up": 1e9}, 1.8, math.inf, 1e-4),
    ],
)
def test_order_on_a_nonlinear_wave_with_diffusion(scheme, terms, least, most, largest):
    """Against the same rule on 3200 cells; the error is that at 200 cells of d = 0.1."""
    truth = nonlinear_wave(scheme, 3200, **terms)
    coarse, fine = (
        np.abs(nonlinear_wave(scheme, cells, **terms) - truth).mean() for cells in (100, 200)
    )
    assert fine < largest
    assert least < math.log2(coarse / fine) < most


@pytest.mark.parametrize(
    ("v", "D", "d", "dt"), [(0.1, 0.1, 1.0, 1.0), (0.5, 0.3, 0.7, 0.3), (2.5, 0.1, 0.4, 0.14)]
)
def test_calibrated_rule_drifts_by_v_and_spreads_by_D(moments_of_one_grain, v, D, d, dt):
    rule = Rule(v, D, 0.0, 0.5, d, dt, scheme="calibrated")
    assert rule.calibrating_step() <= dt <= rule.max_stable_step()
    assert moments_of_one_grain(rule) == pytest.approx((v, D), rel=1e-9)
    assert rule.effective_diffusion() == pytest.approx(D, rel=1e-12)


@pytest.mark.parametrize("part", [0.25, 0.9])
def test_below_its_calibrating_step_it_spreads_by_what_is_stated(moments_of_one_grain, part):
    """Cells of Peclet number 25: the upwind flux alone diffuses by (v d/2)(1 - v dt/d) > D."""
    rule = Rule(v=2.5, D=0.1, gamma=0.0, Sc=0.5, d=1.0, dt=1.0, scheme="calibrated")
    calibrating = rule.calibrating_step()
    assert calibrating == pytest.approx(0.4 * (1 - 0.2 / 2.5), rel=1e-12)
    short, just = replace(rule, dt=part * calibrating), replace(rule, dt=calibrating)
    stated = 1.25 * (1 - 2.5 * short.dt)
    assert stated > 0.19
    assert short.effective_diffusion() == pytest.approx(stated, rel=1e-12)
    assert moments_of_one_grain(short) == pytest.approx((2.5, stated), rel=1e-9)
    assert moments_of_one_grain(just) == pytest.approx((2.5, 0.1), rel=1e-9)


def test_calibrating_step_is_zero_for_cells_of_peclet_number_2_and_for_other_schemes():
    fine = Rule(v=2.5, D=0.1, gamma=0.0, Sc=0.5, d=0.08, dt=0.01, scheme="calibrated")
    assert fine.calibrating_step() == 0
    assert replace(fine, d=0.081).calibrating_step() > 0
    assert replace(fine, v=0.0).calibrating_step() == 0
    assert replace(fine, d=1.0, scheme="upwind").calibrating_step() == 0


def test_rolling_mode_of_the_calibrated_rule_decays_by_D_to_second_order_in_the_cell(plain_march):
    """At D dt/d^2 = 0.05, (decay/k^2 - D) falls by four as the cell is halved."""
    v, D, length, wave = 1.0, 0.05, 8.0, 2
    k, errors = 2 * math.pi * wave / length, []
    for cells in (200, 400):
        d = length / cells
        i = np.arange(cells)
        rule = Rule(v, D, 0.0, 0.5, d, 0.05 * d**2 / D, scheme="calibrated")
        assert rule.effective_diffusion() == pytest.approx(D, rel=1e-12)
        R = 1 + 0.3 * np.cos(k * d * i)
        _, new_R, _ = plain_march(-0.5 * d * i, R, rule, 50, "periodic")
        left = abs(np.fft.fft(new_R)[wave] / np.fft.fft(R)[wave])
        errors.append(-math.log(left) / (k**2 * 50 * rule.dt) - D)
    assert abs(errors[1]) < 1e-4 * D
    assert math.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.1)


@pytest.mark.parametrize(
    ("v", "D", "gamma", "d", "excess"), [(0.1, 0.1, 0.01, 1.0, 2.0), (0.2, 0.4, 0.02, 0.5, 1.1)]
)
def test_growth_of_the_calibrated_rule_at_a_fixed_cell_changes_sign_at_its_critical_slope(
    growth_at_a_fixed_cell, v, D, gamma, d, excess
):
    rule = Rule(v, D, gamma, 0.5, d, 1.0, scheme="calibrated", kappa=1e-9, v_up=1e9, dry=1e-300)
    rule = replace(rule, dt=0.6 * rule.max_stable_step())
    left = D - v * d / 2 * (1 - v * rule.dt / d)
    critical = rule.second_critical_slope() - 0.5
    assert critical == pytest.approx(theory.second_critical_excess(v, left, gamma, d), rel=1e-9)
    for part in (excess / critical, 0.97, 1.03):
        rate = growth_at_a_fixed_cell(rule, part * critical)
        sigma = gamma * part * critical
        expected = theory.growth_rate_at_a_fixed_place(v, left, sigma, d, rule.dt)
        assert rate == pytest.approx(expected, abs=1e-5 * v / d)
        assert (rate > 0) == (part > 1)


def test_critical_slope_of_the_calibrated_rule_lies_nearer_to_that_of_bcre():
    rule = Rule(0.1, 0.1, 0.01, 0.5, 1.0, 1.0)
    calibrated = replace(rule, scheme="calibrated")
    bcre = 0.5 + 0.1**2 / (4 * 0.1 * 0.01)
    errors = [abs(r.second_critical_slope() - bcre) for r in (calibrated, rule)]
    assert errors[0] < errors[1] / 2
    with pytest.raises(ValueError, match="scheme = 'limited': the second critical slope"):
        replace(rule, scheme="limited").second_critical_slope()


def test_other_schemes_have_the_curvature_that_was_asked_for():
    rule = Rule(0.1, 0.1, 0.01, 0.5, 1.0, 1.0, kappa=0.002)
    assert rule.effective_curvature() == pytest.approx(0.002 + 0.005)
    for scheme in ("calibrated", "limited"):
        assert replace(rule, scheme=scheme).effective_curvature() == 0.002
    assert replace(rule, scheme="limited").effective_diffusion() == 0.1


@pytest.mark.parametrize(("scheme", "share"), [("calibrated", 1e-3), ("limited", 0.05)])
def test_surface_waves_of_other_schemes_smooth_by_far_less_than_the_printed_rules(
    plain_march, scheme, share
):
    """Waves of 16 cells under R0 = 20: the printed rule smooths them by (gamma d/2)(1 - gamma R0
    dt/d); what is left to the others is of higher order in d."""
    rule = Rule(v=0.1, D=0.0, gamma=0.01, Sc=0.0, d=1.0, dt=0.4)
    k, cells = 2 * math.pi / 64, 64
    h0 = 1e-7 * np.cos(k * np.arange(cells))

    def smoothing(scheme):
        start = h0, np.full(cells, 20.0)
        h, _, _ = plain_march(*start, replace(rule, scheme=scheme), 20, "periodic")
        left = abs(np.fft.fft(h)[1] / np.fft.fft(h0)[1])
        return -math.log(left) / (20.0 * k**2 * 20 * rule.dt)

    assert smoothing("upwind") == pytest.approx(0.005 * (1 - 0.08), rel=0.01)
    assert abs(smoothing(scheme)) < share * 0.005
