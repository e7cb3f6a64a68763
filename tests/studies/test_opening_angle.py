"""The opening angle in both models on parameters in no scene and no study; layers; pulses."""

import math

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bcre_ca.plane.theory import edge
from bcre_ca.theory import second_critical_excess
from bcre_pde.plane import Material, theory
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.system.files import REPORTS
from bcre_studies.validation.opening_angle import layer, pulses, study, trace

MATERIAL = Material(0.1, 0.1, 0.1, 0.01, 0.5)


@pytest.mark.parametrize(
    ("material", "d", "excess"),
    [
        (Material(0.37, 0.23, 0.11, 0.04, 0.3), 0.9, 1.1),
        (Material(0.2, 0.05, 0.2, 0.06, 0.0), 0.6, 0.4),
    ],
)
def test_the_automaton_opens_within_a_fiftieth_of_a_degree_of_its_closed_form(material, d, excess):
    m = material
    found = trace.measured_in_automaton(m, excess, d)
    expected = edge(m.v, m.D_x, m.D_y, m.gamma * excess, d).theta
    assert found.theta == pytest.approx(expected, abs=0.02)
    assert expected - theory.opening_angle(m, m.Sc + excess) > 1
    again = trace.measured_in_automaton(m, excess, d, part=0.6)
    assert again.theta == pytest.approx(found.theta, abs=0.005)


@settings(max_examples=4)
@given(
    v=st.floats(0.1, 0.4),
    peclet=st.floats(0.5, 3.0),
    ratio=st.floats(0.4, 2.5),
    gamma=st.floats(0.02, 0.1),
    part=st.floats(0.3, 0.7),
)
def test_the_automaton_opens_at_its_closed_form_whatever_the_material(
    v, peclet, ratio, gamma, part
):
    """``peclet`` is that of a cell, ``part`` that of Sd - Sc at which the slope lies."""
    D = v / peclet
    excess = part * second_critical_excess(v, D, gamma, 1.0)
    found = trace.measured_in_automaton(Material(v, D, ratio * D, gamma, 0.2), excess, 1.0)
    expected = edge(v, D, ratio * D, gamma * excess, 1.0).theta
    assert found.theta == pytest.approx(expected, abs=0.02)


def test_bcre_opens_within_a_fifth_of_a_degree_of_its_closed_form():
    material = Material(0.37, 0.23, 0.11, 0.04, 0.3)
    found = trace.measured_in_bcre(material, 1.1)
    assert found.theta == pytest.approx(theory.opening_angle(material, 1.4), abs=0.02)


def test_the_edge_of_a_layer_is_that_of_a_front_that_is_pulled():
    """From 200 rows; a contour of a trace would have the factor 1/2 and a narrower angle."""
    found = layer.triangle(MATERIAL, 0.7, 3.0, 200)
    expected = edge(0.1, 0.1, 0.1, 0.007, 1.0).theta
    opened = layer.opening(MATERIAL, 0.7, found)
    assert opened.theta.value == pytest.approx(expected, abs=0.5)
    assert opened.slowness > 1
    assert layer.angle_at(found, 100.0) < layer.angle_at(found, 170.0) < expected - 0.5
    assert found.eroded.max() == pytest.approx(layer.THICKNESS, abs=1e-6)


def test_a_ridge_brings_the_top_down_where_a_round_pulse_of_its_height_does_not():
    on_line, _ = pulses.end_of(MATERIAL, 1.4, 1.0, pulses.LINE)
    on_plane, left = pulses.end_of(MATERIAL, 1.4, 1.0, pulses.PLANE)
    assert (on_line, on_plane) == (True, False)
    assert left == pytest.approx(1.4, abs=0.01)


def test_in_bcre_too_a_ridge_brings_down_what_a_round_pulse_does_not():
    """On the coarser grid; in the automaton both come down from this slope."""
    came_down = [
        pulses.end_in_bcre(MATERIAL, 1.6, 1.0, is_line, 50)[0] for is_line in (True, False)
    ]
    assert came_down == [True, False]
    assert pulses.end_of(MATERIAL, 1.6, 1.0, pulses.PLANE)[0]


def test_a_threshold_holds_on_every_grid():
    found = pulses.threshold([lambda excess: excess > 1.0, lambda excess: excess > 1.03])
    assert found.value - found.error <= 1.0
    assert 1.03 < found.value + found.error < 1.04
    alone = pulses.threshold([lambda excess: excess > 1.0])
    assert alone.error < 0.005
    assert abs(alone.value - 1.0) <= alone.error


def test_the_continuation_to_90_degrees_is_exact_for_bcre():
    slopes = np.array([0.3, 0.5, 0.7])
    assert study.zero_of(slopes, 2.5 / slopes - 1) == pytest.approx(2.5, rel=1e-9)
    assert math.isnan(study.zero_of(slopes, 2.5 / slopes + 1))


@pytest.fixture(scope="module")
def recorded():
    folder = REPORTS / "opening_angle"
    return pd.read_csv(folder / "comparison.csv")


def verdicts(table):
    return {claim.name: claim.verdict for claim in study.judge({"comparison": table})}


EXPECTED = {
    (0.1, 1.0): {0.3: 20.9404, 0.5: 28.1079, 1.0: 44.6475, 1.5: 65.6192},
    (0.3, 1.0): {0.3: 15.8416, 1.0: 34.5880, 1.5: 50.2419},
    (0.1, 0.25): {0.5: 26.9300, 1.0: 40.4427, 1.5: 53.5857},
}
"""theta of the automaton by v and d and by S - Sc, with D = D_across = 0.1."""


def test_every_angle_that_was_expected_was_measured_to_a_fiftieth_of_a_degree(recorded):
    rows = recorded[(recorded["quantity"] == study.THETA) & (recorded["D across"] == 0.1)]
    rows = rows.set_index(["v", "d", "S - Sc"])
    for (v, d), angles in EXPECTED.items():
        for excess, theta in angles.items():
            row = rows.loc[(v, d, excess)]
            assert row["automaton"] == pytest.approx(theta, abs=0.02)
            assert row["pde"] == pytest.approx(row["pde_theory"], abs=0.2)


def changed(table, quantity, column, value):
    return table.assign(**{column: table[column].where(table["quantity"] != quantity, value)})


def test_the_report_says_what_was_measured(recorded):
    found = verdicts(recorded)
    assert found["closed form of the opening angle, automaton"] is Verdict.AGREE
    assert found["opening angle, figure 1"] is Verdict.EXPLAINED
    assert found["opening angle, other materials"] is Verdict.DISAGREE
    assert found["diffusion of the cells in all directions"] is Verdict.DISAGREE
    assert found["90 degrees at Sd"] is Verdict.AGREE
    assert found["finite pulses on a plane"] is Verdict.DISAGREE


@pytest.mark.parametrize(
    ("claim", "quantity", "column", "value"),
    [
        ("closed form of the opening angle, automaton", study.THETA, "automaton", 30.0),
        ("closed form of the opening angle, BCRE", study.THETA, "pde", 30.0),
        ("opening angle, figure 1", study.THETA, "verdict", "disagree"),
        ("90 degrees at Sd", study.CRITICAL, "automaton", 1.9),
        ("edge of a layer", study.EDGE, "automaton", 27.4),
        ("how slowly an edge opens", study.EDGE, "factor", 0.6),
        ("finite pulses on a plane in both models", study.THRESHOLD, "verdict", "disagree"),
    ],
)
def test_a_verdict_turns_when_its_number_does(recorded, claim, quantity, column, value):
    assert verdicts(recorded)[claim] is not Verdict.DISAGREE
    assert verdicts(changed(recorded, quantity, column, value))[claim] is Verdict.DISAGREE


def test_equal_thresholds_and_an_isotropic_diffusion_would_agree(recorded):
    same = changed(recorded, study.THRESHOLD, "automaton", recorded["line"])
    assert verdicts(same)["finite pulses on a plane"] is Verdict.DISAGREE  # BCRE's are not
    same = changed(same, study.THRESHOLD, "pde", recorded["line_pde"])
    assert verdicts(same)["finite pulses on a plane"] is Verdict.AGREE
    even = changed(recorded, study.THETA, "isotropic", recorded["automaton"])
    assert verdicts(even)["diffusion of the cells in all directions"] is Verdict.AGREE
