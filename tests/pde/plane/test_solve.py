"""Solving on a plane: the record, the account of the volume, the line, bad input."""

import importlib
import math
import subprocess
import sys

import numpy as np
import pytest

from bcre_pde import Problem as LineProblem
from bcre_pde import SolveError, plane
from bcre_pde import solve as solve_line
from bcre_pde.plane import Material, Problem, fluxes, march, solve

MATERIAL = Material(1.0, 0.2, 0.3, 0.3, 0.5, kappa_x=0.05, kappa_y=0.04)
LENGTH, WIDTH, CELLS = 20.0, 9.0, (40, 15)


def pulse(x, y):
    return 0.8 * (LENGTH - x), np.exp(-((x - 8) ** 2) / 4 - (y - 4) ** 2 / 2)


def waves(x, y):
    k, q = 2 * np.pi / LENGTH, 2 * np.pi / WIDTH
    u = 0.5 * np.sin(2 * k * x) + 0.2 * np.cos(q * y)
    return u - 0.5 * x, 1 + 0.4 * np.cos(k * x) * np.cos(q * y)


def problem(initial=pulse, material=MATERIAL, ends="open", sides="periodic"):
    return Problem(initial, material, LENGTH, WIDTH, ends, sides)


@pytest.mark.parametrize("ends", ["open", "periodic"])
@pytest.mark.parametrize("sides", ["periodic", "closed"])
def test_volume_is_conserved_to_rounding(ends, sides):
    start = pulse if ends == "open" else waves
    solution = solve(problem(start, ends=ends, sides=sides), [0.0, 5.0, 20.0], CELLS)
    volume = solution.mass() + solution.outflow
    cell = solution.dx * solution.dy
    scale = cell * (np.abs(solution.h[0]) + solution.R[0]).sum()
    assert np.abs(volume - volume[0]).max() <= 1e-12 * scale
    assert (solution.outflow[-1] > 1) == (ends == "open")


def test_outflow_is_the_integral_of_what_drifts_through_the_foot():
    times = np.linspace(0, 30, 601)
    frames = list(march(problem(), times, CELLS, 1e-8))
    passed = np.trapezoid([frame.R[-1].mean() * WIDTH * MATERIAL.v for frame in frames], times)
    assert frames[-1].outflow == pytest.approx(passed, rel=1e-4)


@pytest.mark.parametrize("ends", ["open", "periodic"])
def test_scene_without_structure_across_is_the_scene_of_the_line_to_the_bit(ends):
    """The stable step must be the same too, hence nothing that spreads across."""
    material = Material(1.0, 0.2, 0.0, 0.3, 0.5, kappa_x=0.05)

    def start(x, y):
        return (pulse if ends == "open" else waves)(x, 4.0)

    def start_of_line(x):
        return start(x, None)

    times = [0.0, 3.0, 9.0]
    ours = solve(problem(start, material, ends), times, (40, 5))
    line = solve_line(LineProblem(start_of_line, material.along, LENGTH, ends), times, 40)
    assert (ours.steps, ours.evaluations) == (line.steps, line.evaluations)
    for name in ("h", "R", "u"):
        expected = getattr(line, name)[:, :, None]
        assert np.array_equal(getattr(ours, name), np.broadcast_to(expected, (3, 40, 5)))
    assert ours.outflow == pytest.approx(WIDTH * line.outflow, rel=1e-14)


def test_spreading_across_changes_a_scene_without_structure_there_by_the_steps_alone():
    def start(x, y):
        return pulse(x, 4.0)

    ours = solve(problem(start), [6.0], (40, 5), 1e-10)
    line = solve_line(
        LineProblem(lambda x: pulse(x, 4.0), MATERIAL.along, LENGTH), [6.0], 40, tolerance=1e-10
    )
    assert ours.R[0] == pytest.approx(np.broadcast_to(line.R[0][:, None], (40, 5)), abs=1e-9)
    assert np.ptp(ours.R, axis=2).max() == 0
    assert np.ptp(ours.h, axis=2).max() == 0


def test_solution_is_the_same_on_any_number_of_threads():
    one, three = (solve(problem(), [4.0], CELLS, threads=threads) for threads in (1, 3))
    assert np.array_equal(one.h, three.h)
    assert np.array_equal(one.R, three.R)
    assert np.array_equal(one.outflow, three.outflow)


def test_tolerance_governs_the_error():
    reference = solve(problem(waves, ends="periodic"), [3.0], CELLS, 1e-12).R
    errors = [
        np.abs(solve(problem(waves, ends="periodic"), [3.0], CELLS, tolerance).R - reference).max()
        for tolerance in (1e-3, 1e-8)
    ]
    assert errors[1] < 1e-6
    assert errors[1] < errors[0] / 50


def test_stable_step_keeps_rough_small_waves_small():
    """Anisotropic on purpose: what spreads along and across adds up."""
    material = Material(0.1, 1.0, 1.0, 0.3, 0.5, kappa_x=0.5, kappa_y=0.5)
    rng = np.random.default_rng(0)
    rough = 1e-9 * rng.uniform(-1, 1, (2, 16, 12))

    def start(x, y):
        u, R = rough if x.shape == (16, 12) else rough[:, -1:]
        return u - 0.5 * x, 2 + R

    given = Problem(start, material, 16.0, 12.0, "periodic")
    last = solve(given, [40.0], (16, 12), 1e-3)
    assert np.abs(last.u).max() < 2e-9
    assert np.abs(last.R - 2).max() < 4e-9


def test_record_is_of_the_times_asked_for_and_zero_records_the_start():
    times = [0.0, 0.3, math.pi]
    solution = solve(problem(), times, CELLS)
    h, R = pulse(*np.meshgrid(solution.x, solution.y, indexing="ij"))
    assert solution.t.tolist() == times
    assert solution.h[0] == pytest.approx(h, abs=1e-13)
    assert np.array_equal(solution.R[0], R)
    assert solution.h.shape == solution.R.shape == (3, *CELLS)
    assert (solution.dx, solution.dy) == (0.5, 0.6)
    assert solution.steps >= 5
    assert solution.evaluations >= 6 * solution.steps
    assert solution.wall_s > 0


def test_march_gives_the_frames_of_the_solution_one_by_one():
    solution = solve(problem(), [1.0, 2.0], CELLS)
    frames = march(problem(), [1.0, 2.0], CELLS)
    first = next(frames)
    assert np.array_equal(first.R, solution.R[0])
    second = next(frames)
    assert np.array_equal(first.R, solution.R[0])  # not written over
    assert np.array_equal(second.h, solution.h[1])
    assert second.outflow == solution.outflow[1]


def test_stop_ends_the_solve_after_the_frame_that_satisfies_it():
    seen = []

    def stop(solution):
        seen.append(solution.t.tolist())
        return solution.t[-1] >= 2.0

    solution = solve(problem(), [1.0, 2.0, 3.0], CELLS, stop=stop)
    assert solution.t.tolist() == [1.0, 2.0]
    assert seen == [[1.0, 1.0], [1.0, 2.0]]


def test_failure_names_cell_place_and_time(monkeypatch):
    def rate(layers, out, base, K):
        out[...] = 0.0
        out[1, 17, 4] = out[1, 30, 2] = math.nan

    monkeypatch.setattr(fluxes, "rate", rate)
    where = r"R(/dt)? is not finite in cell \(17, 4\) \(x = 8.75, y = 2.7\) at t = "
    with pytest.raises(SolveError, match=f"^runge-kutta gave up: .*{where}") as caught:
        solve(problem(), [1.0], CELLS)
    assert caught.value.cell == (17, 4)


def test_foot_that_is_not_finite_is_of_the_last_cell_of_its_column(monkeypatch):
    def rate(layers, out, base, K):
        out[...] = 0.0
        out[2, 0, 4] = math.nan

    monkeypatch.setattr(fluxes, "rate", rate)
    with pytest.raises(SolveError, match=r"in cell \(39, 4\)"):
        solve(problem(), [1.0], CELLS)


def test_endless_solve_is_refused_before_its_first_step(monkeypatch):
    monkeypatch.setattr(importlib.import_module("bcre_pde.plane.solve"), "MOST_EVALUATIONS", 1000)
    with pytest.raises(SolveError, match=r"evaluate the right-hand side \S+ times from t = 0 to"):
        solve(problem(), [1e5], CELLS)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"cells": (7, 15)}, r"^cells along = 7: must be a whole number, at least 8$"),
        ({"cells": (40, 2)}, r"^cells across = 2: must be a whole number, at least 3"),
        ({"cells": (40,)}, r"^cells = \(40,\): must be two numbers"),
        ({"threads": 0}, r"^threads = 0: must be a whole number, at least 1"),
        ({"tolerance": 0.0}, r"^tolerance = 0.0: must lie between 0 and 1"),
        ({"tolerance": math.nan}, r"^tolerance = nan: must lie between 0 and 1"),
        ({"times": []}, r"^times = \[\]: "),
        ({"times": [2.0, 1.0]}, r"^times = \[2.0, 1.0\]: must ascend"),
        ({"times": [math.nan]}, r"^times = \[nan\]: must be finite"),
    ],
)
def test_bad_argument_is_refused_at_once_with_its_name_and_value(options, message):
    arguments = {"times": [1.0], "cells": CELLS} | options
    with pytest.raises(ValueError, match=message):
        march(problem(), **arguments)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"length": 0.0}, r"^length = 0.0: must be a finite number > 0"),
        ({"width": math.inf}, r"^width = inf: must be a finite number > 0"),
        ({"ends": "closed"}, r"^ends = 'closed': must be one of"),
        ({"sides": "open"}, r"^sides = 'open': must be one of"),
    ],
)
def test_bad_problem_is_refused_with_its_name_and_value(options, message):
    arguments = {"length": LENGTH, "width": WIDTH} | options
    with pytest.raises(ValueError, match=message):
        Problem(pulse, MATERIAL, **arguments)


@pytest.mark.parametrize("name", ["v", "D_x", "D_y", "gamma", "Sc", "kappa_x", "kappa_y"])
@pytest.mark.parametrize("value", [-0.1, math.nan, math.inf])
def test_coefficients_must_be_finite_and_not_negative(name, value):
    good = {"v": 1.0, "D_x": 0.2, "D_y": 0.1, "gamma": 0.3, "Sc": 0.5}
    with pytest.raises(ValueError, match=rf"^{name} = {value!r}: must be a finite number >= 0$"):
        Material(**(good | {name: value}))


def test_isotropic_material_is_that_of_the_line_both_ways():
    line = plane.Material(1.0, 0.2, 0.2, 0.3, 0.5, 0.1, 0.1, 2.0).along
    assert Material.isotropic(line) == Material(1.0, 0.2, 0.2, 0.3, 0.5, 0.1, 0.1, 2.0)
    with pytest.raises(ValueError, match=r"^v_up = 0.0: must be > 0"):
        Material(1.0, 0.2, 0.2, 0.3, 0.5, v_up=0.0)


@pytest.mark.parametrize(
    ("start", "message"),
    [
        (lambda x, y: (np.full_like(x, math.nan), x), "initial h must be finite"),
        (lambda x, y: (x, np.ones(3)), r"^initial R has the shape \(3,\): must be \(40, 15\)"),
    ],
)
def test_start_that_is_not_finite_or_has_another_shape_is_refused(start, message):
    with pytest.raises(ValueError, match=message):
        solve(problem(start), [1.0], CELLS)


LIGHT = """
import sys
import bcre_pde.plane, bcre_pde.plane.exact, bcre_pde.plane.opening, bcre_pde.plane.theory
print(*{"pde", "numba", "pandas", "matplotlib"} & set(sys.modules))
"""


def test_what_needs_no_solver_imports_neither_py_pde_nor_numba():
    told = subprocess.run([sys.executable, "-c", LIGHT], capture_output=True, check=True, text=True)
    assert told.stdout.strip() == ""
