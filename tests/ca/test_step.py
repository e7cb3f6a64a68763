"""The plain step against the paper worked by hand, and the readings of its printed rule."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bcre_ca import Rule, step

PAPER = Rule(v=0.1, D=0.1, gamma=0.01, Sc=0.5, d=1.0, dt=1.0)
every_order = pytest.mark.parametrize("order", ["synchronous", "right", "left"])


def test_one_step_is_the_printed_rule_worked_by_hand():
    rule = replace(PAPER, D=0.2)
    h, R, outflow = step(np.array([5.0, 3.0, 2.8]), np.array([1.0, 2.0, 4.0]), rule)
    flux = [0.1 * 1 - 0.2 * (2 - 1), 0.1 * 2 - 0.2 * (4 - 2), 0.1 * 4]
    eroded = [0.01 * 1 * (2.0 - 0.5), 0.01 * 2 * (0.2 - 0.5), 0.0]
    expected = [1 - flux[0] + eroded[0], 2 + flux[0] - flux[1] + eroded[1], 4 + flux[1] - flux[2]]
    assert h == pytest.approx([5 - eroded[0], 3 - eroded[1], 2.8], rel=1e-14)
    assert pytest.approx(expected, rel=1e-14) == R
    assert outflow == pytest.approx(flux[2], rel=1e-14)


def test_limited_step_over_a_peak_is_the_formula_worked_by_hand():
    """v = 1, d = 1, dt = 1/4, no exchange: only the flux with its limited slopes acts."""
    rule = Rule(v=1.0, D=0.0, gamma=0.0, Sc=0.0, d=1.0, dt=0.25, scheme="limited")
    R = np.array([0.0, 1.0, 3.0, 4.0, 3.0, 0.0])
    r = np.array([0.0, 1.5, 1.5, 0.0, -2.0, 0.0])
    face = R - 0.25 * r / 2 + r / 2
    flux_in = np.append(0.0, 0.25 * face[:-1])
    _, new_R, outflow = step(np.zeros(6), R, rule)
    assert new_R == pytest.approx(R + flux_in - 0.25 * face, abs=1e-15)
    assert outflow == 0.0


@given(data=st.data(), cells=st.integers(1, 40))
def test_what_leaves_the_surface_enters_the_rolling_layer(
    synchronous, rules, piles, gentle, data, cells
):
    rule = replace(data.draw(rules(synchronous)), v=0.0, D=0.0, dry=0.0)
    h, R = data.draw(piles(cells, rule))
    new_h, new_R, _ = step(h, R, gentle(rule, h, R, synchronous.ends), synchronous.ends)
    # A scheme that predicts R for mid-time rounds it there.
    assert np.abs((new_R - R) + (new_h - h)).max() <= 1e-14 * (np.abs(h).max() + R.max() + 1e-300)


@pytest.mark.parametrize("order", ["right", "left"])
def test_in_place_orders_disturb_even_a_uniform_layer_where_the_sweep_begins(order):
    rule = Rule(v=0.2, D=0.1, gamma=0.05, Sc=0.7, d=0.5, dt=0.4, order=order)
    _, R, _ = step(-0.7 * 0.5 * np.arange(50), np.full(50, 3.0), rule, "periodic")
    assert np.abs(R - 3.0).max() > 0.1


@every_order
def test_printed_sign_erodes_even_at_repose(order):
    rule = replace(PAPER, v=0.0, D=0.0, sign="printed", order=order)
    h, R, _ = step(np.array([0.5, 0.0]), np.full(2, 2.0), rule, "open")
    assert h[0] == pytest.approx(0.5 - 0.01 * 2 * (0.5 + 0.5), rel=1e-14)
    assert R[0] == pytest.approx(2 + 0.01 * 2 * (0.5 + 0.5), rel=1e-14)


def test_consistent_sign_erodes_above_repose_and_deposits_below():
    rule = replace(PAPER, v=0.0, D=0.0)
    for slope, direction in [(0.9, -1), (0.5, 0), (0.2, 1)]:
        h, _, _ = step(np.array([slope, 0.0]), np.ones(2), rule)
        assert np.sign(h[0] - slope) == direction


@pytest.mark.parametrize(
    ("order", "drift", "diffusion"),
    [("synchronous", 0.100, 0.145), ("right", 0.125, 0.211), ("left", 0.111, 0.148)],
)
def test_drift_and_diffusion_on_a_frozen_slope_depend_on_the_order(
    moments_of_one_grain, order, drift, diffusion
):
    measured = moments_of_one_grain(replace(PAPER, gamma=0.0, order=order))
    assert measured == pytest.approx((drift, diffusion), abs=5e-4)


def test_in_place_orders_divide_the_drift_by_what_a_cell_keeps(moments_of_one_grain):
    for order, keeps in (("right", 1 - 0.2), ("left", 1 - 0.1)):
        drift, _ = moments_of_one_grain(replace(PAPER, gamma=0.0, order=order))
        assert drift == pytest.approx(0.1 / keeps, rel=1e-10)


@pytest.mark.parametrize(("d", "dt"), [(1.0, 1.0), (0.5, 0.4), (0.25, 0.2)])
def test_synchronous_rule_keeps_the_drift_and_spreads_by_the_effective_diffusion(
    moments_of_one_grain, d, dt
):
    drift, diffusion = moments_of_one_grain(replace(PAPER, gamma=0.0, d=d, dt=dt))
    assert drift == pytest.approx(0.1, rel=1e-10)
    assert diffusion == pytest.approx(0.1 + 0.1 * d / 2 * (1 - 0.1 * dt / d), rel=1e-10)


def test_inputs_are_left_alone(form):
    h, R = np.linspace(9, 0, 10), np.linspace(1, 2, 10)
    before = h.copy(), R.copy()
    step(h, R, replace(PAPER, **form.options()), form.ends)
    assert np.array_equal(h, before[0])
    assert np.array_equal(R, before[1])


@every_order
def test_single_open_cell_only_loses_what_drifts_out(order):
    h, R, outflow = step(np.array([3.0]), np.array([2.0]), replace(PAPER, order=order))
    assert (h[0], R[0], outflow) == pytest.approx((3.0, 1.8, 0.2), rel=1e-15)


@every_order
def test_closed_top_lets_nothing_through(plain_march, order):
    """With no drift, an open pile is a closed box: diffusion alone never carries R out."""
    rule = replace(PAPER, v=0.0, gamma=0.0, order=order)
    start = np.array([4.0, 0.0, 1.0, 0.0, 2.0])
    _, R, outflow = plain_march(np.zeros(5), start, rule, 400, "open")
    assert outflow == 0
    assert pytest.approx(np.full(5, 1.4), rel=1e-6) == R


@pytest.mark.parametrize("ends", ["open", "periodic"])
def test_frozen_slope_erodes_by_the_slope_that_it_is_given(ends):
    """E = gamma R (S0 - Sc), whatever the surface has become."""
    rule = replace(PAPER, v=0.0, D=0.0)
    frozen, R = -1.5 * np.arange(6.0), np.arange(1.0, 7.0)
    h, new_R, _ = step(np.full(6, 9.0), R, rule, ends, frozen)
    eroded = 0.01 * R * (1.5 - 0.5)
    eroded[-1] = 0.0 if ends == "open" else 0.01 * 6 * (-1.5 * 5 - (0.0 - 0.5 * 6) - 0.5)
    assert h == pytest.approx(9.0 - eroded, rel=1e-14)
    assert new_R == pytest.approx(R + eroded, rel=1e-14)


def test_layers_may_grow_beyond_all_numbers_without_a_word():
    with np.errstate(all="ignore"):
        h, R, _ = step(np.array([1e308, -1e308, 0.0]), np.full(3, 1e10), replace(PAPER, gamma=1.0))
    assert not (np.isfinite(h).all() and np.isfinite(R).all())
