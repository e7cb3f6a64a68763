import importlib
import itertools
import math
import pickle
import re
import warnings

import numpy as np
import pytest

from bcre_pde import Material, Problem, SolveError, solve
from bcre_pde.line import fluxes

METHODS = ["runge-kutta", "RK45", "DOP853", "LSODA", "BDF"]
LENGTH, CELLS, REPOSE = 20.0, 40, 0.5
WHERE = re.compile(
    r"(u|R|du/dt|dR/dt|the layers change fastest, d[uR]/dt = \S+,)( is not finite)? "
    r"in cell (\d+) \(x = (\S+)\) at t = (\S+)$"
)


def pulse(x):
    return 0.8 * (LENGTH - x), np.exp(-(((x - 8) / 2) ** 2))


def jump(x):
    """u falls by 100 cell lengths between two cells."""
    return np.where(x < 10, 100 * LENGTH / CELLS, 0.0) - REPOSE * x, pulse(x)[1]


def one_wet_cell(R):
    return lambda x: (0.8 * (LENGTH - x), np.where(np.abs(x - 8.25) < 0.2, R, 0.0))


def problem(initial=pulse, material=None, ends="open"):
    return Problem(initial, material or Material(1.0, 0.2, 0.3, REPOSE), LENGTH, ends)


@pytest.fixture
def most_evaluations(monkeypatch):
    return lambda most: monkeypatch.setattr(
        importlib.import_module("bcre_pde.solve"), "MOST_EVALUATIONS", most
    )


def ends_finite_or_says_where(given, method, until=0.2):
    """The solution, or None where the solver gave up with a text that names cell and time."""
    with warnings.catch_warnings(action="ignore", category=UserWarning):  # LSODA's own words
        try:
            solution = solve(given, [until], CELLS, method)
        except SolveError as failure:
            says_where(failure, method)
            return None
    assert np.isfinite(solution.h).all()
    assert np.isfinite(solution.R).all()
    return solution


def says_where(failure, method):
    text = str(failure)
    assert text.startswith(method)
    found = WHERE.search(text)
    if found is None:  # refused before the first step
        assert re.search(r"stable step.* R up to .* from t = 0 to .* are allowed$", text), text
        assert failure.time == 0
        return
    assert int(found[3]) == failure.cell
    assert float(found[4]) == pytest.approx((failure.cell + 0.5) * LENGTH / CELLS)
    assert math.isfinite(failure.time)
    assert float(found[5]) == pytest.approx(failure.time, rel=1e-5)


def test_solver_that_meets_no_number_gives_up_with_cell_and_time(monkeypatch):
    def rate(state, out, *rest):
        out[...] = 0.0
        out[1, 17] = out[1, 30] = math.nan  # the first is named

    monkeypatch.setattr(fluxes, "rate", rate)
    for method in METHODS:
        where = r"R(/dt)? is not finite in cell 17 \(x = 8.75\) at t = "
        with pytest.raises(SolveError, match=f"^{method} gave up: .*{where}") as caught:
            solve(problem(), [1.0], CELLS, method)
        assert caught.value.cell == 17
        assert 0 <= caught.value.time < 1


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("ends", ["open", "periodic"])
def test_coefficients_of_zero_each_and_together_are_solved(method, ends):
    for D, gamma, v in itertools.product((0.0, 0.2), (0.0, 0.3), (0.0, 1.0)):
        solution = ends_finite_or_says_where(
            problem(pulse, Material(v, D, gamma, 0.5), ends), method
        )
        assert solution is not None
        if not (D or gamma or v):
            assert solution.R[0] == pytest.approx(pulse(solution.x)[1], abs=1e-15)


@pytest.mark.parametrize("method", METHODS)
def test_very_large_curvature_term_ends_finite_or_says_where(method, most_evaluations):
    most_evaluations(20_000)
    ends_finite_or_says_where(problem(pulse, Material(1.0, 0.2, 0.3, 0.5, 1e3)), method, 0.02)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("R", [1e-320, 1e-300])
def test_one_cell_wet_by_next_to_nothing_is_solved(method, R):
    solution = ends_finite_or_says_where(problem(one_wet_cell(R)), method)
    assert solution is not None
    assert solution.R.max() < 2 * R


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("R", [1e6, 1e100, 1e300])
def test_one_cell_wet_by_very_much_ends_finite_or_says_where(method, R, most_evaluations):
    most_evaluations(10_000)
    ends_finite_or_says_where(problem(one_wet_cell(R)), method)


@pytest.mark.parametrize("method", METHODS)
def test_step_of_the_surface_by_a_hundred_cell_lengths_is_solved(method):
    assert ends_finite_or_says_where(problem(jump), method) is not None


@pytest.mark.parametrize("method", METHODS)
def test_every_ratio_of_drift_to_diffusion_ends_finite_or_says_where(method, most_evaluations):
    most_evaluations(10_000)
    for pe in 10.0 ** np.arange(-3, 7):
        material = Material(1.0, LENGTH / CELLS / pe, 0.3, 0.5)
        solution = ends_finite_or_says_where(problem(pulse, material), method)
        assert solution is not None or pe < 0.1


@pytest.mark.parametrize("method", METHODS)
def test_saturation_beyond_all_numbers_says_where(method):
    material = Material(1.0, 0.2, 0.3, 0.5, v_up=1e-320)
    assert ends_finite_or_says_where(problem(pulse, material), method) is None


def test_stable_step_below_the_rounding_of_time_is_refused(most_evaluations):
    most_evaluations(math.inf)
    huge = problem(lambda x: (1e150 * np.sin(x), 1e150 * np.exp(-((x - 3.25) ** 2))))
    message = r"^runge-kutta: the stable step \S+ at t = 0 is too small .* in cell 6$"
    with pytest.raises(SolveError, match=message) as caught:
        solve(huge, [1.0], CELLS)
    assert (caught.value.time, caught.value.cell) == (0.0, 6)


@pytest.mark.parametrize("method", METHODS)
def test_work_is_bounded_by_a_stated_number_of_evaluations(method, most_evaluations):
    most_evaluations(30)
    times = [0.1, 0.2, 3.0]
    with pytest.raises(SolveError, match=r"30(\.0)? (times, the most that is|are) allowed"):
        solve(problem(), times, CELLS, method)


def test_endless_solve_is_refused_before_its_first_step(monkeypatch):
    calls, plain = [], fluxes.rate

    def rate(*arguments):
        calls.append(1)
        plain(*arguments)

    monkeypatch.setattr(fluxes, "rate", rate)
    with pytest.raises(SolveError, match=r"evaluate the right-hand side \S+ times from t = 0 to"):
        solve(problem(), [1e12], CELLS)
    assert len(calls) == 1  # which compiles it


def test_step_that_falls_below_its_bound_says_so():
    with pytest.raises(SolveError, match=r"^runge-kutta gave up: Time step below \S+: ") as caught:
        solve(problem(), [1.0], CELLS, tolerance=1e-300)
    says_where(caught.value, "runge-kutta")


@pytest.mark.parametrize("method", METHODS)
def test_overflow_is_an_error_of_numpy_only_where_the_caller_asks_for_one(monkeypatch, method):
    calls = []

    def rate(state, out, *rest):
        calls.append(1)
        if len(calls) > 1:  # the first, which compiles, is not the solver's
            np.full(1, 1e200) * 1e200
        out[...] = 0.0

    monkeypatch.setattr(fluxes, "rate", rate)
    with np.errstate(over="raise"), pytest.raises(FloatingPointError):
        solve(problem(), [0.2], CELLS, method)
    calls.clear()
    with np.errstate(over="warn"):
        solve(problem(), [0.2], CELLS, method)


def test_failure_keeps_its_time_and_cell_on_the_way_between_processes():
    copy = pickle.loads(pickle.dumps(SolveError("gave up", 2.5, 7)))
    assert (str(copy), copy.time, copy.cell) == ("gave up", 2.5, 7)
    assert SolveError("gave up").cell is None
