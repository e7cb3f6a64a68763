import math

import pytest

from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.verdict import Verdict, verdict_of, within, worst


def test_verdicts_are_the_four_words_of_the_reports():
    assert [str(verdict) for verdict in Verdict] == [
        "agree",
        "explained by cell size",
        "unresolved",
        "disagree",
    ]


@pytest.mark.parametrize(
    ("difference", "resolved", "effective", "resolved_effective", "verdict"),
    [
        (0.01, True, 0.50, True, Verdict.AGREE),
        (0.05, True, 0.50, False, Verdict.AGREE),
        (0.20, True, 0.01, True, Verdict.EXPLAINED),
        (0.20, True, 0.05, True, Verdict.EXPLAINED),
        (0.20, True, 0.06, True, Verdict.DISAGREE),
        (0.20, True, 0.01, False, Verdict.UNRESOLVED),
        (0.20, True, 0.50, False, Verdict.UNRESOLVED),
        (0.01, False, 0.01, True, Verdict.UNRESOLVED),
        (0.20, False, 0.50, True, Verdict.UNRESOLVED),
        (math.inf, True, math.inf, True, Verdict.DISAGREE),
    ],
)
def test_no_verdict_rests_on_a_solution_that_is_not_resolved(
    difference, resolved, effective, resolved_effective, verdict
):
    assert verdict_of(difference, resolved, effective, resolved_effective, 0.05) is verdict


@pytest.mark.parametrize("difference", [0.0, 0.01, 0.2, math.nan])
def test_difference_that_is_no_number_never_agrees(difference):
    verdict = verdict_of(difference, True, math.nan, True, 0.05)
    assert (verdict is Verdict.AGREE) == (difference <= 0.05)
    assert verdict is not Verdict.EXPLAINED


def test_claim_about_many_cases_is_as_good_as_its_worst_case():
    assert worst(["agree"]) is Verdict.AGREE
    assert worst(["agree", "unresolved", "agree"]) is Verdict.UNRESOLVED
    assert worst([Verdict.UNRESOLVED, Verdict.DISAGREE]) is Verdict.DISAGREE
    assert worst([Verdict.AGREE, Verdict.EXPLAINED]) is Verdict.EXPLAINED


def test_verdict_that_is_none_of_the_four_words_is_refused():
    with pytest.raises(ValueError, match="nearly"):
        worst(["agree", "nearly"])


@pytest.mark.parametrize(
    ("measured", "verdict"),
    [
        (1.001, Verdict.AGREE),
        (0.999, Verdict.AGREE),
        (1.0011, Verdict.DISAGREE),
        (0.9989, Verdict.DISAGREE),
        (math.nan, Verdict.DISAGREE),
    ],
)
def test_measured_number_agrees_within_its_relative_tolerance(measured, verdict):
    assert within(measured, 1.0, 0.0010001) is verdict
    assert within(-measured, -1.0, 0.0010001) is verdict


def test_claim_is_a_value():
    one, other = (Claim("a", "s", Verdict.AGREE, "e", "t") for _ in range(2))
    assert one == other
