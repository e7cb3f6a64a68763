"""The map of agreement: closed forms against the models, rules that count right, and the report."""

import math
from concurrent.futures import Future
from contextlib import nullcontext

import numpy as np
import pandas as pd
import pytest
from click.testing import CliRunner
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.figure import Figure

from bcre_ca import Rule, evolve
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.models.registry import AUTOMATON
from bcre_studies.sweeps import sweep
from bcre_studies.sweeps.table import read
from bcre_studies.sweeps.workers import ClusterError
from bcre_studies.system.files import REPORTS
from bcre_studies.validation.agreement_map import comparison, fine, prediction, rules, study
from bcre_studies.validation.agreement_map.measured import (
    COLUMNS,
    FAILED,
    TOLERANCE,
    compared,
    measure,
)
from bcre_studies.validation.agreement_map.pulses import Pulse, drawn, scene_of
from bcre_studies.validation.agreement_map.thresholds import (
    HALF_WIDTH,
    LENGTH,
    Setting,
    threshold,
)

STILL = Pulse(peclet=1.0, courant=0.2, growth=0.0, thickness=1e-6, cells_a_width=6.0, reach=1.0)


def with_changes(**changes):
    return Pulse(**{**vars(STILL), **changes})


def test_the_scene_has_the_groups_of_its_pulse():
    for pulse in drawn(50, 9):
        scene = scene_of(pulse)
        m, t, dt = scene.material, scene.time.until, scene.time.step
        (rolling,), (surface,) = scene.rolling, scene.surface
        assert m.v * scene.d / m.D == pytest.approx(pulse.peclet)
        assert t / dt == pytest.approx(pulse.steps)
        assert m.v * dt / scene.d == pytest.approx(pulse.courant, rel=0.6 / pulse.steps)
        assert m.gamma * (surface.slope - m.Sc) * t == pytest.approx(pulse.growth)
        assert m.gamma * rolling.amplitude / m.v == pytest.approx(pulse.thickness)
        assert rolling.width / scene.d == pytest.approx(pulse.cells_a_width)
        assert m.v * t / rolling.width == pytest.approx(pulse.reach)


@given(st.floats(1e-3, 3.0))
def test_relative_l1_of_two_widths_is_the_integral_of_their_difference(r):
    x = np.linspace(-30, 30, 60_001)
    narrow = np.exp(-(x**2) / 2) / math.sqrt(2 * math.pi)
    wide = np.exp(-(x**2) / (2 * (1 + r))) / math.sqrt(2 * math.pi * (1 + r))
    expected = float(np.abs(wide - narrow).sum() * (x[1] - x[0]))
    assert prediction.by_width(r) == pytest.approx(expected, abs=1e-6)


def test_five_per_cent_are_reached_at_a_broadening_of_0_109():
    assert prediction.largest_broadening(0.05) == pytest.approx(0.109, abs=5e-4)
    assert prediction.by_width(1e-4) / 1e-4 == pytest.approx(0.484, abs=1e-3)


@pytest.mark.parametrize("growth", [-1.5, 0.0, 2.5])
def test_exact_moments_are_those_of_the_automaton_on_a_frozen_slope(growth):
    pulse = with_changes(growth=growth, thickness=1e-12)
    scene = scene_of(pulse)
    rule = Rule(
        1.0, scene.material.D, scene.material.gamma, scene.material.Sc, 1.0, scene.time.step
    )
    x = scene.centres()
    h, start = scene.initial(x)
    _, R = evolve(h, start, rule, pulse.steps, frozen=h)
    t, n = pulse.duration, pulse.steps
    dt, g = t / n, 1 + growth / n
    mass = R.sum()
    mean = R @ x / mass - start @ x / start.sum()
    variance = R @ (x - R @ x / mass) ** 2 / mass
    assert mass / start.sum() == pytest.approx(g**n, rel=1e-6)
    assert mean == pytest.approx(n * dt / g, rel=1e-6)
    b = dt / pulse.peclet
    expected = pulse.cells_a_width**2 / 2 + n * ((dt + 2 * b) / g - (dt / g) ** 2)
    assert variance == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize("growth", [0.0, 1.0, 3.0])
def test_a_thin_pulse_differs_from_bcre_as_predicted(growth):
    pulse = with_changes(growth=growth)
    measured = compared(pulse)
    assert measured["difference_R"] == pytest.approx(
        prediction.by_width_place_and_mass(pulse), rel=0.15
    )
    assert measured["error_R"] < 0.1 * measured["difference_R"]
    assert measured["verdict"] == prediction.by_moments(pulse, TOLERANCE)


def test_a_step_that_cannot_be_stable_is_a_failed_scene_with_its_reason():
    row = measure(with_changes(courant=0.9))
    assert row["verdict"] == FAILED
    assert "cannot be stable" in row["failure"]


@given(
    st.lists(
        st.tuples(st.floats(0.05, 20), st.booleans()),
        min_size=1,
        max_size=30,
        unique_by=lambda scene: scene[0],
    )
)
def test_the_fitted_bound_is_the_best_that_there_is(scenes):
    word = {True: Verdict.AGREE, False: Verdict.DISAGREE}
    pulses = [(with_changes(peclet=peclet), word[agree]) for peclet, agree in scenes]

    def right(bound):
        return sum((pulse.peclet <= bound) == (word == Verdict.AGREE) for pulse, word in pulses)

    found = right(rules._best_bound(pulses))
    assert found >= max(right(bound) for bound in [0.0, *(peclet for peclet, _ in scenes)])


def test_thicker_pulses_run_on_gentler_slopes_and_the_thinnest_from_the_critical_slope_on():
    s = [threshold(Setting(AUTOMATON.name, round(LENGTH), a)) for a in (1e-7, 1e-2, 1.0)]
    rule = Rule(v=1.0, D=1.0, gamma=1.0, Sc=0.0, d=1.0, dt=1.0)
    assert s[0] > s[1] > s[2] + 10 * HALF_WIDTH
    assert s[0] == pytest.approx(4 * rule.second_critical_slope(), abs=0.03)


@pytest.fixture(scope="module")
def tables():
    folder = REPORTS / "agreement_map"
    names = ("comparison", "scenes", "thresholds")
    return {name: pd.read_csv(folder / f"{name}.csv", keep_default_na=False) for name in names}


def test_the_committed_table_follows_from_the_committed_scenes(tables):
    numbers = ["difference_R", "difference_h", "peclet", "thickness"]
    scenes = tables["scenes"].assign(
        **{name: pd.to_numeric(tables["scenes"][name], errors="coerce") for name in numbers}
    )
    again = comparison.compared(scenes, tables["thresholds"])
    committed = tables["comparison"]
    assert list(again["case"]) == list(committed["case"])
    shown = pd.to_numeric(committed["automaton"])
    assert np.allclose(again["automaton"], shown, rtol=0.01, atol=1e-3)


def test_of_the_committed_scenes_none_was_used_both_to_find_and_to_test_a_rule(tables):
    scenes = tables["scenes"]
    assert len(scenes) == study.FITTED + study.TESTED
    assert len(scenes[scenes["seed"] == comparison.TEST_SEED]) >= 500
    assert not scenes.drop(columns="seed").duplicated().any()


class Here:
    """Workers that are this process."""

    died = ()

    def count(self):
        return 1

    def submit(self, function, *arguments):
        future = Future()
        future.set_result(function(*arguments))
        return future


def predicted_alone(pulse):
    """Stands for runs of the models, which take long."""
    if pulse.growth < -1.5:
        raise ValueError("the automaton's step cannot be stable")
    R = prediction.by_width_place_and_mass(pulse)
    numbers = {name: R for name, kind in COLUMNS.items() if kind is float}
    return numbers | {"verdict": str(prediction.by_moments(pulse, TOLERANCE))}


def test_the_fine_map_is_a_sweep_that_ends_in_the_tables_of_the_study(
    tables, tmp_path, monkeypatch
):
    numbers = tables["thresholds"].apply(lambda c: c if c.name == "model" else pd.to_numeric(c))
    monkeypatch.setattr(sweep, "workers_of", lambda _: nullcontext(Here()))
    monkeypatch.setattr(fine, "thresholds_of", lambda _: numbers)
    monkeypatch.setattr(fine, "compared", predicted_alone)
    monkeypatch.setattr(fine, "draw", lambda _: Figure())
    ended = CliRunner().invoke(fine.main, ["--scenes", "60", "--out", str(tmp_path)])
    assert ended.exit_code == 0, ended.output
    scenes = read(tmp_path)
    pulses = [*drawn(6, comparison.FIT_SEED), *drawn(54, comparison.TEST_SEED)]
    assert scenes["peclet"].tolist() == [pulse.peclet for pulse in pulses]
    refused = [pulse.growth < -1.5 for pulse in pulses]
    assert (scenes["failure"] != "").tolist() == scenes["difference_R"].isna().tolist() == refused
    written = pd.read_csv(tmp_path / "comparison.csv").set_index(["quantity", "case"])
    assert set(written.index.get_level_values(0)) == set(tables["comparison"]["quantity"])
    failed = written.loc[("share of scenes", FAILED), "count"]
    assert failed == f"{sum(refused[6:])} of 54"
    assert (tmp_path / "figure.svg").exists()


def test_a_scheduler_that_does_not_answer_ends_the_fine_map_with_one_line(tmp_path, monkeypatch):
    def refuse(_):
        raise ClusterError("--scheduler = 'nowhere': no scheduler answers there")

    monkeypatch.setattr(sweep, "workers_of", refuse)
    arguments = ["--scenes", "20", "--scheduler", "nowhere", "--out", str(tmp_path)]
    ended = CliRunner().invoke(fine.main, arguments)
    assert ended.exit_code == 2
    assert ended.output == "maps: --scheduler = 'nowhere': no scheduler answers there\n"
