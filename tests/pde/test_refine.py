import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bcre_pde import (
    Material,
    Problem,
    SolveError,
    fluxes,
    grid_convergence_index,
    refine,
    solve_refined,
)

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


def test_refinement_stops_at_three_grids_when_the_error_is_small():
    refined = solve_refined(PROBLEM, [1.0], middle_layer, lambda value: 1e-2, coarsest=20)
    assert refined.cells == (20, 40, 80)
    assert refined.resolved
    assert refined.error <= refined.allowed == 1e-2
    assert refined.solution.x.size == 80
    assert refined.measured == middle_layer(refined.solution)


def test_refinement_goes_on_until_the_error_is_as_small_as_allowed():
    rough = solve_refined(PROBLEM, [1.0], middle_layer, lambda value: 1e-2, coarsest=10)
    close = solve_refined(
        PROBLEM, [1.0], middle_layer, lambda value: 1e-5, coarsest=10, finest=1280
    )
    assert close.resolved
    assert len(close.cells) > len(rough.cells)


def test_error_estimate_covers_the_true_error():
    reference = solve_refined(
        PROBLEM, [1.0], middle_layer, lambda value: 0.0, coarsest=320, finest=1280, tolerance=1e-9
    )
    coarse = solve_refined(PROBLEM, [1.0], middle_layer, lambda value: 1e-2, coarsest=20)
    assert abs(coarse.measured - reference.measured) <= coarse.error


def test_what_the_finest_grid_cannot_settle_is_reported_as_unresolved():
    refined = solve_refined(PROBLEM, [1.0], middle_layer, lambda value: 0.0, coarsest=10, finest=40)
    assert refined.cells == (10, 20, 40)
    assert not refined.resolved
    assert refined.error > 0


def test_three_grids_are_solved_even_where_the_finest_is_the_coarsest():
    refined = solve_refined(PROBLEM, [1.0], middle_layer, lambda value: 1.0, coarsest=10, finest=10)
    assert refined.cells == (10, 20, 40)


def test_allowed_error_is_asked_of_the_finest_value():
    seen = []
    solve_refined(PROBLEM, [1.0], middle_layer, lambda value: seen.append(value) or 0.0, 10, 80)
    assert len(seen) == 2


def test_grid_on_which_the_solver_gives_up_ends_the_refinement(monkeypatch):
    plain = refine.solve

    def solve(problem, times, cells, **options):
        if cells > 20:
            raise SolveError("gave up")
        return plain(problem, times, cells, **options)

    monkeypatch.setattr(refine, "solve", solve)
    refined = solve_refined(PROBLEM, [1.0], middle_layer, lambda value: 1.0, coarsest=10)
    assert refined.cells == (10, 20)
    assert not refined.resolved
    assert refined.error == math.inf


def test_solver_that_gives_up_on_the_first_grid_is_an_error(monkeypatch):
    def rate(state, out, *rest):
        out[...] = math.nan

    monkeypatch.setattr(fluxes, "rate", rate)
    with pytest.raises(SolveError):
        solve_refined(PROBLEM, [1.0], middle_layer, lambda value: 1.0)
