"""Mass, sign and the bounds of the step, of every scheme with every term."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bcre_ca import Pile, Rule, advance, largest_stable_step, step


@settings(max_examples=8)
@given(data=st.data(), cells=st.integers(1, 60), steps=st.integers(1, 200))
def test_mass_with_what_left_is_conserved_to_1e_13(form, rules, piles, bound, data, cells, steps):
    rule = data.draw(rules(form))
    pile = Pile(*data.draw(piles(cells, rule)))
    scale = rule.d * (np.abs(pile.h).sum() + pile.R.sum())
    mass = pile.mass(rule.d)
    for _ in range(steps):
        dt = min(0.9 * bound(pile.h, pile.R, rule, form.ends), 10.0)
        pile = advance(pile, replace(rule, dt=dt), 1, form.ends)
        if np.abs(pile.R).max() > 1e6 * scale:
            break
        scale = max(scale, rule.d * (np.abs(pile.h).sum() + np.abs(pile.R).sum()))
        assert abs(pile.mass(rule.d) + pile.outflow - mass) <= 1e-13 * scale
    assert form.ends == "open" or pile.outflow == 0


@settings(max_examples=60)
@given(data=st.data(), cells=st.integers(1, 8))
def test_rolling_layer_stays_non_negative_close_under_the_bound(
    synchronous, rules, piles, bound, data, cells
):
    """Spiky layers, and dt anew at 0.999 of the bound for each of the steps."""
    rule = data.draw(rules(synchronous))
    h, R = data.draw(piles(cells, rule))
    for _ in range(12):
        dt = 0.999 * bound(h, R, rule, synchronous.ends)
        if not dt < 1e6:
            break
        h, R, _ = step(h, R, replace(rule, dt=dt), synchronous.ends)
        assert R.min() >= 0


@pytest.mark.parametrize(
    ("options", "part"),
    [({"dry": 1e-30}, 1.0), ({"scheme": "limited", "v_up": 1e9, "dry": 1e-30}, 0.5)],
    ids=["upwind", "limited"],
)
def test_curvature_at_the_open_foot_shortens_the_step(options, part):
    """The surface goes on at repose, so that it bends by all of S - Sc there: kappa (S - Sc)/d."""
    rule = Rule(v=0.1, D=0.0, gamma=0.0, Sc=0.5, d=0.5, dt=1.0, kappa=0.2, **options)
    h, R = -2.5 * 0.5 * np.arange(6), np.full(6, 1e-9)
    sink = 0.2 * (2.5 - 0.5) / 0.5
    largest = largest_stable_step(Pile(h, R), rule, "open")
    assert largest == pytest.approx(part / (0.2 + sink), rel=1e-6)


def test_cell_at_the_open_foot_is_overdrawn_beyond_that_step():
    rule = Rule(v=0.1, D=0.0, gamma=0.0, Sc=0.5, d=0.5, dt=1.0, kappa=0.2)
    h, R = np.array([0.0, -1.25]), np.array([0.0, 1.0])
    largest = 1 / (0.1 / 0.5 + 0.2 * (2.5 - 0.5) / 0.5)
    for part, negative in ((0.99, False), (1.01, True)):
        assert (step(h, R, replace(rule, dt=part * largest))[1].min() < 0) == negative


@pytest.mark.parametrize(("part", "negative"), [(0.999, False), (1.02, True)])
@pytest.mark.parametrize("v", [0.0, 0.2, 3.0])
@pytest.mark.parametrize("scheme", ["upwind", "calibrated"])
def test_lone_spike_is_overdrawn_from_the_bound_on(scheme, v, part, negative):
    rule = Rule(v=v, D=0.3, gamma=0.0, Sc=0.0, d=1.0, dt=1.0, scheme=scheme)
    R = np.array([0.0, 0.0, 1.0, 0.0, 0.0])
    rule = replace(rule, dt=part * rule.max_stable_step())
    assert (step(np.zeros(5), R, rule)[1].min() < 0) == negative


def test_limited_layer_at_a_face_is_kept_from_falling_below_zero():
    """R + r/2 is 0 before the step is taken to mid-time, and what settles until then comes off."""
    rule = Rule(v=0.01, D=0.0, gamma=0.1, Sc=0.5, d=1.0, dt=1.0, scheme="limited")
    h, R = np.zeros(6), np.array([0.0, 0.6, 0.1, 0.0, 0.0, 0.0])
    rule = replace(rule, dt=0.999 * rule.max_stable_step(0.6, 0.0))
    _, new_R, _ = step(h, R, rule)
    assert new_R[3] == 0
    assert (new_R[1:3] > 0).all()


@settings(max_examples=25)
@given(data=st.data(), cells=st.integers(1, 30))
def test_bound_found_by_compiled_code_is_that_found_by_numpy(
    form, rules, piles, bound, data, cells
):
    rule = data.draw(rules(form))
    h, R = data.draw(piles(cells, rule))
    found = largest_stable_step(Pile(h, R), rule, form.ends)
    assert found == pytest.approx(bound(h, R, rule, form.ends), rel=1e-12)


def test_periodic_ends_count_the_slope_across_the_ends():
    rule = Rule(v=0.1, D=0.1, gamma=0.1, Sc=0.5, d=1.0, dt=1.0)
    pile = Pile(np.array([3.0, 2.0, 1.0]), np.ones(3))
    deficit = 0.5 - (1.0 - (3.0 - 0.5 * 3))
    assert largest_stable_step(pile, rule, "open") == pytest.approx(1 / 0.3)
    assert largest_stable_step(pile, rule, "periodic") == pytest.approx(1 / (0.3 + 0.1 * deficit))


def test_layers_that_are_not_finite_have_no_stable_step():
    rule = Rule(0.1, 0.1, 0.01, 0.5, 1.0, 1.0)
    for spoilt in (math.nan, math.inf, -math.inf):
        for h, R in (([0.0, spoilt], [1.0, 1.0]), ([0.0, 1.0], [1.0, spoilt])):
            assert math.isnan(largest_stable_step(Pile(np.array(h), np.array(R)), rule, "open"))


def test_bounds_of_the_schemes_are_as_stated():
    """c = v dt/d, b = D dt/d^2, s = sink dt; X the layer that exchanges."""
    terms = {"v": 0.4, "D": 0.1, "gamma": 0.05, "Sc": 0.5, "d": 0.5, "dt": 1.0}
    for options, weight in (
        ({"scheme": "upwind"}, lambda c, b, s: c + 2 * b + s),
        ({"scheme": "calibrated"}, lambda c, b, s: max(c + s, c * c + 2 * b + s)),
        ({"scheme": "limited"}, lambda c, b, s: 2 * (c + 2 * b + s)),
    ):
        rule = Rule(**terms, **options)
        for slope in (0.5, -1.5, -30.0):
            dt = rule.max_stable_step(0.0, slope)
            c, b, s = 0.4 * dt / 0.5, 0.1 * dt / 0.25, 0.05 * (0.5 - slope) * dt
            assert weight(c, b, s) == pytest.approx(1, rel=1e-12)
    for options, weight in (
        ({"scheme": "upwind"}, lambda k, m: k + 2 * m),
        ({"scheme": "calibrated"}, lambda k, m: k * k + 2 * m),
        ({"scheme": "limited"}, lambda k, m: k + 2 * m),
    ):
        rule = Rule(**terms, **options, kappa=0.01, v_up=2.0)
        R = 3000.0
        X = R / (1 + 0.05 * R / 2.0)
        dt = rule.max_stable_step(R)
        thick = replace(rule, v=0.0, D=0.0).max_stable_step(R)
        assert weight(0.05 * X * thick / 0.5, 0.01 * X * thick / 0.25) == pytest.approx(1)
        assert dt <= thick


@pytest.mark.parametrize(("part", "grows"), [(0.97, False), (1.03, True)])
@pytest.mark.parametrize(
    ("scheme", "kappa"), [("upwind", 0.0), ("upwind", 0.02), ("calibrated", 0.0)]
)
def test_surface_waves_grow_from_the_second_bound_on(plain_march, scheme, kappa, part, grows):
    """The shortest wave, 1e-9 high, under a layer so thick that gamma X dt/d alone is the limit."""
    rule = Rule(v=0.0, D=0.0, gamma=0.1, Sc=0.0, d=1.0, dt=1.0, scheme=scheme, kappa=kappa)
    R = np.full(64, 50.0)
    start = 1e-9 * np.resize([1.0, -1.0], 64)
    largest = rule.max_stable_step(50.0)
    h, _, _ = plain_march(start, R, replace(rule, dt=part * largest), 400, "periodic")
    assert (np.abs(h).max() > 10 * np.abs(start).max()) == grows


@pytest.mark.parametrize("order", ["right", "left"])
def test_sweep_uphill_may_overdraw_a_cell_within_the_bound_and_one_downhill_does_not(bound, order):
    """Uphill, the slope is seen after sand was laid down just below it."""
    rule = Rule(v=0.75, D=0.0, gamma=5.7, Sc=0.5, d=1.0, dt=1.0, order=order)
    h, R = np.array([0.058, 0.045, -0.051]), np.array([0.288, 0.114, 0.148])
    dt = 0.999 * bound(h, R, rule, "open")
    _, new_R, _ = step(h, R, replace(rule, dt=dt))
    assert (new_R.min() < 0) == (order == "left")
