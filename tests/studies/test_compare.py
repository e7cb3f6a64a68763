import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import bcre_pde
from bcre_studies.comparison.compare import Comparison, compare
from bcre_studies.comparison.difference import relative_difference
from bcre_studies.comparison.error import relative_error
from bcre_studies.comparison.rounding import significant, to_error
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.models.registry import AUTOMATON
from bcre_studies.models.run import Run
from bcre_studies.scenes.scene import load


def refined(value, error, allowed):
    return bcre_pde.Measured(value, error, 2.0, allowed, (100, 200, 400))


def test_relative_difference_of_profiles_is_that_of_their_areas():
    assert relative_difference([1.0, 2.0, 3.0], [2.0, 2.0, 2.0]) == pytest.approx(1 / 3)
    assert relative_difference(1.1, 1.0) == pytest.approx(0.1)
    assert relative_difference(0.0, 0.0) == 0.0
    assert relative_difference(1.0, 0.0) == math.inf


def test_relative_error_is_infinite_where_nothing_is_measured():
    assert relative_error(refined(2.0, 0.1, 1.0)) == pytest.approx(0.05)
    assert relative_error(refined(0.0, 0.1, 1.0)) == math.inf


@given(value=st.floats(1e-6, 1e6), digits=st.integers(1, 8))
def test_rounding_to_digits_is_within_half_a_unit_of_the_last(value, digits):
    rounded = significant(value, digits)
    assert abs(rounded - value) <= 0.5 * 10 ** (math.floor(math.log10(value)) - digits + 1) * (
        1 + 1e-9
    )
    assert significant(-value, digits) == -rounded


@pytest.mark.parametrize(
    ("value", "error", "expected"),
    [
        (1.23456789, 0.01, 1.23),
        (1.23456789, 0.3, 1.2),
        (1.23456789, 5.0, 1.0),
        (123.456789, 0.01, 123.46),
        (1.23456789, 1e-12, 1.2346),
        (1.23456789, 0.0, 1.2346),
        (-1.23456789, 0.01, -1.23),
        (0.0, 0.1, 0.0),
    ],
)
def test_number_is_rounded_to_the_place_of_its_error(value, error, expected):
    assert to_error(value, error) == expected


def test_numbers_that_are_not_finite_are_left_alone():
    assert significant(math.inf, 3) == math.inf
    assert to_error(math.inf, 0.1) == math.inf
    assert to_error(2.5, math.inf) == 2.5


@pytest.mark.parametrize("ends", ["open", "periodic"])
def test_sampling_between_cells_is_sixth_order(ends):
    k, gaps = 2 * np.pi / 20, []
    x = np.linspace(2, 18, 33) if ends == "open" else np.linspace(0, 20, 41)
    for cells in (40, 80):
        scene = load("climbing_wave" if ends == "periodic" else "figure2").with_changes(length=20.0)
        places = (np.arange(cells) + 0.5) * 20 / cells
        R = 2 + np.sin(k * places)
        run = Run(scene, places, np.zeros(1), R[None], R[None], np.zeros(1), 0, 0)
        gaps.append(np.abs(run.sample(x) - 2 - np.sin(k * x)).max())
    assert gaps[1] < 1e-6
    assert math.log2(gaps[0] / gaps[1]) > 5


def test_sampling_at_the_cells_themselves_changes_nothing():
    scene = load("figure2")
    run = AUTOMATON.run(scene, [0.0, 2.0])
    assert np.array_equal(run.sample(scene.centres()), run.R[-1])
    assert np.array_equal(run.sample(scene.centres(), "u", 0), run.u[0])


def test_verdict_of_a_comparison_follows_from_its_differences():
    close, far = refined(1.0, 1e-4, 1e-2), refined(2.0, 1e-4, 1e-2)
    loose = refined(2.0, 1.0, 1e-2)
    assert Comparison(1.01, close, far, 0.05).verdict is Verdict.AGREE
    assert Comparison(1.01, far, close, 0.05).verdict is Verdict.EXPLAINED
    assert Comparison(1.01, far, far, 0.05).verdict is Verdict.DISAGREE
    assert Comparison(1.01, loose, close, 0.05).verdict is Verdict.UNRESOLVED


def test_row_of_a_number_is_rounded_as_its_errors_justify():
    row = Comparison(1.234567, refined(1.2, 0.003, 0.01), refined(1.23456, 2e-4, 0.01), 0.05).row()
    assert row["automaton"] == 1.2346
    assert row["pde"] == 1.2
    assert row["pde_effective"] == 1.2346
    assert row["difference"] == pytest.approx(0.0288)
    assert row["pde_cells"] == 400
    assert row["verdict"] == "agree"


@pytest.mark.parametrize(
    ("name", "nominal", "effective"), [("figure2", 0.53, 0.007), ("figure3", 0.39, 0.007)]
)
def test_figures_2_and_3_differ_by_the_automatons_own_diffusion(name, nominal, effective):
    scene = load(name)
    x = scene.centres()
    found = compare(
        scene, [scene.time.until], lambda run: run.sample(x), 0.05, coarsest=100, finest=400
    )
    assert found.difference == pytest.approx(nominal, rel=0.1)
    assert found.difference_effective == pytest.approx(effective, rel=0.1)
    assert found.verdict is Verdict.EXPLAINED
    assert found.pde.error <= 0.1 * found.difference * np.mean(np.abs(found.pde.value))


def test_solution_that_no_grid_settles_is_unresolved():
    """Past the scarp of figure 1 BCRE without its curvature term keeps changing with the grid."""
    scene = load("figure1").with_changes(until=230.0, step=0.4)
    found = compare(
        scene, [230.0], lambda run: float(run.R[-1].max()), 0.01, coarsest=50, finest=200
    )
    assert not found.pde.resolved
    assert found.verdict is Verdict.UNRESOLVED
