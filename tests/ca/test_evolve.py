import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bcre_ca import Pile, Rule, UnstableStep, advance, evolve, frames, largest_stable_step

FIGURE_1 = Rule(v=0.1, D=0.1, gamma=0.01, Sc=0.5, d=1.0, dt=1.0)


def figure_1(excess=3.2):
    x = np.arange(100) + 0.5
    return Pile((0.5 + excess) * (100 - x), np.exp(-(((x - 85) / 3) ** 2)))


def test_unstable_step_is_refused_with_the_largest_stable_one():
    rule = Rule(v=2.5, D=0.1, gamma=0.01, Sc=0.5, d=1.0, dt=1.0)
    x = np.arange(100) + 0.5
    with pytest.raises(UnstableStep, match=r"largest stable step is 0\.370") as caught:
        evolve(0.5 * (100 - x), np.exp(-(((x - 20) / 4) ** 2)), rule, 10)
    assert caught.value.largest == pytest.approx(0.370, abs=5e-4)
    assert isinstance(caught.value, ValueError)


def test_step_counts_the_deficit_of_a_slope_below_repose():
    rule = Rule(v=2.5, D=0.1, gamma=0.01, Sc=0.5, d=1.0, dt=0.370)
    h = np.zeros(10)
    with pytest.raises(UnstableStep) as caught:
        evolve(h, np.ones(10), rule, 1)
    assert caught.value.largest == pytest.approx(1 / (2.7 + 0.01 * 0.5), rel=1e-12)


def test_periodic_ends_count_the_slope_across_the_ends():
    rule = Rule(v=0.1, D=0.1, gamma=0.1, Sc=0.5, d=1.0, dt=1.0)
    pile = Pile(np.array([3.0, 2.0, 1.0]), np.ones(3))
    across = (1.0 - (3.0 - 0.5 * 3)) / 1.0
    assert largest_stable_step(pile, rule, "open") == pytest.approx(1 / 0.3)
    assert largest_stable_step(pile, rule, "periodic") == pytest.approx(
        1 / (0.3 + 0.1 * (0.5 - across))
    )


@pytest.mark.parametrize("ends", ["open", "periodic"])
def test_evolve_returns_new_arrays_and_leaves_its_inputs_alone(ends):
    h, R = np.linspace(5, 0, 11), np.ones(11)
    before = h.copy(), R.copy()
    new_h, new_R = evolve(h, R, FIGURE_1, 5, ends)
    assert np.array_equal(h, before[0])
    assert np.array_equal(R, before[1])
    assert not np.shares_memory(new_h, h)
    assert not np.shares_memory(new_R, R)


def test_no_steps_give_equal_but_new_arrays():
    h, R = np.linspace(5, 0, 11), np.ones(11)
    new_h, new_R = evolve(h, R, FIGURE_1, 0)
    assert np.array_equal(new_h, h)
    assert np.array_equal(new_R, R)
    assert not np.shares_memory(new_R, R)


def test_evolve_takes_lists_and_integers():
    h, R = evolve([3, 2, 1], [0, 1, 0], FIGURE_1, 1)
    assert h.dtype == R.dtype == float
    assert pytest.approx([0.1, 0.7 + 0.01 * 0.5, 0.2], rel=1e-14) == R


def test_evolve_takes_exactly_the_steps_asked_for():
    h, R = figure_1().h, figure_1().R
    once = evolve(*evolve(h, R, FIGURE_1, 17), FIGURE_1, 23)
    whole = evolve(h, R, FIGURE_1, 40)
    assert once[0].tobytes() == whole[0].tobytes()
    assert once[1].tobytes() == whole[1].tobytes()


def test_advance_counts_steps_time_and_outflow():
    pile = advance(figure_1(), FIGURE_1, 40)
    again = advance(pile, FIGURE_1, 3)
    assert (pile.steps, pile.t) == (40, 40.0)
    assert (again.steps, again.t) == (43, 43.0)
    assert again.outflow > pile.outflow > 0


@pytest.mark.parametrize(
    ("h", "R", "message"),
    [
        ([1.0, 2.0], [1.0], r"shape \(2,\), R \(1,\)"),
        ([], [], r"shape \(0,\)"),
        ([[[1.0, 2.0]]], [[[1.0, 2.0]]], r"shape \(1, 1, 2\)"),
        ([1.0, math.nan], [1.0, 1.0], "finite"),
        ([1.0, 2.0], [1.0, math.inf], "finite"),
    ],
)
def test_layers_that_make_no_pile_are_refused(h, R, message):
    with pytest.raises(ValueError, match=message):
        evolve(h, R, FIGURE_1, 1)


def test_negative_steps_and_unknown_ends_are_refused_by_name():
    with pytest.raises(ValueError, match=r"^steps = -1: must be a whole number >= 0"):
        evolve([1.0], [1.0], FIGURE_1, -1)
    with pytest.raises(ValueError, match=r"^ends = 'closed': must be"):
        evolve([1.0], [1.0], FIGURE_1, 1, "closed")


def test_figure_1_outgrows_a_fixed_step_and_says_in_which_cell():
    with pytest.raises(FloatingPointError, match=r"in cell \d+: .*gamma R dt/d must not exceed 1"):
        list(frames(figure_1(), FIGURE_1, [400.0, 800.0], step=1.0))


def test_figure_1_runs_to_its_end_with_the_step_that_follows_the_bounds():
    start = figure_1()
    piles = list(frames(start, FIGURE_1, np.linspace(0, 3000, 61), step="auto"))
    assert max(pile.R.max() for pile in piles) > 100
    assert min(pile.R.min() for pile in piles) >= 0
    mass = start.mass(1.0)
    assert all(abs(pile.mass(1.0) + pile.outflow - mass) <= 1e-12 * mass for pile in piles)
    assert -np.diff(piles[-1].h)[:-1] == pytest.approx(np.full(98, 0.5), abs=2e-3)


@pytest.mark.parametrize("step", ["auto", 0.9, 0.37])
def test_frames_hit_their_times_exactly(step):
    times = [0.0, 0.1, 1.0, math.pi, 10.0, 12.3456789, 100.0]
    piles = list(frames(figure_1(), FIGURE_1, times, step=step))
    assert [pile.t for pile in piles] == times
    assert piles[0].R.tobytes() == figure_1().R.tobytes()
    assert all(earlier.steps < later.steps for earlier, later in pairwise(piles))


def test_frames_at_whole_steps_are_the_states_of_evolve_to_the_bit():
    start = figure_1()
    rule = Rule(v=0.1, D=0.1, gamma=0.01, Sc=0.5, d=1.0, dt=0.5)
    for pile in frames(start, rule, [5.0, 20.0, 60.0], step=0.5):
        h, R = evolve(start.h, start.R, rule, pile.steps)
        assert pile.steps == round(pile.t / 0.5)
        assert pile.h.tobytes() == h.tobytes()
        assert pile.R.tobytes() == R.tobytes()


def test_fixed_step_is_shortened_as_little_as_makes_the_times_fall_on_steps():
    (pile,) = frames(figure_1(), FIGURE_1, [10.0], step=0.3)
    assert pile.steps == 34


def test_fixed_step_that_is_unstable_at_the_start_is_refused():
    with pytest.raises(UnstableStep, match=r"largest stable step is 3\.33333"):
        next(frames(figure_1(), FIGURE_1, [10.0], step=4.0))


def test_step_that_follows_the_bounds_shrinks_as_the_avalanche_grows():
    piles = list(frames(figure_1(), FIGURE_1, [50.0, 100.0, 250.0, 300.0], step="auto"))
    bounds = [largest_stable_step(pile, FIGURE_1, "open") for pile in piles]
    assert bounds[0] == pytest.approx(1 / 0.3, rel=1e-6)
    assert bounds[-1] < 1.2
    early = piles[1].steps - piles[0].steps
    late = piles[3].steps - piles[2].steps
    assert late > 2 * early


def test_step_that_follows_the_bounds_takes_four_fifths_of_the_bound():
    """Early in figure 1 R is small and its bound is constant, so that the step is known."""
    (followed,) = frames(figure_1(), FIGURE_1, [80.0], step="auto")
    (fixed,) = frames(figure_1(), FIGURE_1, [80.0], step=0.8 / 0.3)
    assert followed.steps == fixed.steps == 30
    assert pytest.approx(fixed.R, rel=1e-9) == followed.R


@settings(max_examples=40)
@given(data=st.data(), until=st.floats(0.1, 50))
def test_step_that_follows_the_bounds_keeps_mass_and_sign_of_any_pile(cases, data, until):
    """Below 1e-300 the products of the rule round to multiples of 5e-324, of either sign."""
    h, R, rule, ends = data.draw(cases(orders=["synchronous"], signs=["consistent"], most=20))
    (end,) = frames(Pile(h, R), rule, [until], ends, "auto")
    scale = rule.d * (np.abs(h).sum() + R.sum()) + 1e-300
    assert abs(end.mass(rule.d) + end.outflow - Pile(h, R).mass(rule.d)) <= 1e-12 * scale
    assert end.R.min() >= -1e-300
    assert end.t == until


def test_single_small_avalanche_strips_an_even_layer_and_leaves_the_slope():
    rule = Rule(v=2.5, D=0.1, gamma=0.01, Sc=0.5, d=1.0, dt=0.2)
    x = np.arange(100) + 0.5
    pile = Pile(0.8 * (100 - x), np.exp(-(((x - 20) / 4) ** 2)))
    (end,) = frames(pile, rule, [400.0], step=0.2)
    slope = -np.polyfit(x[40:95], end.h[40:95], 1)[0]
    assert slope == pytest.approx(0.8, abs=1e-3)
    assert (end.h < pile.h)[40:95].all()


@pytest.mark.parametrize("steps", [2.5, True])
def test_steps_must_be_a_whole_number(steps):
    with pytest.raises(ValueError, match=r"steps = .*whole number"):
        evolve(np.zeros(3), np.zeros(3), Rule(0.1, 0.1, 0.01, 0.5, 1.0, 0.4), steps)


def test_negative_layer_is_refused_with_its_value():
    with pytest.raises(ValueError, match=r"R = -0.5: must be >= 0"):
        evolve(np.zeros(3), np.array([0.0, -0.5, 0.0]), Rule(0.1, 0.1, 0.01, 0.5, 1.0, 0.4), 1)


def test_evolve_refuses_an_end_that_outgrew_the_step_though_it_is_finite():
    x = np.arange(100) + 0.5
    h, R = 3.7 * (100 - x), np.exp(-(((x - 85) / 3) ** 2))
    with pytest.raises(FloatingPointError, match="outgrew the step"):
        evolve(h, R, Rule(0.1, 0.1, 0.01, 0.5, 1.0, 1.0), 320)


def test_frames_do_not_change_a_fixed_step():
    x = np.arange(50) + 0.5
    start = Pile(0.48 * (50 - x), np.exp(-(((x - 20) / 4) ** 2)))
    rule = Rule(2.5, 0.1, 0.01, 0.5, 1.0, 0.2)
    (whole,) = frames(start, rule, [8.0], step=0.2)
    *_, often = frames(start, rule, [2.0, 4.0, 6.0, 8.0], step=0.2)
    assert whole.steps == often.steps == 40
    assert np.abs(whole.R - often.R).max() == 0
    *_, between = frames(start, rule, [0.7, 8.0], step=0.2)
    assert between.steps == 41
    assert between.R.sum() == pytest.approx(whole.R.sum(), rel=1e-3)
