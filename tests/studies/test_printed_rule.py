"""The printed rule in every reading: what it measures, what it breaks, what it cannot show."""

from dataclasses import replace
from itertools import product

import numpy as np
import pandas as pd
import pytest

import bcre_ca
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.models.automaton import rule_of
from bcre_studies.observables.outcome import slope
from bcre_studies.scenes.scene import load
from bcre_studies.validation.printed_rule import study
from bcre_studies.validation.printed_rule.updated import march


def rule(v=0.1, D=0.1, d=1.0, dt=1.0, order="synchronous", sign="consistent"):
    return bcre_ca.Rule(v, D, 0.01, 0.5, d, dt, sign, order)


@pytest.mark.parametrize(
    ("order", "drift", "diffusion"),
    [("synchronous", 0.100, 0.145), ("right", 0.125, 0.211), ("left", 0.111, 0.148)],
)
def test_drift_and_diffusion_of_the_three_orders(order, drift, diffusion):
    found = study.moments(rule(order=order))
    assert found == pytest.approx((drift, diffusion), abs=5e-4)


@pytest.mark.parametrize(("v", "D", "d", "dt"), [(0.3, 0.2, 0.5, 0.4), (1.1, 0.05, 2.0, 0.9)])
def test_only_the_synchronous_order_keeps_the_drift(v, D, d, dt):
    kept, diffusion = study.moments(rule(v, D, d, dt))
    assert kept == pytest.approx(v, rel=1e-3)
    assert diffusion == pytest.approx(D + v * d / 2 * (1 - v * dt / d), rel=1e-3)
    for order in ("right", "left"):
        assert study.moments(rule(v, D, d, dt, order))[0] > 1.01 * v


def test_literal_step_of_figures_2_and_3_amplifies_the_shortest_wave_by_4_4():
    assert study.shortest_wave(rule(v=2.5)) == pytest.approx(4.4, rel=1e-3)
    assert study.moments(rule(v=2.5))[1] < 0
    stable = 1 / (2.5 + 2 * 0.1)
    assert study.shortest_wave(rule(v=2.5, dt=stable)) <= 1


@pytest.mark.parametrize(("v", "D", "d", "dt"), [(0.3, 0.2, 0.5, 0.4), (2.0, 0.4, 1.0, 1.0)])
def test_amplification_of_the_shortest_wave_is_that_of_its_closed_form(v, D, d, dt):
    expected = abs(1 - 2 * v * dt / d - 4 * D * dt / d**2)
    assert study.shortest_wave(rule(v, D, d, dt)) == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("figure", ["figure2", "figure3"])
def test_literal_step_is_not_finite_on_figures_2_and_3_in_any_order_or_sign(figure):
    for sign, order in product(study.SIGNS, study.ORDERS):
        row = study.read(figure, "literal", sign, order)
        assert row["dt"] == 1.0
        assert not any(row[fact] for fact in ("finite", "R_not_negative", "ends", "caption"))


@pytest.mark.parametrize("order", study.ORDERS)
def test_printed_sign_erodes_figure_1_past_repose_to_the_reverse_slope(order):
    scene = load("figure1")
    start = bcre_ca.Pile(*scene.initial(scene.centres()))
    ends = {}
    for sign in study.SIGNS:
        reading = replace(rule_of(scene), sign=sign, order=order)
        (end,) = bcre_ca.frames(start, reading, [6000.0])
        ends[sign] = slope(scene.centres(), end.h)
    assert ends["consistent"] == pytest.approx(0.5, abs=1e-3)
    assert ends["printed"] == pytest.approx(-0.5, abs=5e-3)


def test_stable_readings_keep_mass_and_the_layer_non_negative():
    for figure, sign, order in product(study.FIGURES, study.SIGNS, study.ORDERS):
        row = study.read(figure, "stable", sign, order)
        assert row["finite"]
        assert row["R_not_negative"]
        assert row["mass_error"] <= 1e-12
        assert row["amplification"] <= 1


def test_consistent_synchronous_stable_reading_meets_all_captions_and_the_printed_not_figure_1():
    for figure in study.FIGURES:
        assert study.read(figure, "stable", "consistent", "synchronous")["caption"]
    assert not study.read("figure1", "stable", "printed", "synchronous")["caption"]


def test_caption_is_not_met_by_what_did_not_happen():
    for figure in study.FIGURES:
        scene = load(figure)
        start = bcre_ca.Pile(*scene.initial(scene.centres()))
        (end,) = bcre_ca.frames(start, rule_of(scene), [scene.time.until * 5])
        assert not study.caption(figure, start, start)
        negative = np.where(np.arange(end.R.size) == 7, -1e-9, end.R)
        assert not study.caption(figure, start, replace(end, R=negative))


def test_figure_3_needs_a_change_uphill_of_the_pulse():
    scene = load("figure3")
    start = bcre_ca.Pile(*scene.initial(scene.centres()))
    (end,) = bcre_ca.frames(start, rule_of(scene), [scene.time.until])
    assert study.caption("figure3", start, end)
    uphill = scene.centres() < 50
    h = np.where(uphill, start.h, end.h)
    assert not study.caption("figure3", start, replace(end, h=h))


@pytest.mark.parametrize("slope", [3.7, 2.4])
def test_what_is_left_of_figure_1_is_the_wedge_at_repose_and_not_almost_nothing(slope):
    """Sc/S0 and the last cell: 14 % at S0 = 3.7, 22 % at 2.4."""
    scene = load("figure1").with_changes(**{"surface.0.slope": slope})
    start = bcre_ca.Pile(*scene.initial(scene.centres()))
    (end,) = bcre_ca.frames(start, rule_of(scene), [3000.0])
    expected = 0.5 / slope + (1 - 0.5 / slope) / 100
    assert end.h.sum() / start.h.sum() == pytest.approx(expected, abs=1e-4)
    assert study.caption("figure1", start, end)
    more = replace(end, h=end.h + 0.002 * start.h)
    assert not study.caption("figure1", start, more)


@pytest.mark.parametrize("courant", [0.1, 0.5, 0.9])
def test_reading_with_R_as_updated_loses_the_square_of_the_courant_number_in_a_step(courant):
    """Of sand that rolls without exchange; with the old R a step keeps it to rounding."""
    R = np.zeros(51)
    R[25] = 1.0
    r = replace(rule(v=courant, D=0.2), gamma=0.0)
    _, after, _ = march(0 * R, R, r, 1, in_place=False)
    assert after.sum() == pytest.approx(1 - courant**2, rel=1e-12)
    assert bcre_ca.step(0 * R, R, r)[1].sum() == pytest.approx(1, rel=1e-12)


def test_reading_with_R_as_updated_shows_the_captions_but_not_the_paper_s_sand():
    for order, figure in product(study.UPDATED, study.FIGURES):
        row = study.read(figure, "stable", "consistent", order)
        assert row["caption"]
        assert row["mass_error"] > 1e-3


def test_verdicts_turn_with_the_captions_and_the_sand(monkeypatch):
    monkeypatch.setattr(study, "each", lambda read, cases, _: [read(case) for case in cases])
    tables = study.run()
    table = tables["comparison"]
    assert len(table) == 60
    assert [claim.verdict for claim in study.judge(tables)] == [Verdict.AGREE] * 4
    for caption, expected in (
        (True, [Verdict.AGREE, Verdict.DISAGREE, Verdict.DISAGREE]),
        (False, [Verdict.DISAGREE, Verdict.AGREE, Verdict.AGREE]),
    ):
        changed: pd.DataFrame = table.assign(caption=caption)
        claims = study.judge({"comparison": changed})
        assert [claim.verdict for claim in claims[:3]] == expected
        assert ("reverse slope" in claims[1].evidence) is not caption
        assert ("do not tell the signs apart" in claims[1].evidence) is caption
    kept = study.judge({"comparison": table.assign(mass_error=1e-9)})
    assert kept[3].verdict is Verdict.DISAGREE
    alike = study.judge({"comparison": table.assign(drift=0.1)})
    assert "only the synchronous order" not in alike[0].evidence
