import math

import numpy as np
import pytest

from bcre_pde import Material, Problem, solve
from bcre_pde.line import fluxes

METHODS = ["runge-kutta", "RK45", "DOP853", "LSODA", "BDF"]
MATERIAL = Material(v=1.0, D=0.2, gamma=0.3, Sc=0.5, kappa=0.05)
LENGTH = 20.0


def waves(x):
    k = 2 * np.pi / LENGTH
    return 0.5 * np.sin(2 * k * x) - 0.5 * x, 1 + 0.4 * np.cos(k * x)


def pulse(x):
    return 0.8 * (LENGTH - x), np.exp(-(((x - 8) / 2) ** 2))


def problem(initial=waves, material=MATERIAL, length=LENGTH, ends="periodic"):
    return Problem(initial, material, length, ends)


@pytest.mark.parametrize("ends", ["open", "periodic"])
def test_all_methods_agree_within_their_tolerance(ends):
    start = pulse if ends == "open" else waves
    reference = solve(problem(start, ends=ends), [3.0], 60, tolerance=1e-11)
    for method in METHODS:
        found = solve(problem(start, ends=ends), [3.0], 60, method, tolerance=1e-7)
        assert np.abs(found.R - reference.R).max() < 1e-5, method
        assert np.abs(found.h - reference.h).max() < 1e-5, method
        assert found.outflow == pytest.approx(reference.outflow, abs=1e-5), method


@pytest.mark.parametrize("ends", ["open", "periodic"])
def test_fields_of_py_pde_hold_the_solution(ends):
    solution = solve(problem(pulse if ends == "open" else waves, ends=ends), [0.0, 1.0], 60)
    field = solution.field()
    assert field["R"].grid.periodic == [ends == "periodic"]
    assert np.allclose(field["R"].grid.cell_coords[:, 0], solution.x, rtol=1e-14)
    assert (field["h"].integral + field["R"].integral) == pytest.approx(solution.mass()[-1])
    stored = solution.storage()
    assert list(stored.times) == [0.0, 1.0]
    for frame in (0, 1):
        assert np.array_equal(stored[frame]["R"].data, solution.R[frame])
        assert np.array_equal(stored[frame]["h"].data, solution.h[frame])


@pytest.mark.parametrize("method", ["runge-kutta", "RK45", "DOP853", "LSODA"])
def test_tolerance_governs_the_error(method):
    reference = solve(problem(), [3.0], 60, tolerance=1e-12).R
    errors = [
        np.abs(solve(problem(), [3.0], 60, method, tolerance=tolerance).R - reference).max()
        for tolerance in (1e-3, 1e-8)
    ]
    assert errors[1] < 1e-6
    assert errors[1] < errors[0] / 50


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("ends", ["open", "periodic"])
def test_mass_is_conserved_to_rounding(method, ends):
    start = pulse if ends == "open" else waves
    times = [0.0, 5.0, 20.0] if method in ("runge-kutta", "DOP853") else [0.0, 5.0]
    solution = solve(problem(start, ends=ends), times, 60, method)
    mass = solution.mass() + solution.outflow
    scale = solution.dx * (np.abs(solution.h[0]) + solution.R[0]).sum()
    assert np.abs(mass - mass[0]).max() <= 1e-12 * scale
    assert (solution.outflow[-1] > 0) == (ends == "open")


def test_outflow_is_the_integral_of_what_drifts_through_the_foot():
    times = np.linspace(0, 30, 601)
    solution = solve(problem(pulse, ends="open"), times, 60, tolerance=1e-8)
    passed = np.trapezoid(MATERIAL.v * solution.R[:, -1], times)
    assert solution.outflow[-1] == pytest.approx(passed, rel=1e-4)
    assert passed > 1


def test_uniform_layer_on_the_repose_slope_is_steady_to_rounding():
    solution = solve(problem(lambda x: (-0.5 * x, np.full_like(x, 2.0))), [50.0], 40)
    assert np.abs(solution.u).max() < 1e-12
    assert np.abs(solution.R - 2.0).max() < 1e-12


def test_periodic_solution_moves_with_its_start():
    """Half a period is a whole number of cells; u, not h, is what is periodic."""

    def moved(x):
        h, R = waves(x - LENGTH / 2)
        return h - 0.5 * LENGTH / 2, R

    here, there = solve(problem(), [3.0], 40), solve(problem(moved), [3.0], 40)
    assert np.roll(here.R[0], 20) == pytest.approx(there.R[0], abs=1e-11)
    assert np.roll(here.u[0], 20) == pytest.approx(there.u[0], abs=1e-11)


@pytest.mark.parametrize("method", ["runge-kutta", "DOP853"])
def test_thin_layer_is_solved_in_proportion_down_to_1e_150(method):
    """In the linear regime R scales; a layer of 1e-10 and one of 1e-150 leave the slope alone."""

    def thin(scale):
        return lambda x: (0.8 * (LENGTH - x), scale * np.exp(-(((x - 8) / 2) ** 2)))

    thick = solve(problem(thin(1e-10), ends="open"), [4.0], 60, method)
    thinnest = solve(problem(thin(1e-150), ends="open"), [4.0], 60, method)
    assert thinnest.R[0] * 1e140 == pytest.approx(thick.R[0], abs=1e-5 * thick.R.max())
    assert thick.R.max() > 5e-11


def test_tolerance_is_relative_to_the_layer_however_thin():
    """An absolute error would never be seen at 1e-150, whatever the tolerance."""

    def thin(x):
        return 0.8 * (LENGTH - x), 1e-150 * np.exp(-(((x - 8) / 2) ** 2))

    errors = []
    reference = solve(problem(thin, ends="open"), [4.0], 60, tolerance=1e-13).R
    for tolerance in (1e-6, 1e-10):
        found = solve(problem(thin, ends="open"), [4.0], 60, tolerance=tolerance).R
        errors.append(np.abs(found - reference).max() / reference.max())
    assert errors[1] < 1e-8
    assert errors[1] < errors[0] / 50


def test_problem_in_small_units_of_time_is_the_same_problem():
    fast = Material(v=1e12, D=0.2e12, gamma=0.3e12, Sc=0.5, kappa=0.05e12)
    slow = solve(problem(), [0.0, 3.0], 40)
    quick = solve(problem(material=fast), [0.0, 3e-12], 40)
    assert pytest.approx(slow.R, rel=1e-7) == quick.R


def test_step_in_the_surface_creates_no_overshoot():
    def cliff(x):
        return np.where(x < 12, 100.0, 0.0) - 0.5 * x, np.full_like(x, 1.0)

    quiet = Material(v=1.0, D=0.5, gamma=0.05, Sc=0.5)
    solution = solve(problem(cliff, quiet, ends="open"), list(np.linspace(0.2, 4, 8)), 100)
    assert solution.u.max() <= 100 * (1 + 1e-4)
    assert solution.u.min() >= -100 * 1e-4
    assert solution.R.min() >= -1e-4


def test_open_foot_keeps_its_height_without_curvature_term():
    """u on the foot is a boundary value there: a pile at repose behind it may not move it."""
    still = Material(v=1.0, D=0.2, gamma=0.3, Sc=0.5)
    solution = solve(problem(pulse, still, ends="open"), [0.0, 20.0], 100)
    last = np.polynomial.Polynomial.fit(solution.x[-4:], solution.u[1, -4:], 3)
    assert solution.u[0, -1] == pytest.approx(pulse(solution.x)[0][-1] + 0.5 * solution.x[-1])
    assert last(LENGTH) == pytest.approx(0.5 * LENGTH, abs=0.05)


def test_recorded_times_are_those_asked_for_and_zero_records_the_start():
    times = [0.0, 0.3, math.pi, 4.0]
    solution = solve(problem(), times, 40)
    h, R = waves(solution.x)
    assert solution.t.tolist() == times
    assert pytest.approx(h, abs=1e-13) == solution.h[0]
    assert np.array_equal(solution.R[0], R)
    assert solution.h.shape == solution.R.shape == (4, 40)
    assert solution.dx == LENGTH / 40


def test_solving_in_stages_does_not_change_the_solution():
    whole = solve(problem(), [3.0], 40, tolerance=1e-9)
    staged = solve(problem(), list(np.linspace(0, 3, 31)), 40, tolerance=1e-9)
    assert staged.R[-1] == pytest.approx(whole.R[-1], abs=1e-7)


def test_stop_ends_the_solve_after_the_frame_that_satisfies_it():
    solution = solve(problem(), [1.0, 2.0, 3.0, 4.0], 40, stop=lambda s: s.t[-1] >= 2.0)
    assert solution.t.tolist() == [1.0, 2.0]


def test_work_is_counted():
    solution = solve(problem(), [0.0, 3.0], 40)
    assert solution.steps >= 5
    assert solution.evaluations >= 6 * solution.steps
    assert solution.wall_s > 0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"cells": 7}, r"^cells = 7: "),
        ({"cells": 0}, r"^cells = 0: "),
        ({"method": "euler"}, r"^method = 'euler': must be one of"),
        ({"tolerance": 0.0}, r"^tolerance = 0.0: must lie between 0 and 1"),
        ({"tolerance": 1.0}, r"^tolerance = 1.0: must lie between 0 and 1"),
        ({"tolerance": math.nan}, r"^tolerance = nan: must lie between 0 and 1"),
        ({"times": []}, r"^times = \[\]: "),
        ({"times": [-1.0]}, r"^times = \[-1.0\]: "),
        ({"times": [2.0, 1.0]}, r"^times = \[2.0, 1.0\]: must ascend"),
        ({"times": [1.0, 1.0]}, r"^times = \[1.0, 1.0\]: must ascend"),
        ({"times": [math.nan]}, r"^times = \[nan\]: must be finite"),
    ],
)
def test_bad_argument_is_refused_with_its_name_and_value(options, message):
    arguments = {"times": [1.0], "cells": 40} | options
    with pytest.raises(ValueError, match=message):
        solve(problem(), **arguments)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"length": 0.0}, r"^length = 0.0: must be"),
        ({"length": -1.0}, r"^length = -1.0: must be"),
        ({"length": math.nan}, r"^length = nan: must be"),
        ({"ends": "closed"}, r"^ends = 'closed': must be one of"),
    ],
)
def test_bad_problem_is_refused_with_its_name_and_value(options, message):
    with pytest.raises(ValueError, match=message):
        problem(**options)


def test_start_that_is_not_finite_is_refused():
    with pytest.raises(ValueError, match="initial h must be finite"):
        solve(problem(lambda x: (np.full_like(x, math.nan), x)), [1.0], 40)


@pytest.mark.parametrize("call", [1, 25])
@pytest.mark.parametrize("method", METHODS)
def test_interruption_by_the_keyboard_is_not_swallowed(monkeypatch, method, call):
    """py-pde's controller would return the state of that moment as if all were well."""

    plain, calls = fluxes.rate, []

    def rate(*arguments):
        calls.append(1)
        if len(calls) == call:
            raise KeyboardInterrupt
        plain(*arguments)

    monkeypatch.setattr(fluxes, "rate", rate)
    with pytest.raises(KeyboardInterrupt):
        solve(problem(), [30.0], 40, method)
