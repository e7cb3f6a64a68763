import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bcre_ca import Rule, step

ORDERS = ("synchronous", "right", "left")


def moments_of_one_grain(rule, steps=60, cells=401):
    """Mean displacement and variance of R per unit time, R released in one inner cell."""
    h, R = np.zeros(cells), np.zeros(cells)
    start = 150
    R[start] = 1.0
    for _ in range(steps):
        h, R, _ = step(h, R, rule)
    distance = rule.d * (np.arange(cells) - start)
    mean = float(distance @ R)
    variance = float(distance**2 @ R) - mean**2
    return mean / (steps * rule.dt), variance / (2 * steps * rule.dt)


def test_one_step_is_the_printed_rule_worked_by_hand():
    rule = Rule(v=0.1, D=0.2, gamma=0.01, Sc=0.5, d=1.0, dt=1.0)
    h, R, outflow = step(np.array([5.0, 3.0, 2.8]), np.array([1.0, 2.0, 4.0]), rule)
    flux = [0.1 * 1 - 0.2 * (2 - 1), 0.1 * 2 - 0.2 * (4 - 2), 0.1 * 4]
    eroded = [0.01 * 1 * (2.0 - 0.5), 0.01 * 2 * (0.2 - 0.5), 0.0]
    assert h == pytest.approx([5 - eroded[0], 3 - eroded[1], 2.8], rel=1e-14)
    assert (
        pytest.approx(
            [
                1 - flux[0] + eroded[0],
                2 + flux[0] - flux[1] + eroded[1],
                4 + flux[1] - flux[2],
            ],
            rel=1e-14,
        )
        == R
    )
    assert outflow == pytest.approx(flux[2], rel=1e-14)


@given(data=st.data())
def test_mass_is_conserved_to_rounding_with_open_and_periodic_ends(cases, data):
    h, R, rule, ends = data.draw(cases())
    new_h, new_R, outflow = step(h, R, rule, ends)
    scale = np.abs(h).sum() + R.sum() + 1e-300
    balance = math.fsum([*new_h, *new_R, outflow, *(-h), *(-R)])
    assert abs(balance) <= 1e-14 * scale
    assert outflow >= 0
    assert ends == "open" or outflow == 0


@given(data=st.data())
def test_rolling_layer_stays_non_negative_under_the_stable_step(cases, data):
    h, R, rule, ends = data.draw(cases(orders=["synchronous"]))
    _, new_R, _ = step(h, R, rule, ends)
    assert new_R.min() >= 0


@given(data=st.data())
def test_what_leaves_the_surface_enters_the_rolling_layer(cases, data):
    h, R, rule, ends = data.draw(cases(orders=["synchronous"]))
    still = Rule(0.0, 0.0, rule.gamma, rule.Sc, rule.d, rule.dt, rule.sign)
    new_h, new_R, _ = step(h, R, still, ends)
    assert np.abs((new_R - R) + (new_h - h)).max() <= 1e-14 * (np.abs(h).max() + R.max() + 1e-300)


def test_uniform_layer_on_the_repose_slope_is_steady_to_rounding():
    rule = Rule(v=0.2, D=0.1, gamma=0.05, Sc=0.7, d=0.5, dt=0.4)
    h0 = -0.7 * 0.5 * np.arange(50)
    R0 = np.full(50, 3.0)
    h, R = h0, R0
    for _ in range(100):
        h, R, _ = step(h, R, rule, "periodic")
    assert np.abs(h - h0).max() < 1e-12
    assert np.abs(R - R0).max() < 1e-12


@pytest.mark.parametrize("order", ["right", "left"])
def test_in_place_orders_disturb_even_a_uniform_layer_where_the_sweep_begins(order):
    rule = Rule(v=0.2, D=0.1, gamma=0.05, Sc=0.7, d=0.5, dt=0.4, order=order)
    _, R, _ = step(-0.7 * 0.5 * np.arange(50), np.full(50, 3.0), rule, "periodic")
    assert np.abs(R - 3.0).max() > 0.1


@pytest.mark.parametrize("order", ORDERS)
def test_printed_sign_erodes_even_at_repose(order):
    rule = Rule(v=0.0, D=0.0, gamma=0.01, Sc=0.5, d=1.0, dt=1.0, sign="printed", order=order)
    h, R, _ = step(np.array([0.5, 0.0]), np.full(2, 2.0), rule, "open")
    assert h[0] == pytest.approx(0.5 - 0.01 * 2 * (0.5 + 0.5), rel=1e-14)
    assert R[0] == pytest.approx(2 + 0.01 * 2 * (0.5 + 0.5), rel=1e-14)


def test_consistent_sign_erodes_above_repose_and_deposits_below():
    rule = Rule(v=0.0, D=0.0, gamma=0.01, Sc=0.5, d=1.0, dt=1.0)
    for slope, direction in [(0.9, -1), (0.5, 0), (0.2, 1)]:
        h, _, _ = step(np.array([slope, 0.0]), np.ones(2), rule)
        assert np.sign(h[0] - slope) == direction


@given(data=st.data(), shift=st.integers(1, 15))
def test_synchronous_rule_is_invariant_under_translation_to_the_bit(data, shift):
    """A bit-exact surface needs Sc = 0: with a tilt, h + Sc x has to be rounded when moved."""
    cells = 16
    layer = st.lists(st.floats(0, 9), min_size=cells, max_size=cells)
    h, R = np.array(data.draw(layer)), np.array(data.draw(layer))
    rule = Rule(v=0.2, D=0.1, gamma=0.03, Sc=0.0, d=1.0, dt=0.7)
    moved_h, moved_R, _ = step(np.roll(h, shift), np.roll(R, shift), rule, "periodic")
    new_h, new_R, _ = step(h, R, rule, "periodic")
    assert np.roll(new_h, shift).tobytes() == moved_h.tobytes()
    assert np.roll(new_R, shift).tobytes() == moved_R.tobytes()


@pytest.mark.parametrize(
    ("order", "drift", "diffusion"),
    [("synchronous", 0.100, 0.145), ("right", 0.125, 0.211), ("left", 0.111, 0.148)],
)
def test_drift_and_diffusion_on_a_frozen_slope_depend_on_the_order(order, drift, diffusion):
    rule = Rule(v=0.1, D=0.1, gamma=0.0, Sc=0.5, d=1.0, dt=1.0, order=order)
    measured_drift, measured_diffusion = moments_of_one_grain(rule)
    assert measured_drift == pytest.approx(drift, abs=5e-4)
    assert measured_diffusion == pytest.approx(diffusion, abs=5e-4)


def test_in_place_orders_divide_the_drift_by_what_a_cell_keeps():
    right = Rule(v=0.1, D=0.1, gamma=0.0, Sc=0.5, d=1.0, dt=1.0, order="right")
    left = Rule(v=0.1, D=0.1, gamma=0.0, Sc=0.5, d=1.0, dt=1.0, order="left")
    assert moments_of_one_grain(right)[0] == pytest.approx(0.1 / (1 - 0.2), rel=1e-10)
    assert moments_of_one_grain(left)[0] == pytest.approx(0.1 / (1 - 0.1), rel=1e-10)


@pytest.mark.parametrize(("d", "dt"), [(1.0, 1.0), (0.5, 0.4), (0.25, 0.2)])
def test_synchronous_rule_keeps_the_drift_and_spreads_by_the_effective_diffusion(d, dt):
    rule = Rule(v=0.1, D=0.1, gamma=0.0, Sc=0.5, d=d, dt=dt)
    drift, diffusion = moments_of_one_grain(rule)
    assert drift == pytest.approx(0.1, rel=1e-10)
    assert diffusion == pytest.approx(0.1 + 0.1 * d / 2 * (1 - 0.1 * dt / d), rel=1e-10)


@pytest.mark.parametrize("ends", ["open", "periodic"])
@pytest.mark.parametrize("order", ORDERS)
def test_inputs_are_left_alone(order, ends):
    h, R = np.linspace(9, 0, 10), np.linspace(1, 2, 10)
    before = h.copy(), R.copy()
    step(h, R, Rule(0.1, 0.1, 0.01, 0.5, 1.0, 1.0, order=order), ends)
    assert np.array_equal(h, before[0])
    assert np.array_equal(R, before[1])


@pytest.mark.parametrize("order", ORDERS)
def test_single_open_cell_only_loses_what_drifts_out(order):
    rule = Rule(v=0.1, D=0.1, gamma=0.01, Sc=0.5, d=1.0, dt=1.0, order=order)
    h, R, outflow = step(np.array([3.0]), np.array([2.0]), rule)
    assert (h[0], R[0], outflow) == pytest.approx((3.0, 1.8, 0.2), rel=1e-15)


@pytest.mark.parametrize("order", ORDERS)
def test_closed_top_lets_nothing_through(order):
    """With no drift, an open pile is a closed box: diffusion alone never carries R out."""
    rule = Rule(v=0.0, D=0.1, gamma=0.0, Sc=0.5, d=1.0, dt=1.0, order=order)
    h, R = np.zeros(5), np.array([4.0, 0.0, 1.0, 0.0, 2.0])
    for _ in range(400):
        h, R, outflow = step(h, R, rule)
        assert outflow == 0
    assert pytest.approx(np.full(5, 1.4), rel=1e-6) == R
