"""The control of height alone: its rule, and which of the paper's properties it has."""

import math

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bcre_ca.height_only import SETTLED, settled
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.models.registry import HEIGHT_ONLY
from bcre_studies.observables.outcome import slope
from bcre_studies.scenes.scene import load
from bcre_studies.validation import one_variable as study

CELLS, D = 60, 0.5
X = (np.arange(CELLS) + 0.5) * D


def rough(seed, amplitude=1.0):
    return amplitude * np.random.default_rng(seed).uniform(-1, 1, CELLS)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10**6), Sc=st.floats(0, 2), amplitude=st.floats(0, 3))
def test_control_with_periodic_ends_conserves_mass_and_flattens_every_roughness(
    seed, Sc, amplitude
):
    h = rough(seed, amplitude) - Sc * X
    end = settled(h, Sc * D, True)[0]
    assert math.fsum(end) == pytest.approx(math.fsum(h), abs=1e-10)
    u = end + Sc * X
    assert np.ptp(u) <= CELLS * 4 * SETTLED + 1e-12


@pytest.mark.parametrize("periodic", [False, True])
@pytest.mark.parametrize("steepness", [-1.0, 0.0, 0.3, 0.5])
def test_slope_not_above_repose_is_left_alone(periodic, steepness):
    h = -steepness * X if not periodic else -0.5 * X
    before = h.copy()
    assert np.array_equal(settled(h, 0.5 * D, periodic)[0], before)
    assert np.array_equal(h, before)


def test_bump_whose_flanks_stand_is_left_alone():
    h = 0.2 * np.sin(X / 2)
    assert np.diff(h).min() > -0.5 * D
    assert np.array_equal(settled(h, 0.5 * D, False)[0], h)


@pytest.mark.parametrize("excess", [0.1, 1.0, 4.0])
@pytest.mark.parametrize("Sc", [0.0, 0.5, 1.3])
def test_slope_above_repose_ends_at_repose_undisturbed(excess, Sc):
    h = (Sc + excess) * (X[-1] - X)
    end, left, _ = settled(h, Sc * D, False)
    assert slope(X, end) == pytest.approx(Sc, abs=1e-6)
    assert (end[:-1] - end[1:]).max() <= Sc * D + 4.1 * SETTLED
    assert end[-1] == h[-1]
    assert left == pytest.approx(h.sum() - end.sum(), rel=1e-9)


def test_input_is_not_changed():
    h = 2.0 * (X[-1] - X)
    before = h.copy()
    settled(h, 0.5 * D, False)
    assert np.array_equal(h, before)


def test_what_is_too_steep_moves_one_cell_down_until_it_stands():
    h = np.array([1.0, 0.0, 0.0, 0.0])
    end = settled(h, 0.5, False)[0]
    assert end == pytest.approx([0.75, 0.25, 0.0, 0.0], abs=1e-8)
    assert end.sum() == pytest.approx(1, abs=1e-12)


@pytest.mark.parametrize("name", ["figure1", "rough_slope"])
def test_the_record_shows_the_sand_as_laid_and_as_settled_and_keeps_its_mass(name):
    scene = load(name)
    run = HEIGHT_ONLY.run(scene, [0.0, 1.0, 2.0], 100)
    assert run.mass_error() < 1e-12
    assert run.h[0] == pytest.approx(np.sum(scene.initial(scene.centres(100)), axis=0))
    assert np.array_equal(run.h[1], run.h[2])
    assert not run.R.any()


@pytest.mark.parametrize(("excess", "pulse"), [(0.5, 1.0), (3.2, 0.0)])
def test_control_returns_to_repose_where_two_layers_do_not(excess, pulse):
    row = study.final_slope(excess, pulse)
    assert row["one_variable"] == pytest.approx(0, abs=1e-3)
    assert row["automaton"] == pytest.approx(excess, rel=1e-2)
    assert row["pde"] == pytest.approx(excess, rel=1e-2)


@given(seed=st.integers(0, 10**6), periodic=st.booleans())
def test_control_that_starts_where_it_stops_is_the_plain_one_to_the_bit(seed, periodic):
    h = rough(seed) - 0.5 * X
    plain, found = settled(h, 0.5 * D, periodic), settled(h, 0.5 * D, periodic, 0.5 * D)
    assert np.array_equal(plain[0], found[0])
    assert plain[1:] == found[1:]


def test_control_with_angles_of_start_and_stop_stands_between_them_until_it_is_disturbed():
    h = 1.0 * (X[-1] - X)
    assert np.array_equal(settled(h, 0.5 * D, False, 1.2 * D)[0], h)
    h[30] += 0.2 * D
    assert np.array_equal(settled(h, 0.5 * D, False, 1.2 * D + 1e-9)[0], h)
    h[30] += 0.2 * D
    end = settled(h, 0.5 * D, False, 1.2 * D)[0]
    assert slope(X, end) == pytest.approx(0.5, abs=1e-6)
    steep = 1.3 * (X[-1] - X)
    assert slope(X, settled(steep, 0.5 * D, False, 1.2 * D)[0]) == pytest.approx(0.5, abs=1e-6)


def test_control_changes_the_surface_less_far_uphill_than_two_layers_do():
    row = study.reach()
    assert 0 < row["one_variable"] < 0.5 * row["automaton"]
    assert row["automaton"] == pytest.approx(row["pde"], abs=0.6)


def test_control_smooths_more_than_two_layers_and_bcre_not_at_all():
    row = study.roughness()
    assert row["one_variable"] <= 1e-5
    assert 0.2 < row["automaton"] < 0.6
    assert row["pde"] == pytest.approx(1, abs=0.01)


def verdicts(stands=None, rough=0.1, reach=1.0, control=0.0, sticks=()):
    rows = [
        ("final S - Sc", f"S0 - Sc = {excess:g}, pulse {pulse:g}", control, kept, kept, stuck)
        for excess in study.EXCESSES
        for pulse in study.PULSES
        for kept in [excess if stands is None and pulse == 0 else stands or 0.0]
        for stuck in [excess if excess in sticks and pulse == 0 else 0.0]
    ]
    rows += [("RMS of u, end over start", "rough_slope", rough, 0.4, 1.0, 1.0)]
    rows += [("reach uphill", "figure3", reach, 6.5, 6.25, 2.5)]
    columns = ["quantity", "case", "one_variable", "automaton", "pde", study.STICKING]
    claims = study.judge({"comparison": pd.DataFrame(rows, columns=columns)})
    return [claim.verdict is Verdict.AGREE for claim in claims]


def test_every_claim_can_fail():
    assert verdicts() == [True, True, True, True]
    assert verdicts(control=0.2) == [False, True, True, False]
    assert verdicts(rough=0.99) == [True, False, True, True]
    assert verdicts(reach=6.4) == [True, True, False, True]
    assert verdicts(stands=0.1) == [True, True, True, False]
    assert verdicts(sticks=(1.5,)) == [True, True, True, False]


def test_one_layer_with_angles_of_start_and_stop_stands_above_repose_and_falls_when_disturbed():
    assert study.final_slope(1.5, 0.0)[study.STICKING] == pytest.approx(1.5, rel=1e-3)
    assert study.final_slope(1.5, 1.0)[study.STICKING] == pytest.approx(0, abs=1e-3)
    assert study.final_slope(3.2, 0.0)[study.STICKING] == pytest.approx(0, abs=1e-3)
