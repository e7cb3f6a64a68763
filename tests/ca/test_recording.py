"""Looking at a run does not change it."""

import math
from dataclasses import astuple, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bcre_ca import BLOCK, Pile, Rule, advance, evolve, frames, largest_stable_step

FIGURE_1 = Rule(v=0.1, D=0.1, gamma=0.01, Sc=0.5, d=1.0, dt=1.0)
X = np.arange(100) + 0.5
PULSE = np.exp(-(((X - 85) / 3) ** 2))


def bits(pile):
    """All that a pile holds."""
    h, R, *numbers = astuple(pile)
    return h.tobytes(), R.tobytes(), *numbers


def assert_same_at_common_times(start, rule, one, other, ends, step):
    found = [
        dict(zip(times, frames(start, rule, times, ends, step), strict=True))
        for times in (one, other)
    ]
    for time in set(one) & set(other):
        assert bits(found[0][time]) == bits(found[1][time])


times = st.lists(st.floats(0, 1), min_size=1, max_size=30).map(sorted)


@settings(max_examples=60)
@given(data=st.data(), cells=st.integers(1, 200), one=times, other=times, common=times)
@pytest.mark.parametrize("step", ["auto", "fixed"])
@pytest.mark.parametrize("index", [0, 1])
def test_any_two_sets_of_frames_give_the_same_state_at_common_times(
    forms, rules, piles, index, step, data, cells, one, other, common
):
    """Over many blocks or within one; whole steps among the times or none."""
    rule, ends = replace(data.draw(rules(forms[index])), sign="consistent"), forms[index].ends
    start = Pile(*data.draw(piles(cells, rule)))
    dt = min(0.5 * largest_stable_step(start, rule, ends), 10.0)
    span = dt * data.draw(st.sampled_from([0.3, 7.0, BLOCK, 3.7 * BLOCK]))
    sets = [sorted({span * share for share in chosen + common}) for chosen in (one, other)]
    if step == "auto":
        assert_same_at_common_times(start, rule, *sets, ends, step)
        return
    sets[1] += [dt * n for n in range(math.floor(sets[1][-1] / dt) + 1, 2 * BLOCK)]
    try:
        assert_same_at_common_times(start, rule, *sets, ends, dt)
    except FloatingPointError:
        until = max(sets[0][-1], sets[1][-1])
        for chosen in sets:
            with pytest.raises(FloatingPointError, match="the avalanche outgrew the step"):
                list(frames(start, rule, [*chosen, until], ends, dt))


@pytest.mark.parametrize("step", ["auto", 0.37, 0.9])
def test_growing_avalanche_is_the_same_however_often_it_is_looked_at(figure_1, step):
    (last,) = frames(figure_1, FIGURE_1, [250.0], step=step)
    for many in (2, 26, 2501):
        *_, end = frames(figure_1, FIGURE_1, np.linspace(0, 250, many), step=step)
        assert bits(end) == bits(last)


def test_runs_of_many_blocks_taken_again_are_the_same_however_often_they_are_looked_at():
    rule = replace(FIGURE_1, gamma=0.2)
    x = np.arange(200) + 0.5
    start = Pile(1.5 * (200 - x), 1e-3 * np.exp(-(((x - 150) / 3) ** 2)))
    seldom = list(frames(start, rule, [20.0, 150.0]))
    often = list(frames(start, rule, np.linspace(0, 150, 301)))
    assert [bits(pile) for pile in seldom] == [bits(often[40]), bits(often[300])]
    assert seldom[-1].redone > 0


@pytest.mark.parametrize("step", ["auto", 0.9])
def test_frames_hit_their_times_and_keep_mass_and_sign_between_the_steps(figure_1, step):
    wanted = [0.0, 0.1, 1.0, math.pi, 10.0, 12.3456789, *np.linspace(13, 200, 301)]
    piles = list(frames(figure_1, FIGURE_1, wanted, step=step))
    assert [pile.t for pile in piles] == wanted
    assert bits(piles[0]) == bits(figure_1)
    mass = figure_1.mass(1.0)
    for pile in piles:
        assert abs(pile.mass(1.0) + pile.outflow - mass) <= 1e-13 * mass
        assert pile.R.min() >= 0


def test_frames_at_whole_steps_are_the_states_of_evolve_to_the_bit(figure_1):
    rule = replace(FIGURE_1, dt=0.1)
    for pile in frames(figure_1, rule, [0.3, 5.0, 6.4, 20.0, 60.0], step=0.1):
        h, R = evolve(figure_1.h, figure_1.R, rule, pile.steps)
        assert pile.steps == round(pile.t / 0.1)
        assert pile.h.tobytes() == h.tobytes()
        assert pile.R.tobytes() == R.tobytes()


def test_frame_between_two_steps_lies_on_the_line_between_them(figure_1):
    rule = replace(FIGURE_1, dt=0.4)
    before, after = (advance(figure_1, rule, steps) for steps in (100, 101))
    piles = frames(figure_1, rule, [40.0, 40.1, 40.3], step=0.4)
    for pile, share in zip(piles, (0.0, 0.25, 0.75), strict=True):
        for name in ("h", "R", "outflow"):
            line = (1 - share) * getattr(before, name) + share * getattr(after, name)
            assert getattr(pile, name) == pytest.approx(line, rel=1e-12, abs=1e-14)
        assert pile.steps == (101 if share else 100)


def test_no_fixed_step_begins_after_the_last_time(figure_1):
    for until, steps in ((10.0, 34), (9.9, 33), (9.90001, 34), (0.0, 0)):
        assert next(frames(figure_1, FIGURE_1, [until], step=0.3)).steps == steps


def test_pile_at_rest_is_the_same_at_every_later_time():
    terms = {"kappa": 1e-6, "v_up": 1e9, "dry": 1e-6}
    rule = Rule(0.5, 0.0, 0.2, 0.5, 1.0, 0.5, scheme="limited", **terms)
    start = Pile(0.3 * (100 - X), PULSE)
    for step in ("auto", 0.5):
        early, late = frames(start, rule, [2000.0, 1e12], step=step)
        assert not early.R.any()
        assert late.h.tobytes() == early.h.tobytes()
        assert late.outflow == early.outflow
    assert late.steps == 2 * 10**12


def test_rule_by_which_nothing_moves_leaves_all_as_it_is():
    start = Pile(0.3 * (100 - X), PULSE)
    (end,) = frames(start, Rule(0.0, 0.0, 0.0, 0.5, 1.0, 1.0, order="right"), [1e6])
    assert end.R.tobytes() == start.R.tobytes()


@pytest.mark.parametrize("many", [2, 11, 701])
def test_step_that_is_outgrown_is_refused_however_often_the_run_is_looked_at(many):
    """By t = 6000 the avalanche is over and the step stable again."""
    start = Pile(2.4 * (100 - X), PULSE)
    (end,) = frames(start, FIGURE_1, [6000.0])
    assert largest_stable_step(end, FIGURE_1, "open") > 1.0
    message = "the avalanche outgrew the step at t = 641, in cell 33: .* where R = 100.7"
    with pytest.raises(FloatingPointError, match=message):
        list(frames(start, FIGURE_1, np.linspace(0, 6000, many), step=1.0))
    with pytest.raises(FloatingPointError, match=message):
        evolve(start.h, start.R, FIGURE_1, 6000)


def test_times_must_ascend_from_that_of_the_pile(figure_1):
    for wanted in ([2.0, 1.0], [-1.0], [math.nan], [1.0, math.inf]):
        with pytest.raises(ValueError, match=r"times = \[.*\]: must ascend from t = 0"):
            frames(figure_1, FIGURE_1, wanted)
