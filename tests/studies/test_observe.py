"""What is read off a run is what was put in."""

import math

import numpy as np
import pytest

import bcre_pde
from bcre_studies.comparison.compare import Comparison, compare_each
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.models.run import Run
from bcre_studies.observables import fronts
from bcre_studies.scenes.scene import load

SCENE = load("figure3")


def run_of(x, t, R=None, u=None):
    R = np.zeros((len(t), x.size)) if R is None else np.asarray(R)
    u = np.zeros((len(t), x.size)) if u is None else np.asarray(u)
    h = u - SCENE.material.Sc * x
    return Run(SCENE, x, np.asarray(t, dtype=float), h, R, np.zeros(len(t)), 0, 0)


def centres(cells, length=100.0):
    return (np.arange(cells) + 0.5) * length / cells


def test_an_edge_is_found_between_cells():
    assert fronts.edge(np.array([0.5, 1.5, 2.5]), np.array([0.0, 1.0, 5.0]), 2.0) == 1.75


def test_an_edge_that_is_not_there_is_no_number():
    x = centres(10)
    assert math.isnan(fronts.edge(x, np.zeros(10), 1.0))
    assert math.isnan(fronts.exponential_edge(x, np.full(10, 1e-9), 1.0))


def test_an_edge_at_the_top_is_the_first_cell():
    assert fronts.edge(np.array([0.5, 1.5]), np.array([3.0, 0.0]), 1.0) == 0.5


@pytest.mark.parametrize("scale", [1.0, 1e-150])
def test_the_edge_of_a_gaussian_is_found_to_a_thousandth_of_a_cell(scale):
    x = centres(100)
    R = scale * np.exp(-(((x - 53.3) / 6.1) ** 2))
    expected = 53.3 - 6.1 * math.sqrt(math.log(1e4))
    assert fronts.exponential_edge(x, R, 1e-4 * scale) == pytest.approx(expected, abs=1e-3)


def test_the_front_of_a_point_release_moves_at_its_closed_form():
    v, D, sigma = 0.07, 0.13, 0.029
    x, t = centres(400, 160.0), np.array([150.0, 300.0, 600.0])
    R = [1e-150 * bcre_pde.theory.frozen_slope_release(x - 110, at, 1.0, v, D, sigma) for at in t]
    speed = fronts.front_speed(run_of(x, t, R=R), 6e-152)
    assert speed == pytest.approx(2 * math.sqrt(D * sigma) - v, rel=2e-4)


def test_a_mode_that_decays_and_climbs_has_its_rate_and_speed():
    x, k = centres(50), 2 * math.pi * 3 / 100
    before, after = np.sin(k * x), 0.8 * np.sin(k * (x + 2.5))
    rate = fronts.mode_rate(x, before, after, 5.0, k)
    assert rate.real == pytest.approx(math.log(0.8) / 5, rel=1e-12)
    assert rate.imag / k == pytest.approx(0.5, rel=1e-12)


def test_a_mode_is_not_disturbed_by_others():
    x, k = centres(64), 2 * math.pi * 3 / 100
    other = 7 * np.cos(5 * k * x) + 2
    rate = fronts.mode_rate(x, np.sin(k * x) + other, 0.5 * np.sin(k * x) - other, 1.0, k)
    assert rate == pytest.approx(math.log(0.5), abs=1e-12)


def test_a_scarp_that_climbs_ever_faster_has_the_speed_at_that_height():
    x, t = centres(2000), np.linspace(0, 20, 201)
    place = 80 - 40 * np.expm1(0.02 * t)[:, None]
    u = np.where((x > place) & (x < 80), 20.0, 100 - x)
    run = run_of(x, t, u=u)
    heights, places = fronts.scarps(run)
    assert heights[-1] == pytest.approx(80 - place[-1, 0], abs=0.1)
    assert places[-1] == pytest.approx(place[-1, 0], abs=0.1)
    assert fronts.scarp_speed(run, 10.0) == pytest.approx(0.02 * (10 + 40), rel=0.02)


def test_a_scarp_that_never_gets_so_high_has_no_speed():
    x, t = centres(100), np.linspace(0, 10, 11)
    assert math.isnan(fronts.scarp_speed(run_of(x, t), 5.0))


def test_roughness_of_a_sine_is_its_amplitude_over_root_two():
    x = centres(64)
    wave = 3 + 0.2 * np.sin(2 * np.pi * 4 * x / 100)
    assert fronts.roughness(wave) == pytest.approx(0.2 / math.sqrt(2))


def comparison(automaton, pde, effective, scale, error=0.0):
    nominal, own = (
        bcre_pde.Measured(value, error, cells=(8, 16, 32)) for value in (pde, effective)
    )
    return Comparison(automaton, nominal, own, 0.05, scale)


def test_a_rate_that_is_zero_in_the_pde_is_judged_by_the_scale():
    result = comparison(0.02, 1e-9, 0.0201, scale=0.02)
    assert result.difference == pytest.approx(1.0)
    assert result.verdict == Verdict.EXPLAINED
    row = result.row()
    assert row["pde"] == 0
    assert math.copysign(1, comparison(0.02, -1e-9, 0.02, 0.02).row()["pde"]) == 1


def test_an_error_that_is_too_large_leaves_the_comparison_unresolved():
    assert comparison(1.0, 1.5, 1.0, scale=1.0, error=0.1).verdict == Verdict.UNRESOLVED


def test_each_number_is_compared_by_itself():
    scene = load("figure3").with_changes(until=1.0)
    mass, foot = compare_each(
        scene,
        [1.0],
        lambda run: [run.mass()[-1], run.R[-1].max()],
        [100.0, 1.0],
        0.05,
        coarsest=50,
        finest=200,
    )
    assert mass.difference < 1e-6
    assert mass.verdict == Verdict.AGREE
    assert foot.difference > 0.01
    assert foot.pde.cells == (50, 100, 200)
