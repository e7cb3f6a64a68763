"""Who competes, against which truth, and when a contender is tried no further."""

import math
import os
import subprocess
import sys
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from bcre_studies.performance.record import contest
from bcre_studies.performance.rivals import fipy_solver
from bcre_studies.performance.rivals.rivals import EndState

WAVE = contest.WAVE
IN_PROCESS = [
    contender
    for contender in contest.own() + contest.rivals()
    if not contender.name.startswith("py-pde")
]


def exact_end(scene, cells):
    x = scene.centres(cells)
    return EndState(x, *contest.truth_of(scene).layers(x), steps=1, evaluations=1)


@pytest.mark.parametrize("label", ["figure 2", WAVE])
@pytest.mark.parametrize("cells", [50, 333])
def test_exact_layers_have_no_error(label, cells):
    scene = contest.scenes()[label]
    assert set(contest.errors(scene, exact_end(scene, cells)).values()) == {0.0}


def test_each_error_tells_of_its_own_layer():
    scene = contest.scenes()["figure 2"]
    exact = exact_end(scene, 100)
    start, _ = scene.initial(exact.x)
    thicker = contest.errors(scene, replace(exact, R=1.03 * exact.R))
    assert thicker["error_R"] == pytest.approx(0.03, rel=1e-9)
    assert thicker["error_front"] < 1e-9
    assert thicker["error_h"] == thicker["error_slope"] == 0
    unmoved = contest.errors(scene, replace(exact, h=start))
    assert unmoved["error_h"] == pytest.approx(1.0, rel=1e-9)
    assert unmoved["error_R"] == 0
    tilted = contest.errors(scene, replace(exact, h=exact.h + 0.02 * exact.x))
    assert tilted["error_slope"] == pytest.approx(0.02, rel=1e-9)
    moved = contest.errors(scene, replace(exact, R=np.roll(exact.R, 2)))
    assert moved["error_front"] == pytest.approx(2.0, abs=1e-6)


def test_truth_of_figure_2_is_known_to_better_than_a_millionth():
    truth = contest.truth_of(contest.scenes()["figure 2"])
    assert 0 < truth.error < 1e-6


def test_truth_of_the_wave_is_its_exact_solution_and_says_so():
    scene = contest.scenes()[WAVE]
    truth = contest.truth_of(scene)
    x = scene.centres(64)
    h, R = truth.layers(x)
    assert truth.error == 0
    # R0(x + gamma R t) with R0 = 1 + 0.3 exp(-((x - 10)/1.5)^2)
    expected = 1 + 0.3 * np.exp(-(((x + 0.5 * R * 2.0 - 10) / 1.5) ** 2))
    assert np.abs(R - expected).max() < 1e-9
    level = h + 0.5 * x + R + 2.0 * np.log(R)
    assert level == pytest.approx(np.full(64, level[0]), abs=1e-9)


def upwind_ratios(label, grids):
    scene, upwind = contest.scenes()[label], contest.own()[0]
    found = [contest.errors(scene, upwind.prepare(scene, cells)())["error_R"] for cells in grids]
    return [coarse / fine for coarse, fine in pairwise(found)]


def test_upwind_error_halves_with_the_cell_on_the_wave():
    assert upwind_ratios(WAVE, (100, 200, 400, 800)) == pytest.approx([2, 2, 2], abs=0.1)


def test_upwind_error_falls_by_less_than_half_on_figure_2():
    """(v d/2)(1 - v dt/d) is many times D, and D shortens the step more and more as d falls."""
    assert all(1.4 < ratio < 2 for ratio in upwind_ratios("figure 2", (100, 200, 400, 800, 1600)))


def test_calibrated_and_limited_rules_are_nearer_to_the_truth_of_figure_2_than_the_printed():
    scene, (upwind, calibrated, limited) = contest.scenes()["figure 2"], contest.own()[:3]
    error, *better = (
        contest.errors(scene, contender.prepare(scene, 100)())["error_R"]
        for contender in (upwind, calibrated, limited)
    )
    assert max(better) < error / 4


@pytest.mark.parametrize("contender", IN_PROCESS, ids=lambda contender: contender.name)
@pytest.mark.parametrize("label", ["figure 2", WAVE])
@pytest.mark.filterwarnings("ignore:numpy.core:DeprecationWarning")
def test_contender_ends_in_finite_layers_that_have_moved_towards_the_truth(contender, label):
    scene, cells = contest.scenes()[label], contender.coarsest
    assert contender.enters(label)
    end = contender.prepare(scene, cells)()
    assert end.x == pytest.approx(scene.centres(cells), rel=1e-12)
    assert end.h.shape == end.R.shape == (cells,)
    assert np.isfinite(end.h).all()
    assert np.isfinite(end.R).all()
    assert end.steps > 0
    assert end.evaluations >= end.steps
    start = EndState(end.x, *scene.initial(end.x), 1, 1)
    assert contest.errors(scene, end)["error_R"] < contest.errors(scene, start)["error_R"]


# py-pde compiles for a minute or so; the same Python, run as it stands, shows the same numbers.
UNCOMPILED = """
from bcre_studies.performance.record import contest

scene = contest.scenes()[contest.WAVE]
for contender in contest.rivals():
    if contender.name.startswith("py-pde"):
        end = contender.prepare(scene, contender.coarsest)()
        print(contest.errors(scene, end)["error_R"], contender.only == ("figure 2", contest.WAVE))
"""


def test_expressions_of_py_pde_compete_on_two_scenes_only():
    done = subprocess.run(
        [sys.executable, "-c", UNCOMPILED],
        check=True,
        capture_output=True,
        text=True,
        env=os.environ | {"NUMBA_DISABLE_JIT": "1"},
    )
    found = [line.split() for line in done.stdout.splitlines()]
    assert [only for _, only in found] == ["True", "True"]
    assert all(0 < float(error) < 0.02 for error, _ in found)


def test_fipy_competes_where_it_is_installed():
    names = [contender.name for contender in contest.rivals()]
    assert ("FiPy" in names) == fipy_solver.available()


def made_up(most=1e6, coarsest=50, finer=2, a_step=1.0):
    """A contender that does nothing, in ``a_step`` steps per cell."""
    calls = []

    def prepare(scene, cells):
        calls.append(cells)
        x = np.zeros(cells)
        return lambda: EndState(x, x, x, 1, math.ceil(a_step * cells))

    return contest.Contender("made up", prepare, coarsest, most, finer), calls


@pytest.mark.parametrize(
    ("options", "most", "cells"),
    [
        ({"most": 1e6}, None, [50, 100, 200, 400, 800]),
        ({"most": 639_999}, None, [50, 100, 200, 400]),
        ({"most": 640_000}, None, [50, 100, 200, 400, 800]),
        ({"most": 1e6}, 4e4, [50, 100, 200]),
        ({"most": 4e4}, 1e9, [50, 100, 200]),
        ({"most": 1e6, "finer": 4}, None, [50, 200, 800]),
        ({"most": 10.0}, None, [50]),
        ({"most": 1e6, "a_step": 10.0}, None, [50, 100, 200]),
    ],
)
def test_grids_get_finer_until_the_next_would_take_more_than_the_stated_cell_steps(
    options, most, cells
):
    contender, prepared = made_up(**options)
    found = list(contest.rungs(contender, contest.scenes()["figure 2"], most))
    assert [rung for rung, _, _ in found] == prepared == cells
    assert all(end.x.size == rung for rung, _, end in found)
    assert all(solve().evaluations == end.evaluations for _, solve, end in found)


def test_no_contender_of_ours_is_taken_further_than_its_cell_steps():
    """By the fewest steps there can be, a cell a step, for the limited rule on figure 2."""
    limited = replace(contest.own()[2], most=2e5)
    scene = contest.scenes()["figure 2"]
    found = [(cells, cells * end.evaluations) for cells, _, end in contest.rungs(limited, scene)]
    assert [cells for cells, _ in found] == [25, 50, 100, 200][: len(found)]
    assert found[-1][1] <= 2e5 < 4 * found[-1][1]


def test_row_names_its_scene_and_counts_cell_steps():
    scene = contest.scenes()[WAVE]
    end = replace(exact_end(scene, 40), steps=7, evaluations=21)
    row = contest.row_of(WAVE, contest.own()[3], 40, end)
    assert row["scene"] == WAVE
    assert row["contender"] == "PDE, runge-kutta"
    assert (row["cells"], row["steps"], row["cell_steps"]) == (40, 7, 840)
    assert row["error_R"] == row["error_h"] == row["error_front"] == row["error_slope"] == 0


@pytest.mark.parametrize("label", ["figure 2", "figure 3", WAVE])
@pytest.mark.parametrize("cells", [50, 100, 400])
def test_fixed_step_of_the_rivals_divides_the_end_and_is_half_the_bound_at_most(label, cells):
    scene = contest.scenes()[label]
    step = contest._step(scene, cells)
    assert scene.time.until / step == pytest.approx(round(scene.time.until / step), rel=1e-12)
    material = scene.material
    d = scene.domain.length / cells
    assert step <= 0.5 / (material.v / d + 2 * material.D / d**2)
    assert step <= 0.5 / (material.gamma * contest.truth_of(scene).R.max() / d)
