"""The cut-off: a layer that is thinner than ``dry``, and stays so, comes to rest."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bcre_ca import Pile, Rule, advance, step


@settings(max_examples=25)
@given(data=st.data(), cells=st.integers(1, 30))
def test_step_moves_what_is_thinner_than_the_cut_off_and_does_not_grow_past_it_into_the_surface(
    form, rules, piles, bound, data, cells
):
    rule = data.draw(rules(form))
    h, R = data.draw(piles(cells, rule))
    dt = min(0.5 * bound(h, R, rule, form.ends), 10.0)
    exact = replace(rule, dt=dt, dry=0.0)
    dry = data.draw(st.sampled_from([0.1, 0.5, 2.0])) * (R.max() + 1e-6)
    flowing_h, flowing_R, outflow = step(h, R, exact, form.ends)
    new_h, new_R, new_outflow = step(h, R, replace(exact, dry=dry), form.ends)
    K = exact.coefficients()
    leaving = K.outgoing + (K.diffusion or 0.0)
    coming = R + (1 / leaving if leaving else 1.0) * (flowing_R - R)
    thin = (flowing_R < dry) & (coming < dry)
    assert np.array_equal(new_R, np.where(thin, 0.0, flowing_R))
    assert np.array_equal(new_h, flowing_h + np.where(thin, flowing_R, 0.0))
    assert new_outflow == outflow


@settings(max_examples=20)
@given(seed=st.integers(0, 1000), exponent=st.floats(-12, -2))
@pytest.mark.parametrize("scheme", ["upwind", "calibrated"])
@pytest.mark.parametrize("dt", [0.8, 0.1])
def test_without_exchange_what_comes_to_rest_is_a_few_cut_offs_a_cell_in_however_many_steps(
    plain_march, dt, scheme, seed, exponent
):
    dry, steps = 10**exponent, round(60 / dt)
    rule = Rule(v=0.5, D=0.1, gamma=0.0, Sc=0.5, d=1.0, dt=dt, scheme=scheme)
    rng = np.random.default_rng(seed)
    R = np.where(rng.random(80) < 0.5, 0.0, 10 ** rng.uniform(-14, 0, 80))
    _, exact_R, exact_outflow = plain_march(np.zeros(80), R, rule, steps, "open")
    h, cut_R, outflow = plain_march(np.zeros(80), R, replace(rule, dry=dry), steps, "open")
    missing = exact_R - cut_R
    assert missing.min() >= -1e-15
    assert h.min() >= 0
    assert h.max() <= 10 * dry
    assert missing.sum() + exact_outflow - outflow == pytest.approx(h.sum(), abs=1e-13)


FIGURES = {"figure 2": (20, 20.0), "figure 3": (50, 10.0)}
CUT = Rule(v=2.5, D=0.0, gamma=0.01, Sc=0.5, d=1.0, dt=0.2, kappa=1e-9, v_up=1e9, dry=1e-300)


@pytest.mark.parametrize("dry", [1e-2, 1e-3, 1e-5])
@pytest.mark.parametrize("figure", FIGURES)
def test_cut_off_has_a_limit_as_the_step_falls_and_differs_by_a_few_of_it(figure, dry):
    """Below repose no disturbance grows. A cell that gains less than the cut-off in a step fills
    all the same."""
    x, (place, until) = np.arange(100) + 0.5, FIGURES[figure]
    start = Pile(0.48 * (100 - x), np.exp(-(((x - place) / 4) ** 2)))
    missing = {}
    for dt in (0.2, 0.02, 0.004, 0.002, 0.001):
        exact, cut = (
            advance(start, replace(CUT, dt=dt, dry=thickness), round(until / dt))
            for thickness in (CUT.dry, dry)
        )
        assert np.abs(exact.R - cut.R).max() <= 6 * dry
        assert np.abs(exact.h - cut.h).max() <= 2 * dry
        missing[dt] = math.fsum(exact.R - cut.R)
    assert 0 < missing[0.001] <= 100 * dry
    assert all(abs(missing[dt] - missing[0.001]) <= 100 * dry * dt for dt in missing)


def test_pulse_with_a_cut_off_comes_to_rest_and_then_costs_nothing():
    """A thousand million further steps are none where all is dry."""
    rule = Rule(v=0.5, D=0.0, gamma=0.2, Sc=0.5, d=1.0, dt=0.8, kappa=1e-6, v_up=1e9, dry=1e-6)
    x = np.arange(300) + 0.5
    start = Pile(0.3 * (300 - x), np.exp(-(((x - 50) / 4) ** 2)))
    at_rest = advance(start, rule, 2000)
    assert not at_rest.R.any()
    assert at_rest.outflow == 0
    later = advance(at_rest, rule, 10**9)
    assert later.h.tobytes() == at_rest.h.tobytes()
    assert math.fsum(later.h) == pytest.approx(math.fsum(start.h) + math.fsum(start.R), rel=1e-14)
    assert advance(start, replace(rule, dry=1e-300), 2000).R.any()
