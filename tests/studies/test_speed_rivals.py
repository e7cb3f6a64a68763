import json
import os
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import OptimizeResult

import bcre_pde
from bcre_ca import Rule, evolve
from bcre_pde import Material, Problem
from bcre_studies.performance.rivals import fipy_solver, method_of_lines
from bcre_studies.performance.rivals.rivals import centres

LENGTH = 20.0


def rolling_sand(x):
    """A rough surface at repose under a layer of uneven thickness, periodic over the length."""
    wave = np.sin(2 * np.pi * x / LENGTH)
    return -0.5 * x + 0.2 * wave, 1 + 0.5 * wave


OPEN = Problem(rolling_sand, Material(1.0, 0.3, 0.2, 0.5), LENGTH)
PERIODIC = replace(OPEN, ends="periodic")
CURVED = replace(PERIODIC, material=replace(OPEN.material, kappa=0.2))


def coarsened(values, cells):
    return values.reshape(cells, -1).mean(axis=1)


def automaton(problem, until, cells, dt):
    m = problem.material
    rule = Rule(m.v, m.D, m.gamma, m.Sc, problem.length / cells, dt)
    h, R = problem.initial(centres(problem, cells))
    return evolve(h, R, rule, round(until / dt), problem.ends)


EXPRESSIONS = {
    "upwind, open": ("open", 0.0, 3.0, 40, 0.1, 1e-4),
    "upwind, periodic": ("periodic", 0.0, 3.0, 40, 0.1, 1e-4),
    "central, 20 cells": ("periodic", 0.2, 0.5, 20, None, 1e-6),
    "central, 40 cells": ("periodic", 0.2, 0.5, 40, None, 1e-6),
    "central, open": ("open", 0.2, 0.5, 40, None, 1e-6),
}
"""Ends, kappa, until, cells, dt and tolerance."""

# py-pde compiles for a minute or so; the same Python, run as it stands, shows the same numbers.
UNCOMPILED = """
import json, sys
import numpy as np
from bcre_pde import Material, Problem
from bcre_studies.performance.rivals import pypde_expressions as expressions

def initial(x):
    wave = np.sin(2 * np.pi * x / 20)
    return -0.5 * x + 0.2 * wave, 1 + 0.5 * wave

def layers(ends, kappa, until, cells, dt, tolerance):
    problem = Problem(initial, Material(1.0, 0.3, 0.2, 0.5, kappa=kappa), 20.0, ends)
    solve = expressions.prepare(problem, until, cells, dt, tolerance)
    first, second = solve(), solve()
    assert first.R.tobytes() == second.R.tobytes() and first.steps == second.steps
    if dt is not None:
        user = expressions.solve(problem, until, cells, dt)
        assert user.R.tobytes() == first.R.tobytes() and user.steps == first.steps
    return [first.x, first.h, first.R, np.full_like(first.x, first.steps)]

np.savez(sys.argv[1], **{name: layers(*case) for name, case in json.loads(sys.argv[2]).items()})
"""


@pytest.fixture(scope="module")
def py_pde(tmp_path_factory):
    """x, h, R and the number of steps of every case, from one process."""
    saved = tmp_path_factory.mktemp("expressions") / "layers.npz"
    subprocess.run(
        [sys.executable, "-c", UNCOMPILED, str(saved), json.dumps(EXPRESSIONS)],
        check=True,
        env=os.environ | {"NUMBA_DISABLE_JIT": "1"},
    )
    return np.load(saved)


@pytest.mark.parametrize("ends", ["open", "periodic"])
def test_upwind_expressions_of_py_pde_are_the_automaton_within_rounding(py_pde, ends):
    x, h, R, steps = py_pde[f"upwind, {ends}"]
    problem = replace(OPEN, ends=ends)
    h_automaton, R_automaton = automaton(problem, 3.0, 40, 0.1)
    h_start, R_start = problem.initial(x)
    assert np.abs(h_automaton - h_start).max() > 0.01
    assert np.abs(R_automaton - R_start).max() > 0.1
    np.testing.assert_allclose(h, h_automaton, rtol=0, atol=1e-13)
    np.testing.assert_allclose(R, R_automaton, rtol=0, atol=1e-13)
    assert steps[0] == 30


def test_central_expressions_of_py_pde_solve_bcre_to_second_order(py_pde):
    exact = bcre_pde.solve(CURVED, [0.5], 320)
    errors = []
    for cells in (20, 40):
        _, h, R, _ = py_pde[f"central, {cells} cells"]
        errors.append(
            np.abs(R - coarsened(exact.R[0], cells)).mean()
            + np.abs(h - coarsened(exact.h[0], cells)).mean()
        )
    assert errors[1] < 3e-3
    assert 3.2 < errors[0] / errors[1] < 5


def test_central_expressions_of_py_pde_take_open_ends(py_pde):
    problem = replace(OPEN, material=replace(OPEN.material, kappa=0.2))
    exact = bcre_pde.solve(problem, [0.5], 320)
    _, h, R, _ = py_pde["central, open"]
    assert np.abs(R - coarsened(exact.R[0], 40)).mean() < 0.02
    assert np.abs(h - coarsened(exact.h[0], 40)).mean() < 0.002
    assert abs(h[0] - coarsened(exact.h[0], 40)[0]) < 8e-4


@pytest.mark.parametrize("problem", [OPEN, PERIODIC])
def test_automaton_approaches_the_method_of_lines_as_its_step_shrinks(problem):
    lines = method_of_lines.prepare(problem, 2.0, 40, tolerance=1e-9)()
    errors = []
    for dt in (0.02, 0.01):
        h, R = automaton(problem, 2.0, 40, dt)
        errors.append(np.abs(R - lines.R).max() + np.abs(h - lines.h).max())
    assert errors[1] < 5e-3
    assert errors[0] / errors[1] == pytest.approx(2, rel=0.05)


def test_method_of_lines_with_curvature_approaches_bcre():
    exact = bcre_pde.solve(CURVED, [2.0], 640)
    errors = []
    for cells in (80, 160):
        lines = method_of_lines.prepare(CURVED, 2.0, cells)()
        errors.append(np.abs(lines.h - coarsened(exact.h[0], cells)).mean())
    assert errors[1] < 5e-4
    assert errors[0] / errors[1] == pytest.approx(2, rel=0.15)


@pytest.mark.parametrize(("kappa", "below"), [(0.0, 2), (0.2, 3)])
def test_jacobian_fills_the_band_that_lsoda_is_told_of_and_no_more(kappa, below):
    problem = replace(OPEN, material=replace(OPEN.material, kappa=kappa))
    cells, step = 12, 1e-6
    rate = method_of_lines.make_rate(problem, cells)
    state = np.random.default_rng(1).uniform(1, 2, 2 * cells)
    columns = [
        rate(0.0, state + step * unit) - rate(0.0, state - step * unit)
        for unit in np.eye(2 * cells)
    ]
    row, column = np.nonzero(np.abs(np.array(columns).T) > 1e-3 * step)
    assert (row - column).max() == below
    assert (column - row).max() == 2


def test_band_changes_neither_the_solution_nor_its_error():
    stiff = replace(OPEN, material=replace(OPEN.material, D=20.0))
    whole = method_of_lines.prepare(stiff, 20.0, 60, banded=False)()
    banded = method_of_lines.prepare(stiff, 20.0, 60)()
    np.testing.assert_allclose(banded.R, whole.R, rtol=1e-4, atol=1e-5)
    assert banded.evaluations < whole.evaluations / 2


@pytest.mark.parametrize("problem", [OPEN, PERIODIC, CURVED])
def test_rates_of_the_method_of_lines_conserve_sand_but_for_the_outflow(problem):
    rate = method_of_lines.make_rate(problem, 30)
    state = np.random.default_rng(2).uniform(0, 2, 60)
    outflow = problem.material.v * state[-1] if problem.ends == "open" else 0.0
    assert rate(0.0, state).sum() * problem.length / 30 == pytest.approx(-outflow, abs=1e-12)


def test_lsoda_that_gives_up_says_so(monkeypatch):
    failed = OptimizeResult(success=False, message="Unexpected istate in LSODA.")
    monkeypatch.setattr(method_of_lines, "solve_ivp", lambda *_, **__: failed)
    with pytest.raises(RuntimeError, match=r"LSODA gave up: Unexpected istate in LSODA\."):
        method_of_lines.prepare(OPEN, 1.0, 20)()


needs_fipy = pytest.mark.skipif(not fipy_solver.available(), reason="FiPy is not installed")
quiet = pytest.mark.filterwarnings("ignore:numpy.core:DeprecationWarning")


@needs_fipy
@quiet
@pytest.mark.parametrize("kappa", [0.0, 1.0])
def test_fipy_approaches_bcre_and_conserves_sand(kappa):
    problem = replace(PERIODIC, material=replace(OPEN.material, kappa=kappa))
    exact = bcre_pde.solve(problem, [1.0], 320)
    errors = []
    for cells in (20, 40):
        solved = fipy_solver.prepare(problem, 1.0, cells, dt=2.0 / cells)()
        h, R = problem.initial(solved.x)
        assert (solved.h + solved.R).sum() == pytest.approx((h + R).sum(), rel=1e-12)
        h_error = np.abs(solved.h - coarsened(exact.h[0], cells)).mean()
        R_error = np.abs(solved.R - coarsened(exact.R[0], cells)).mean()
        errors.append((h_error, R_error))
    (h_coarse, R_coarse), (h_fine, R_fine) = errors
    assert h_fine < 1e-3
    assert R_fine < 5e-3
    assert h_coarse / h_fine > 1.4
    assert R_coarse / R_fine > 1.8


@needs_fipy
@quiet
def test_fipy_takes_no_notice_of_where_h_is_counted_from():
    def raised(x):
        h, R = rolling_sand(x)
        return h + 1000, R

    low = fipy_solver.prepare(PERIODIC, 0.4, 20, dt=0.1)()
    high = fipy_solver.prepare(replace(PERIODIC, initial=raised), 0.4, 20, dt=0.1)()
    np.testing.assert_allclose(high.h - 1000, low.h, rtol=0, atol=1e-10)
    np.testing.assert_allclose(high.R, low.R, rtol=0, atol=1e-10)


@needs_fipy
@quiet
def test_fipy_lets_sand_out_at_the_foot_only():
    pulse = replace(OPEN, initial=lambda x: (0.4 * (LENGTH - x), np.exp(-(((x - 14) / 2) ** 2))))
    exact = bcre_pde.solve(pulse, [6.0], 320)
    solved = fipy_solver.prepare(pulse, 6.0, 80, dt=0.1)()
    d = LENGTH / 80
    h, R = pulse.initial(solved.x)
    out = d * ((h + R).sum() - (solved.h + solved.R).sum())
    assert exact.outflow[0] > 1
    assert out == pytest.approx(exact.outflow[0], rel=0.05)


@needs_fipy
@quiet
def test_fipy_starts_afresh_at_every_call():
    solve = fipy_solver.prepare(PERIODIC, 0.4, 20, dt=0.1)
    first, second = solve(), solve()
    assert first.h.tobytes() == second.h.tobytes()
    assert first.R.tobytes() == second.R.tobytes()
