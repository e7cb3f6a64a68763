"""Slow driving: conservation, closed forms of the small ones, and what the claims hang on."""

import math

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bcre_ca import Rule
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.system.files import REPORTS
from bcre_studies.validation.avalanche_statistics import claims, study
from bcre_studies.validation.avalanche_statistics.drives import (
    GAMMA,
    TILT,
    D,
    Events,
    Feeding,
    Tilting,
    V,
    fed,
    tilted,
    tilted_bcre,
)
from bcre_studies.validation.avalanche_statistics.one_variable import Sticking, stuck
from bcre_studies.validation.avalanche_statistics.summary import (
    amplification,
    power_law,
    summed_up,
)

SHORT = Tilting(24.0, 24, 0.1, 60, seed=1, tilt=0.05)


def events_of(sizes):
    sizes = np.asarray(sizes, dtype=float)
    return Events(np.ones(sizes.size), sizes, np.ones(sizes.size), np.zeros(sizes.size))


def test_as_much_leaves_a_tilted_slope_as_was_added_and_is_missing_at_the_end():
    events = tilted(SHORT)
    added = SHORT.tilts * (SHORT.trigger + SHORT.tilt * SHORT.length**2 / 2)
    left_behind = added - events.size.sum()
    whole = SHORT.length**2 / 2 * (events.slope.max() + SHORT.tilt)
    assert 0 <= left_behind <= whole


def test_a_series_is_the_same_for_the_same_seed_and_another_for_another():
    first, again, other = (
        tilted(Tilting(24.0, 24, 0.1, 30, seed, tilt=0.05)) for seed in (1, 1, 2)
    )
    assert all((a == b).all() for a, b in zip(first, again, strict=True))
    assert (first.place != other.place).all()


def test_finer_cells_and_bcre_get_their_triggers_at_the_same_places():
    wide = {"length": 16.0, "trigger": 0.1, "tilts": 4, "seed": 3, "tilt": 0.02, "wide": True}
    coarse, fine = (tilted(Tilting(cells=cells, **wide)) for cells in (16, 32))
    bcre = tilted_bcre(Tilting(cells=16, **wide), effective=False)
    assert (coarse.place == fine.place).all()
    assert (coarse.place == bcre.place).all()
    assert np.allclose(coarse.size, bcre.size, rtol=0.01)
    assert np.allclose(fine.size, bcre.size, rtol=0.01)


def test_small_avalanches_on_a_straight_slope_are_amplified_as_predicted():
    events = tilted(Tilting(64.0, 64, 1e-6, 40, seed=5, tilt=TILT))
    predicted = amplification(events.slope) * (63 - np.floor(events.place))
    assert np.allclose(np.log(events.size / 1e-6), predicted, atol=0.05 * predicted.max())


def test_amplification_is_none_at_repose_and_ends_at_the_second_critical_slope():
    Sd = Rule(V, D, GAMMA, 0.0, d=1.0, dt=1.0).second_critical_slope()
    at = amplification(np.array([0.0, Sd * (1 - 1e-12), Sd * 1.001]))
    assert at[0] == pytest.approx(0.0, abs=1e-12)
    assert at[1] == pytest.approx(math.log(math.sqrt(1 + V / D)), abs=1e-5)
    assert math.isnan(at[2])


def test_what_is_fed_leaves_in_the_end():
    events = fed(Feeding(16, 0.1, 300, seed=1))
    assert events.size[100:].mean() == pytest.approx(1.0, abs=0.4)
    assert events.size.max() > 20 * np.median(events.size)


@settings(max_examples=20)
@given(st.floats(0.05, 0.5))
def test_a_pile_of_the_height_alone_starts_at_its_start_slope_and_not_before(start):
    events = stuck(Sticking(8, 0.0, start, 60, seed=1))
    first = int(np.flatnonzero(events.size)[0])
    assert first * TILT <= start * (1 + 1e-9)
    assert (first + 1) * TILT >= start * (1 - 1e-9)


def test_a_plain_pile_sheds_what_every_tilt_adds():
    events = stuck(Sticking(12, 0.1, 0.0, 10, seed=2))
    added = TILT * 0.5 * 12**2 - TILT * 0.5 * 12 + 0.1
    assert np.allclose(events.size, added, rtol=1e-6)


@pytest.mark.parametrize("exponent", [1.7, 2.5])
def test_a_power_law_is_recognised_with_its_exponent(exponent):
    uniform = (np.arange(4000) + 0.5) / 4000
    fit = power_law(uniform ** (-1 / (exponent - 1)))
    assert fit.exponent == pytest.approx(exponent, abs=0.1)
    assert fit.over_exponential > 0
    assert fit.p_exponential < 0.01


def test_big_ones_are_told_from_small_ones_by_the_gap_between_them():
    found = summed_up(events_of([1, 1, 1, 1000, 1, 1, 1, 1020, 1, 1, 1, 980]), area=10.0)
    assert (found["big"], found["gap"], found["gap_sd"]) == (3, 4.0, 0.0)
    assert found["size"] == 100.0
    assert found["share_of_sand"] == pytest.approx(3000 / 3009)
    assert found["empty_decades"] == pytest.approx(math.log10(980))


@pytest.fixture(scope="module")
def tables():
    folder = REPORTS / "avalanche_statistics"
    names = ("comparison", "slopes", "sizes", "small")
    return {name: pd.read_csv(folder / f"{name}.csv") for name in names}


PROTOTYPE = {
    "L = 32, trigger 0.1": ((1.760, 0.088), (123.8, 3.5), (0.516, 0.020)),
    "L = 64, trigger 0.1": ((1.109, 0.062), (89.9, 2.9), (0.404, 0.014)),
    "L = 128, trigger 0.1": ((0.656, 0.037), (58.8, 3.2), (0.273, 0.018)),
    "L = 64, trigger 1": ((1.095, 0.070), (61.5, 17.0), (0.235, 0.056)),
    "L = 128, trigger 1": ((0.698, 0.043), (45.3, 2.0), (0.193, 0.011)),
    "L = 128, trigger 10": ((0.470, 0.074), (24.7, 13.6), (0.090, 0.046)),
}
"""Start, gap and size of big avalanches, mean and standard deviation of one series each, from a
separate implementation of the same drive: 1200 tilts with triggers at other random places."""


@pytest.mark.parametrize("case", PROTOTYPE)
def test_the_oscillation_is_that_of_a_separate_implementation(tables, case):
    table = tables["comparison"]
    (row,) = table[(table["drive"] == study.TILTED) & (table["case"] == case)].to_dict("records")
    for name, (mean, sd) in zip(("start", "gap", "size"), PROTOTYPE[case], strict=True):
        assert abs(row[name] - mean) <= sd
        assert row[f"{name}_band"] <= 2 * sd


def test_the_start_slope_falls_with_length_trigger_and_rate(tables):
    drives = (Tilting(24.0, 24, 0.1, tilts, 1, tilt) for tilt, tilts in ((0.02, 300), (0.2, 60)))
    starts = [summed_up(tilted(drive), 1.0)["start"] for drive in drives]
    assert starts[0] < starts[1]
    table = tables["comparison"].set_index(["drive", "case"])["start"]
    assert table[study.OF_LENGTH].is_monotonic_decreasing
    of_trigger = [table[study.TILTED, f"L = 128, trigger {t}"] for t in ("0.1", "10")]
    assert table[study.OF_LENGTH, "L = 128, trigger 0.001"] > of_trigger[0] > of_trigger[1]


# What the claims hang on


def verdicts(tables):
    return {claim.name: claim.verdict for claim in study.judge(tables)}


def changed(tables, drive, **columns):
    table = tables["comparison"].copy()
    rows = table["drive"] == drive
    for column, value in columns.items():
        table.loc[rows, column] = value
    return verdicts(tables | {"comparison": table})


def test_sizes_have_no_scale_where_big_ones_are_unlike_or_carry_little(tables):
    assert verdicts(tables)["sizes under tilting"] is Verdict.DISAGREE
    found = changed(tables, study.OF_LENGTH, share_of_sand=0.4)
    assert found["sizes under tilting"] is not Verdict.DISAGREE


def test_one_power_law_must_hold_at_every_length_and_beat_a_lognormal(tables):
    law = {"exponent": 1.8, "over_lognormal": 2.0, "p_lognormal": 0.01}
    assert changed(tables, study.FEEDING, **law)["sizes under feeding"] is Verdict.AGREE
    found = changed(tables, study.FEEDING, **law | {"p_lognormal": 0.5})
    assert found["sizes under feeding"] is Verdict.DISAGREE
    assert verdicts(tables)["sizes under feeding"] is Verdict.DISAGREE


def test_the_oscillation_is_bcres_only_where_start_gap_and_size_are(tables):
    same = {"start": 1.7, "gap": 30.0, "size": 0.7}
    name = "oscillation between two slopes"
    assert changed(tables, study.BESIDE, **same)[name] is Verdict.AGREE
    table = tables["comparison"].copy()
    own = table["case"] == "automaton, d = 1"
    table.loc[own, "gap"] *= 1.5
    assert verdicts(tables | {"comparison": table})[name] is Verdict.DISAGREE


def test_the_control_takes_the_claim_of_the_second_layer_down_only_by_oscillating(tables):
    name = "oscillation needs the second layer"
    assert verdicts(tables)[name] is Verdict.DISAGREE
    assert changed(tables, study.CONTROL, gap=1.0)[name] is Verdict.AGREE


def test_small_avalanches_that_are_not_predicted_are_noticed(tables):
    name = "small avalanches"
    assert verdicts(tables)[name] is Verdict.AGREE
    shuffled = tables["small"].assign(predicted=tables["small"]["predicted"].to_numpy()[::-1])
    assert verdicts(tables | {"small": shuffled})[name] is Verdict.DISAGREE


def test_thresholds_are_those_that_the_texts_name(tables):
    texts = " ".join(claim.tolerance for claim in study.judge(tables))
    for number in (claims.NEARLY_ALL, claims.ALIKE, claims.TOLERANCE, claims.SAND_ABOVE):
        assert f"{number:.0%}" in texts
