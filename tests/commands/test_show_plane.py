"""``bcre show`` of a scene on a plane: what it says is what a run of it would be."""

import math
import re
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bcre_ca import MARGIN
from bcre_ca.plane.theory import opening_angle
from bcre_studies.models.plane import automaton
from bcre_studies.on_plane import preview
from bcre_studies.on_plane.numbers import numbers_of, opening_angles
from bcre_studies.scenes.listing import plane_names
from bcre_studies.scenes.plane.scene import load

SMALL = [
    *("cells=48", "length=48.0", "width=48.0", "until=300.0", "gamma=0.05"),
    *("surface.0.slope=3.5", "rolling.0.centre=[10.0, 24.0]", "thickness=4.0"),
]


@pytest.mark.parametrize("name", plane_names())
def test_every_built_in_scene_is_shown_and_nothing_is_run(bcre, monkeypatch, name):
    monkeypatch.setattr(automaton, "frames", lambda *_: pytest.fail("run"))
    ended = bcre("show", name)
    assert (ended.code, ended.err) == (0, "")
    for word in ("Courant number", "Peclet number", "gamma R dt/d", "keeps R >= 0", "Sd = ", "MB"):
        assert word in ended.out
    assert "nan" not in ended.out
    assert ("there is no closed form on a free surface" in ended.out) == (
        load(name).automaton.flow != "tilted"
    )
    assert not any(Path().iterdir())


def test_numbers_of_the_triangular_avalanche_are_those_of_its_closed_forms(bcre):
    said = bcre("show", "triangular_avalanche").out
    assert "Sd = 2.216 (Sd - Sc = 1.716) in the automaton, 3 (Sd - Sc = 2.5) in BCRE" in said
    assert "theta = 44.65 degrees in the automaton, 39.23 in BCRE" in said
    assert "S = 1.5, above repose, below Sd" in said
    assert "R(i,j) += 1.6 (F(i-1,j) - F(i,j) + G(i,j-1) - G(i,j))" in said
    uphill = bcre("show", "uphill_avalanche").out
    assert "theta = 90 degrees in the automaton, 90 in BCRE" in uphill
    below = bcre("show", "triangular_avalanche", "--set", "surface.0.slope=0.4").out
    assert "nothing is steeper than repose" in below
    assert "which is not stable" in bcre("show", "triangular_avalanche", "--set", "step=3").out


@given(
    v=st.floats(0.05, 2),
    D=st.floats(0.02, 2),
    D_across=st.floats(0.02, 2),
    gamma=st.floats(0.01, 1),
)
def test_numbers_follow_their_formulas(v, D, D_across, gamma):
    values = {"v": v, "D": D, "D_across": D_across, "gamma": gamma}
    scene = load("triangular_avalanche", [f"{key}={value!r}" for key, value in values.items()])
    numbers = numbers_of(scene)
    layer = v + 2 * (D + D_across)
    assert numbers.slope == pytest.approx((1.5, 1.5, 1.5))
    assert numbers.layer_step == pytest.approx(1 / layer)
    assert numbers.wave_step(2.0) == pytest.approx(1 / (2 * gamma))
    fastest = max(layer, gamma * numbers.largest_R)
    assert numbers.rule.dt == pytest.approx(MARGIN / fastest)
    assert numbers.is_stable
    own, pde = opening_angles(numbers, scene)
    assert own == pytest.approx(opening_angle(v, D, D_across, gamma, 1.0))
    short = v**2 / (4 * D * gamma) - 1
    expected = 90 if short <= 0 else math.degrees(math.atan(math.sqrt(D_across / D / short)))
    assert pde == pytest.approx(expected)


def test_on_four_neighbours_sand_leaves_to_two_sides():
    numbers = numbers_of(load("obstacle"))
    assert numbers.layer_step == pytest.approx(1 / (2 * 1.0 / 0.5 + 4 * 0.1 / 0.25 + 0.2 * 0.5))
    assert numbers.wave_step(1.0) == pytest.approx(0.5 / (2 * 0.2))
    assert math.isinf(numbers.thickest)


def test_a_run_takes_the_steps_and_has_the_layers_that_were_said():
    scene = load("triangular_avalanche", SMALL)
    numbers = numbers_of(scene)
    run = automaton.run(scene, [0.0, 50.0, 100.0, 300.0], threads=1)
    least, most = preview._steps(scene, numbers)
    assert math.floor(least) <= run.steps <= most
    assert numbers.largest_R == run.R[0].max() < run.R.max() <= numbers.thickest


def test_times_come_from_the_record_and_are_not_known_without_it(bcre, monkeypatch, tmp_path):
    said = bcre("show", "triangular_avalanche").out
    for model in ("automaton", "BCRE"):
        assert re.search(rf"^time, {model}: +[0-9.]+ m?s to [0-9.]+ m?s, ", said, re.MULTILINE)
    monkeypatch.setattr("bcre_studies.system.files.REPORTS", tmp_path)
    monkeypatch.setattr("bcre_studies.system.records.SHIPPED", tmp_path)
    assert "not known: " in bcre("show", "triangular_avalanche").out


@pytest.mark.parametrize(
    ("scene", "change", "message"),
    [
        ("obstacle", "source.0.place=[500.0, 40.0]", "sources[0]: no cell that can hold sand"),
        ("terrain", "surface.0.file=none.asc", "surface.0.file = 'none.asc': no such file"),
        ("uphill_avalanche", "cells=90000", "must be at most 1e+08 cells in all"),
    ],
)
def test_what_a_run_refuses_is_refused_in_one_line(bcre, scene, change, message):
    ended = bcre("show", scene, "--set", change)
    assert ended.code == 2
    assert message in ended.err
    assert ended.err.count("\n") == 1
