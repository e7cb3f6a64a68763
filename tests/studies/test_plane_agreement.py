"""A pulse on a plane, on parameters of no figure: which form of BCRE the automaton solves."""

from dataclasses import replace

import pandas as pd
import pytest

from bcre_studies.comparison.difference import relative_difference
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.system.files import REPORTS
from bcre_studies.validation import plane_agreement as study

PULSE = study.Pulse(1.2, 0.02, 0.4, 30.0, 4.5, 12.0, 0.3, D=0.15)


def differences(pulse, d):
    own = study.automaton(pulse, d)
    return {
        form: relative_difference(own, study.bcre(pulse, study.form_of(pulse, form, d), d)[0])
        for form in study.FORMS
    }


def test_the_cells_add_diffusion_along_the_flow_alone():
    found = differences(PULSE, 1.0)
    assert found[study.EFFECTIVE] < 0.02
    assert found[study.NOMINAL] > 10 * found[study.ALONG]
    assert found[study.ISOTROPIC] > 10 * found[study.ALONG]


def test_what_is_added_vanishes_with_the_cells_and_is_least_where_v_dt_is_d():
    added = [study.form_of(PULSE, study.ALONG, d).D_x - PULSE.D for d in (1.0, 0.5)]
    assert added == pytest.approx([0.6 * (1 - 0.36), 0.3 * (1 - 0.36)])
    at_the_bound = replace(PULSE, part=1 / PULSE.v)
    assert study.form_of(at_the_bound, study.ALONG, 1.0).D_x == pytest.approx(PULSE.D)
    assert study.form_of(PULSE, study.EFFECTIVE, 0.5).kappa_x == pytest.approx(0.005)


@pytest.fixture(scope="module")
def recorded():
    return pd.read_csv(REPORTS / "plane_agreement" / "comparison.csv")


def verdicts(table):
    return {claim.name: claim.verdict for claim in study.judge({"comparison": table})}


EXPECTED = {
    ("figure 1", 1.0): (0.14, 0.021),
    ("figure 1", 0.5): (0.078, 0.008),
    ("figure 1", 0.25): (0.040, 0.004),
    ("figure 2", 1.0): (0.53, 0.014),
    ("figure 2", 0.5): (0.34, 0.010),
    ("figure 2", 0.25): (0.20, 0.007),
    ("figure 3", 1.0): (0.39, 0.013),
    ("figure 3", 0.5): (0.23, 0.008),
    ("figure 3", 0.25): (0.13, 0.005),
}
HALF_A_DIGIT = 0.0005
"""The smaller of the numbers expected are known to one digit."""


def test_the_report_has_the_differences_that_were_expected_to_a_tenth(recorded):
    table = recorded.set_index(["case", "d"])
    for key, (nominal, effective) in EXPECTED.items():
        assert table.loc[key, study.NOMINAL] == pytest.approx(nominal, rel=0.1), key
        allowed = 0.1 * effective + HALF_A_DIGIT
        assert table.loc[key, study.EFFECTIVE] == pytest.approx(effective, abs=allowed), key


def test_verdicts_turn_when_their_numbers_do(recorded):
    assert verdicts(recorded)["figure 2 on a plane"] is Verdict.EXPLAINED
    assert verdicts(recorded)["an isotropic D_eff"] is Verdict.DISAGREE
    worse = recorded.assign(verdict="disagree", isotropic=0.01)
    assert verdicts(worse)["figure 2 on a plane"] is Verdict.DISAGREE
    assert verdicts(worse)["an isotropic D_eff"] is Verdict.AGREE
