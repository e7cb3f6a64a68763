import math

import numpy as np
import pytest

from bcre_pde import (
    Material,
    Problem,
    SolveError,
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
    assert only.cells == (10, 20, 40, 80)
    assert only.solution == 80
    assert only.value == 1 + 1 / 64
    assert only.order == pytest.approx(2)
    assert only.error == pytest.approx(1.25 / 64)
    assert only.error <= only.allowed == 1e-1
    assert only.resolved
    fast, slow = measure_refined(ladder(4, 1), GRIDS, allowing(1e-1, 0.1))
    assert fast.cells == slow.cells == GRIDS
    assert (fast.order, slow.order) == pytest.approx((4, 1))
    assert (fast.allowed, slow.allowed) == (1e-1, 0.1)
    assert fast.resolved
    assert slow.resolved


def test_what_the_finest_grid_cannot_settle_is_reported_as_unresolved():
    sure, unsure = measure_refined(ladder(2, 2), GRIDS, allowing(1.0, 1e-9))
    assert sure.cells == unsure.cells == GRIDS
    assert (sure.resolved, unsure.resolved) == (True, False)
    assert unsure.error > 0


def test_refinement_never_ends_on_one_triple_alone():
    """The changes 1, 0.1 and then 0.9: the first triple would pass, by chance."""
    values = dict(zip(GRIDS, (0.0, 1.0, 1.1, 2.0, 2.9), strict=True))
    (only,) = measure_refined(lambda n: (n, [values[n]]), GRIDS, allowing(0.5))
    assert only.cells == GRIDS
    assert only.error > 2.0
    assert not only.resolved


def test_last_of_three_grids_has_an_error_of_three_times_the_change_at_its_order():
    (only,) = measure_refined(ladder(2), GRIDS[:3])
    assert only.error == pytest.approx(3 / 16)


@pytest.mark.parametrize(("D", "stands"), [(0.0, True), (1.0, False)])
def test_jump_in_a_solution_is_seen(D, stands):
    """Half of a periodic line is wet: a jump stays where there is no diffusion."""
    wet = Problem(
        lambda x: (-0.5 * x, np.where(x < 5, 2.0, 1.0)),
        Material(1.0, D, 0.0, 0.5),
        10.0,
        "periodic",
    )
    found = solve_refined(wet, [2.0], middle_layer, lambda _: 0.0, coarsest=16, finest=64)
    assert found.jump == stands


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
