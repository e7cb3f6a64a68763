import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bcre_pde import (
    Material,
    Problem,
    SolveError,
    grid_convergence_index,
    measure_refined,
    solve_refined,
    solve_refined_each,
)
from bcre_pde.line import fluxes

PROBLEM = Problem(
    lambda x: (0.5 * np.sin(2 * np.pi * x / 10) - 0.5 * x, 1 + 0.4 * np.cos(2 * np.pi * x / 10)),
    Material(v=1.0, D=0.2, gamma=0.3, Sc=0.5, kappa=0.05),
    10.0,
    "periodic",
)


def middle_layer(solution):
    return float(np.interp(5.0, solution.x, solution.R[-1]))


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


def ladder(*orders, fails_at=math.inf):
    """Quantities 1 + (10/cells)^p, with the number of cells in the place of a solution."""

    def measure_on(cells):
        if cells >= fails_at:
            raise SolveError("gave up")
        return cells, [1 + (10 / cells) ** order for order in orders]

    return measure_on


GRIDS = (10, 20, 40, 80, 160)


def allowing(*errors):
    return lambda values: errors


def test_refinement_goes_on_until_every_error_is_as_small_as_allowed():
    (only,) = measure_refined(ladder(2), GRIDS, allowing(1e-1))
    assert only.cells == (10, 20, 40)
    assert only.solution == 40
    assert only.value == 1 + 1 / 16
    assert only.order == pytest.approx(2)
    assert only.error == pytest.approx(1.25 / 16)
    assert only.error <= only.allowed == 1e-1
    assert only.resolved
    fast, slow = measure_refined(ladder(4, 1), GRIDS, allowing(1e-1, 0.2))
    assert fast.cells == slow.cells == (10, 20, 40, 80)
    assert (fast.order, slow.order) == pytest.approx((4, 1))
    assert (fast.allowed, slow.allowed) == (1e-1, 0.2)
    assert fast.resolved
    assert slow.resolved


def test_what_the_finest_grid_cannot_settle_is_reported_as_unresolved():
    sure, unsure = measure_refined(ladder(2, 2), GRIDS, allowing(1.0, 1e-9))
    assert sure.cells == unsure.cells == GRIDS
    assert (sure.resolved, unsure.resolved) == (True, False)
    assert unsure.error > 0


def test_allowed_error_is_asked_of_the_finest_value():
    seen = []
    measure_refined(ladder(1), GRIDS[:4], lambda values: seen.append(values) or [0.0])
    assert seen == [[1 + 1 / 4], [1 + 1 / 8]]


def test_all_given_grids_are_measured_where_no_error_is_asked_for():
    (measured,) = measure_refined(ladder(2), GRIDS)
    assert measured.cells == GRIDS
    assert measured.error == pytest.approx(1.25 / 256)
    (on_two,) = measure_refined(ladder(2), GRIDS[:2])
    assert on_two.value == 1 + 1 / 4
    assert on_two.error == math.inf


@pytest.mark.parametrize(("fails_at", "cells"), [(80, (10, 20, 40)), (40, (10, 20))])
def test_grid_on_which_the_solver_gives_up_ends_the_refinement(fails_at, cells):
    (measured,) = measure_refined(ladder(2, fails_at=fails_at), GRIDS, allowing(0.0))
    assert measured.cells == cells
    assert not measured.resolved
    assert (measured.error == math.inf) == (len(cells) < 3)


def test_solver_that_gives_up_on_the_first_grid_or_on_a_given_one_is_an_error():
    with pytest.raises(SolveError):
        measure_refined(ladder(2, fails_at=10), GRIDS, allowing(1.0))
    with pytest.raises(SolveError):
        measure_refined(ladder(2, fails_at=40), GRIDS)


def test_three_grids_are_solved_even_where_the_finest_is_the_coarsest():
    refined = solve_refined(PROBLEM, [1.0], middle_layer, lambda value: 1.0, coarsest=10, finest=10)
    assert refined.cells == (10, 20, 40)


def test_error_estimate_covers_the_true_error():
    reference = solve_refined(
        PROBLEM, [1.0], middle_layer, lambda value: 0.0, coarsest=320, finest=1280, tolerance=1e-9
    )
    assert reference.cells == (320, 640, 1280)
    coarse = solve_refined(PROBLEM, [1.0], middle_layer, lambda value: 1e-2, coarsest=20)
    assert coarse.value == middle_layer(coarse.solution)
    assert abs(coarse.value - reference.value) <= coarse.error


def test_several_quantities_are_measured_on_the_same_solutions():
    number, profile = solve_refined_each(
        PROBLEM,
        [1.0],
        lambda solution: [middle_layer(solution), np.interp([2.5, 5.0], solution.x, solution.R[0])],
        lambda values: [1e-2, 1e-2],
        coarsest=20,
    )
    alone = solve_refined(PROBLEM, [1.0], middle_layer, lambda value: 1e-2, coarsest=20)
    assert number.solution is profile.solution
    assert (number.value, number.error) == (alone.value, alone.error)
    assert profile.value.shape == (2,)


def test_solver_that_gives_up_on_every_grid_is_an_error(monkeypatch):
    def rate(state, out, *rest):
        out[...] = math.nan

    monkeypatch.setattr(fluxes, "rate", rate)
    with pytest.raises(SolveError):
        solve_refined(PROBLEM, [1.0], middle_layer, lambda value: 1.0)
