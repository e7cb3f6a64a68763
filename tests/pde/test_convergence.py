import itertools
import math
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bcre_pde import error_of_finest, grid_convergence_index
from bcre_pde.convergence import changes, jump_stands


def test_grid_convergence_index_of_the_textbook_example():
    """Roache's pressure recovery: f = 0.97050, 0.96854, 0.96178 on grids of ratio 2."""
    order, error = grid_convergence_index(0.97050, 0.96854, 0.96178)
    assert order == pytest.approx(1.78617, abs=5e-6)
    assert error / 0.97050 == pytest.approx(0.10308e-2, abs=5e-8)


@given(
    limit=st.floats(-10, 10),
    size=st.floats(0.01, 5),
    order=st.floats(0.6, 4.9),
    ratio=st.floats(1.5, 3),
)
def test_pure_power_law_gives_its_order_and_five_quarters_of_its_error(limit, size, order, ratio):
    fine, medium, coarse = (limit + size * ratio ** (order * k) for k in range(3))
    found = grid_convergence_index(fine, medium, coarse, ratio)
    assert found.order == pytest.approx(order, abs=1e-6)
    assert found.error == pytest.approx(1.25 * size, rel=1e-5)


def test_profile_is_judged_by_its_mean_absolute_change():
    fine, change = np.zeros(4), np.array([1.0, -1.0, 1.0, -1.0])
    order, error = grid_convergence_index(fine, fine + change, fine + 5 * change)
    assert order == pytest.approx(2.0)
    assert error == pytest.approx(1.25 / 3)


def test_order_above_five_promises_no_more_than_fifth_order():
    order, error = grid_convergence_index(0.0, 1.0, 1001.0)
    assert order == pytest.approx(math.log2(1000))
    assert error == pytest.approx(1.25 / 31)


def test_grids_that_diverge_take_the_larger_change_at_the_least_order():
    order, error = grid_convergence_index(0.0, 1.0, 1.5)
    assert order == pytest.approx(-1.0)
    assert error == pytest.approx(1.25 / (math.sqrt(2) - 1))
    order, error = grid_convergence_index(0.0, 1.0, 1.0)
    assert order == -math.inf
    assert error == pytest.approx(1.25 / (math.sqrt(2) - 1))


def test_equal_values_have_no_error():
    assert grid_convergence_index(2.0, 2.0, 3.0) == (math.inf, 0.0)


# From the changes between grids


@given(size=st.floats(0.01, 5), order=st.floats(0.6, 4.9), ratio=st.floats(1.5, 3))
def test_power_law_on_four_grids_is_confirmed(size, order, ratio):
    values = [size * ratio ** (-order * k) for k in range(4)]
    found = error_of_finest(changes(values), ratio=ratio)
    assert found.order == pytest.approx(order, abs=1e-6)
    assert found.error == pytest.approx(1.25 * values[-1], rel=1e-5)
    alone = error_of_finest(changes(values[1:]), ratio=ratio)
    assert alone.error == pytest.approx(3 * values[-1], rel=1e-5)


@given(st.lists(st.floats(1e-9, 1), min_size=2, max_size=6), st.booleans())
def test_error_is_never_below_what_the_last_change_says_by_itself(changed, jump):
    """Nor, at a jump, below three times the last change; and no more grids make it infinite."""
    found = error_of_finest(changed, jump=jump)
    assert found.error >= 1.25 * changed[-1] / 31 * (1 - 1e-12)
    assert math.isfinite(found.error)
    if jump:
        assert found.error >= 3 * changed[-1] * (1 - 1e-12)


def test_change_that_is_small_by_chance_does_not_make_the_error_small():
    steady = error_of_finest([0.4, 0.2, 0.1])
    lucky = error_of_finest([0.4, 0.2, 0.001])
    assert steady.error == pytest.approx(1.25 * 0.1)
    assert lucky.error == pytest.approx(1.25 * 0.1)
    assert lucky.order > 5


def test_past_a_jump_no_more_than_first_order_is_believed():
    values = [2.0 ** (-3 * k) for k in range(4)]
    smooth, jump = (error_of_finest(changes(values), jump=jump) for jump in (False, True))
    assert smooth.order == jump.order == pytest.approx(3)
    _, before, last = (a - b for a, b in itertools.pairwise(values))
    assert jump.error == pytest.approx(3 * max(last, before / 2))
    assert jump.error > 20 * smooth.error


def test_too_few_grids_have_an_infinite_error():
    assert error_of_finest([]) == error_of_finest([0.1]) == (-math.inf, math.inf)


def test_grids_that_never_change_have_no_error():
    assert error_of_finest([0.0, 0.0, 0.0]) == (math.inf, 0.0)
    assert np.isfinite(error_of_finest([0.0, 0.0, 1e-3]).error)


class Frames(NamedTuple):
    u: np.ndarray
    R: np.ndarray


def test_solutions_that_stopped_at_different_frames_are_compared_where_both_have_one():
    step = np.where(np.arange(40) < 20, 1.0, 0.0)
    smooth = np.linspace(1.0, 0.0, 40)
    still = np.zeros((2, 40))
    stands = Frames(np.array([smooth, step]), still)
    assert jump_stands(Frames(stands.u[:, ::2], still[:, ::2]), stands)
    cut = Frames(stands.u[:1], still[:1])
    assert not jump_stands(Frames(stands.u[:, ::2], still[:, ::2]), cut)
    assert not jump_stands(Frames(cut.u[:, ::2], cut.R[:, ::2]), stands)
