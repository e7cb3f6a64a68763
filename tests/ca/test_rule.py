import math
from dataclasses import replace

import numpy as np
import pytest

from bcre_ca import Rule, UnstableStep

FIGURE_2 = {"v": 2.5, "D": 0.1, "gamma": 0.01, "Sc": 0.5}


def rule(**changes):
    return Rule(**{"v": 0.1, "D": 0.1, "gamma": 0.01, "Sc": 0.5, "d": 1.0, "dt": 1.0} | changes)


@pytest.mark.parametrize("name", ["v", "D", "gamma", "Sc"])
@pytest.mark.parametrize("value", [-0.1, math.nan, math.inf])
def test_coefficients_must_be_finite_and_not_negative(name, value):
    with pytest.raises(ValueError, match=rf"^{name} = {value!r}: must be a finite number >= 0$"):
        rule(**{name: value})


@pytest.mark.parametrize("name", ["d", "dt"])
@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
def test_cell_and_step_must_be_finite_and_positive(name, value):
    with pytest.raises(ValueError, match=rf"^{name} = {value!r}: must be a finite number > 0$"):
        rule(**{name: value})


@pytest.mark.parametrize("name", ["sign", "order"])
def test_unknown_reading_is_refused_with_the_readings_there_are(name):
    with pytest.raises(ValueError, match=rf"^{name} = 'upwards': must be one of \("):
        rule(**{name: "upwards"})


def test_coefficients_are_the_papers_per_cell_and_step():
    folded = rule(v=0.3, D=0.2, gamma=0.05, Sc=0.4, d=0.5, dt=0.25).coefficients()
    assert folded.courant == pytest.approx(0.3 * 0.25 / 0.5, rel=1e-15)
    assert folded.diffusion == pytest.approx(0.2 * 0.25 / 0.5**2, rel=1e-15)
    assert folded.outgoing == folded.courant + folded.diffusion
    assert folded.exchange == pytest.approx(0.05 * 0.25 / 0.5, rel=1e-15)
    assert folded.repose_drop == pytest.approx(0.4 * 0.5, rel=1e-15)


def test_printed_sign_turns_the_repose_slope_round():
    assert rule(sign="printed").coefficients() == rule().coefficients()._replace(repose_drop=-0.5)


def test_figures_2_and_3_are_unstable_at_one_cell_a_step():
    with pytest.raises(UnstableStep) as caught:
        Rule(**FIGURE_2, d=1.0, dt=1.0).require_stable()
    assert caught.value.largest == pytest.approx(1 / 2.7, rel=1e-15)
    assert caught.value.dt == 1.0
    assert "0.37037" in str(caught.value)
    assert "v dt/d + 2 D dt/d^2" in str(caught.value)


def test_largest_stable_step_is_itself_accepted_and_one_percent_more_is_not():
    largest = rule().max_stable_step(30.0, -0.7)
    rule(dt=largest).require_stable(30.0, -0.7)
    with pytest.raises(UnstableStep):
        rule(dt=1.01 * largest).require_stable(30.0, -0.7)


@pytest.mark.parametrize(
    ("largest_R", "smallest_slope", "rate"),
    [
        (0.0, None, 0.1 / 0.5 + 2 * 0.1 / 0.25),
        (0.0, 0.7, 0.1 / 0.5 + 2 * 0.1 / 0.25),
        (0.0, -1.5, 0.1 / 0.5 + 2 * 0.1 / 0.25 + 0.01 * 2.0),
        (100.0, -1.5, 0.01 * 100 / 0.5),
    ],
)
def test_stable_step_is_the_smaller_of_the_two_bounds(largest_R, smallest_slope, rate):
    assert rule(d=0.5).max_stable_step(largest_R, smallest_slope) == pytest.approx(1 / rate)


def test_bound_that_was_passed_is_the_one_that_is_named():
    with pytest.raises(UnstableStep, match=r"gamma R dt/d must not exceed 1 where R = 200"):
        rule().require_stable(200.0)


def test_printed_sign_counts_its_deficit_from_minus_the_repose_slope():
    assert rule(sign="printed").max_stable_step(0.0, -0.5) == rule().max_stable_step()
    assert rule(sign="printed").max_stable_step(0.0, -1.5) == pytest.approx(1 / 0.31)


def test_rule_that_moves_nothing_is_stable_at_any_step():
    assert rule(v=0.0, D=0.0, gamma=0.0).max_stable_step(1e9, -1e9) == math.inf


def test_rule_gives_its_closed_forms_in_physical_units():
    figure_1 = rule(d=0.5, dt=0.25)
    weight = math.sqrt(0.1 / 0.5 + 0.1 / 0.25) - math.sqrt(0.1 / 0.25)
    assert figure_1.second_critical_slope() == pytest.approx(0.5 + weight**2 / 0.01)
    assert figure_1.effective_diffusion() == pytest.approx(0.1 + 0.1 * 0.25 * (1 - 0.05))
    assert figure_1.effective_curvature() == pytest.approx(0.01 * 0.25)
    assert figure_1.effective_curvature(40.0) == pytest.approx(0.01 * 0.25 * (1 - 0.2))


@pytest.mark.parametrize("order", ["right", "left"])
@pytest.mark.parametrize(
    "closed_form", ["second_critical_slope", "effective_diffusion", "effective_curvature"]
)
def test_closed_forms_of_the_synchronous_rule_are_not_offered_for_in_place_orders(
    order, closed_form
):
    with pytest.raises(ValueError, match=f"order = '{order}'"):
        getattr(rule(order=order), closed_form)()


def test_sweep_downhill_counts_what_a_cell_receives_before_it_exchanges():
    """Without diffusion the layer found is R/(1 - v dt/d): gamma R dt/d + v dt/d <= 1."""
    downhill = rule(v=0.4, D=0.0, gamma=0.1, dt=1.0, order="right")
    assert downhill.max_stable_step(6.0) == pytest.approx(1.0)
    assert downhill.max_stable_step(5.0) > 1 > downhill.max_stable_step(7.0)
    with pytest.raises(UnstableStep, match=r"gamma R dt/d \+ v dt/d \+ D dt/d\^2 must not exceed"):
        downhill.require_stable(7.0)
    with pytest.raises(UnstableStep, match=r"v dt/d \+ 2 D dt/d\^2 \+ gamma dt max"):
        replace(downhill, dt=3.0).require_stable(0.0)


@pytest.mark.parametrize("part", [0.97, 1.03])
def test_waves_under_a_sweep_downhill_grow_from_that_bound_on(plain_march, part):
    """At 1.03 of it gamma R dt/d is still 0.62, which the other orders would bear."""
    downhill = rule(v=0.4, D=0.0, gamma=0.1, Sc=0.0, d=1.0, dt=part, order="right")
    R = np.full(64, 6.0)
    R[0] += 6.0 * 0.4 * part / (1 - 0.4 * part)
    start = 1e-9 * np.resize([1.0, -1.0], 64)
    h, _, _ = plain_march(start, R, downhill, 400, "periodic")
    assert (np.abs(h).max() > 10 * np.abs(start).max()) == (part > 1)
