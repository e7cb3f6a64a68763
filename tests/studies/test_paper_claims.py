"""The ledger: the rule by which a claim of the paper is decided, and that the claims exist."""

import pytest

from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.paper_claim import (
    CONDITIONAL,
    REFUTED,
    REPRODUCED,
    UNDECIDED,
    UNTESTABLE,
    PaperClaim,
)
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.paper_claims import PAPER_CLAIMS
from bcre_studies.publishing.write import recorded_verdicts

STATED, CONDITION, AGAINST = ("s", "as stated"), ("s", "condition"), ("s", "against")
A, E, U, D = Verdict.AGREE, Verdict.EXPLAINED, Verdict.UNRESOLVED, Verdict.DISAGREE


def claims(**verdicts):
    names = {"stated": STATED, "condition": CONDITION, "against": AGAINST}
    return {
        names[name]: Claim(names[name][1], "It holds.", verdict, "1 < 2", "a tenth")
        for name, verdict in verdicts.items()
    }


@pytest.mark.parametrize(
    ("stated", "condition", "word"),
    [
        (A, D, REPRODUCED),
        (E, A, CONDITIONAL),
        (D, E, CONDITIONAL),
        (U, A, CONDITIONAL),
        (D, D, REFUTED),
        (E, U, REFUTED),
    ],
)
def test_a_claim_is_reproduced_as_stated_or_under_its_condition_or_not(stated, condition, word):
    claim = PaperClaim("It flows.", (STATED,), (CONDITION,))
    assert claim.verdict(claims(stated=stated, condition=condition)) == word


def test_a_claim_without_a_condition_is_not_reproduced_where_it_does_not_hold_as_stated():
    assert PaperClaim("It flows.", (STATED,)).verdict(claims(stated=E)) == REFUTED


@pytest.mark.parametrize(("against", "word"), [(A, REFUTED), (D, REPRODUCED)])
def test_a_claim_is_refuted_by_a_claim_against_it_that_agrees(against, word):
    claim = PaperClaim("It flows.", refuted_by=(AGAINST,))
    assert claim.verdict(claims(against=against)) == word


def test_what_is_measured_beside_a_claim_does_not_decide_it():
    for verdict in Verdict:
        claim = PaperClaim("It flows.", measured=(STATED,))
        assert claim.verdict(claims(stated=verdict)) == UNTESTABLE
        assert claim.evidence() == (STATED,)


def test_a_remark_is_that_of_the_verdict():
    claim = PaperClaim("It flows.", (STATED,), remarks={REFUTED: "it does not"})
    assert claim.remark(REFUTED) == "it does not"
    assert claim.remark(REPRODUCED) == "see the evidence"


def recorded():
    table = recorded_verdicts()
    return {
        (row.study, row.claim): Claim(row.claim, "", Verdict(row.verdict), "", "")
        for row in table.itertuples()
    }


def test_every_claim_that_the_ledger_names_is_recorded_and_every_remark_is_that_of_its_verdict():
    ours = recorded()
    for claim in PAPER_CLAIMS:
        assert claim.verdict(ours) in claim.remarks, claim.text


@pytest.mark.parametrize(
    ("start", "word"),
    [
        ("The model is fit for interactive simulation", UNTESTABLE),
        ("Statistical properties", CONDITIONAL),
        ("The model agrees with what experiments", UNDECIDED),
        ("The computation is not performed on a discretization", REFUTED),
        ("It avoids the technical considerations", REFUTED),
        ("Roughness of the surface", REFUTED),
        ("Roughness of the rolling layer", REPRODUCED),
        ("In a catastrophic avalanche the static layer", REFUTED),
        ("In a catastrophic avalanche the rolling layer", REPRODUCED),
        ("An avalanche occurs on a slope below repose", REFUTED),
        ("A perturbation spreads", REFUTED),
        ("The automaton gives the same predictions as the continuous model: figure 1", CONDITIONAL),
        ("The automaton gives the same predictions as the continuous model: other", REFUTED),
    ],
)
def test_claims_of_the_paper_end_as_measured(start, word):
    (claim,) = [claim for claim in PAPER_CLAIMS if claim.text.startswith(start)]
    assert claim.verdict(recorded()) == word


def test_no_condition_of_the_ledger_is_a_claim_that_its_own_statement_repeats_alone():
    """Otherwise "under conditions" would be no more than "explained by cell size"."""
    for claim in PAPER_CLAIMS:
        if claim.under_condition:
            assert set(claim.under_condition) != set(claim.as_stated), claim.text
