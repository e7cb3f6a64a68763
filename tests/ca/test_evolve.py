"""Exactly so many steps, frames at chosen times, and what is refused."""

import math
from dataclasses import replace

import numpy as np
import pytest

from bcre_ca import Pile, Rule, UnstableStep, advance, evolve, evolve_many, frames, march

FIGURE_1 = Rule(v=0.1, D=0.1, gamma=0.01, Sc=0.5, d=1.0, dt=1.0)
FIGURE_2 = Rule(v=2.5, D=0.1, gamma=0.01, Sc=0.5, d=1.0, dt=0.2)


def pulse(slope, cells=100):
    x = np.arange(cells) + 0.5
    return Pile(slope * (cells - x), np.exp(-(((x - 20) / 4) ** 2)))


def test_unstable_step_is_refused_with_the_largest_stable_one():
    start = pulse(0.5)
    with pytest.raises(UnstableStep, match=r"largest stable step is 0\.370") as caught:
        evolve(start.h, start.R, replace(FIGURE_2, dt=1.0), 10)
    assert caught.value.largest == pytest.approx(0.370, abs=5e-4)
    assert isinstance(caught.value, ValueError)
    with pytest.raises(UnstableStep, match=r"largest stable step is 0\.370"):
        evolve_many([start.h] * 2, [start.R] * 2, replace(FIGURE_2, dt=1.0), 10)
    with pytest.raises(UnstableStep, match=r"largest stable step is 0\.370"):
        next(frames(start, FIGURE_2, [10.0], step=4.0))


def test_step_counts_the_deficit_of_a_slope_below_repose():
    with pytest.raises(UnstableStep) as caught:
        evolve(np.zeros(10), np.ones(10), replace(FIGURE_2, dt=0.370), 1)
    assert caught.value.largest == pytest.approx(1 / (2.7 + 0.01 * 0.5), rel=1e-12)


@pytest.mark.parametrize("steps", [0, 5])
@pytest.mark.parametrize("ends", ["open", "periodic"])
def test_evolve_returns_new_arrays_and_leaves_its_inputs_alone(ends, steps):
    h, R = np.linspace(5, 0, 11), np.linspace(0, 1, 11)
    before = h.copy(), R.copy()
    new_h, new_R = evolve(h, R, FIGURE_1, steps, ends)
    assert np.array_equal(h, before[0])
    assert np.array_equal(R, before[1])
    assert not np.shares_memory(new_h, h)
    assert not np.shares_memory(new_R, R)
    assert (np.array_equal(new_h, h) and np.array_equal(new_R, R)) == (steps == 0)


def test_evolve_takes_lists_and_integers():
    h, R = evolve([3, 2, 1], [0, 1, 0], FIGURE_1, 1)
    assert h.dtype == R.dtype == float
    assert pytest.approx([0.1, 0.7 + 0.01 * 0.5, 0.2], rel=1e-14) == R
    assert evolve([3, 2, 1], [0, 1, 0], FIGURE_1, 1.0)[1].tobytes() == R.tobytes()


def test_evolve_takes_exactly_the_steps_asked_for(figure_1):
    h, R = figure_1.h, figure_1.R
    once = evolve(*evolve(h, R, FIGURE_1, 17), FIGURE_1, 23)
    whole = evolve(h, R, FIGURE_1, 40)
    assert once[0].tobytes() == whole[0].tobytes()
    assert once[1].tobytes() == whole[1].tobytes()


def test_advance_counts_steps_time_and_outflow(figure_1):
    pile = advance(figure_1, FIGURE_1, 40)
    again = advance(pile, FIGURE_1, 3)
    assert (pile.steps, pile.t) == (40, 40.0)
    assert (again.steps, again.t) == (43, 43.0)
    assert again.outflow > pile.outflow > 0


@pytest.mark.parametrize(
    ("h", "R", "message"),
    [
        ([1.0, 2.0], [1.0], r"R has shape \((1, )?1,?\): must be that of h, \((1, )?2,?\)"),
        ([], [], r"shape \((1, )?0,?\)"),
        ([[[1.0, 2.0]]], [[[1.0, 2.0]]], r"shape \((1, )?1, 1, 2\)"),
        ([1.0, math.nan], [1.0, 1.0], "finite"),
        ([1.0, 2.0], [1.0, math.inf], "finite"),
        ([0.0, 0.0], [0.0, -0.5], r"R = -0\.5 in cell (1|\(0, 1\)): must be >= 0"),
    ],
)
def test_layers_that_make_no_pile_are_refused(h, R, message):
    with pytest.raises(ValueError, match=message):
        evolve(h, R, FIGURE_1, 1)
    with pytest.raises(ValueError, match=message):
        evolve_many([h], [R], FIGURE_1, 1)


def test_a_plane_is_not_taken_for_a_batch_of_lines_nor_a_line_for_one():
    plane = np.ones((3, 4))
    with pytest.raises(ValueError, match=r"\(3, 4\): evolve takes one line .*evolve_many.* plane"):
        evolve(plane, plane, FIGURE_1, 1)
    with pytest.raises(ValueError, match=r"h has shape \(3, 4\): must be \(N,\)"):
        march(plane, plane, FIGURE_1, 1)
    with pytest.raises(ValueError, match=r"h has shape \(4,\): must be \(piles, N\)"):
        evolve_many(plane[0], plane[0], FIGURE_1, 1)


@pytest.mark.parametrize("steps", [-1, 2.5, True])
def test_steps_that_are_no_number_of_steps_and_unknown_ends_are_refused_by_name(steps):
    for many, call in ((1, evolve), (2, evolve_many)):
        with pytest.raises(ValueError, match=rf"^steps = {steps}: must be a whole number >= 0"):
            call(np.ones((1,) * many), np.ones((1,) * many), FIGURE_1, steps)
        with pytest.raises(ValueError, match=r"^ends = 'closed': must be"):
            call(np.ones((1,) * many), np.ones((1,) * many), FIGURE_1, 1, "closed")


def test_figure_1_runs_to_its_end_with_the_step_that_follows_the_bounds(figure_1):
    piles = list(frames(figure_1, FIGURE_1, np.linspace(0, 3000, 61), step="auto"))
    assert max(pile.R.max() for pile in piles) > 100
    assert min(pile.R.min() for pile in piles) >= 0
    mass = figure_1.mass(1.0)
    assert all(abs(pile.mass(1.0) + pile.outflow - mass) <= 1e-12 * mass for pile in piles)
    assert -np.diff(piles[-1].h)[:-1] == pytest.approx(np.full(98, 0.5), abs=2e-3)


def test_single_small_avalanche_strips_an_even_layer_and_leaves_the_slope():
    start, x = pulse(0.8), np.arange(100) + 0.5
    (end,) = frames(start, FIGURE_2, [400.0], step=0.2)
    slope = -np.polyfit(x[40:95], end.h[40:95], 1)[0]
    assert slope == pytest.approx(0.8, abs=1e-3)
    assert (end.h < start.h)[40:95].all()
