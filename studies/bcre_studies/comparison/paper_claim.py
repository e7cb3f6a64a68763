"""How our own claims decide a claim of the paper.

A claim of the paper is *not reproduced* if one
of our claims under ``refuted_by`` agrees. It is *reproduced* if all those under ``as_stated``
agree. It is *reproduced under conditions* if all those under ``under_condition`` agree or are
explained by cell size. Otherwise it is *not reproduced*. Where none of the three is named, nothing
decides: the claim is *not testable as stated*, since it names no number, size or condition by which
it could fail, or *not decided here*.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.verdict import Verdict

Key = tuple[str, str]

REPRODUCED = "reproduced"
CONDITIONAL = "reproduced under conditions"
REFUTED = "not reproduced"
UNTESTABLE = "not testable as stated"
UNDECIDED = "not decided here"


@dataclass(frozen=True)
class PaperClaim:
    """A claim of the paper.

    Parameters
    ----------
    text: what the paper claims, and where.
    as_stated: (study, claim) that must agree for it to be reproduced.
    under_condition: (study, claim) that must hold for it to be reproduced under the condition.
    refuted_by: (study, claim) that refute it where they agree.
    measured: (study, claim) that bear on it but do not decide.
    remarks: what is to be said where the verdict is this one.
    undecided: the verdict where nothing decides.
    """

    text: str
    as_stated: tuple[Key, ...] = ()
    under_condition: tuple[Key, ...] = ()
    refuted_by: tuple[Key, ...] = ()
    measured: tuple[Key, ...] = ()
    remarks: Mapping[str, str] = field(default_factory=dict)
    undecided: str = UNTESTABLE

    def verdict(self, claims: Mapping[Key, Claim]) -> str:
        """The word that the rule gives."""
        if not (self.as_stated or self.under_condition or self.refuted_by):
            return self.undecided
        if any(_agrees(claims[key]) for key in self.refuted_by):
            return REFUTED
        decides = self.as_stated or self.refuted_by
        if decides and all(_agrees(claims[key]) for key in self.as_stated):
            return REPRODUCED
        holds = self.under_condition and all(_holds(claims[key]) for key in self.under_condition)
        return CONDITIONAL if holds else REFUTED

    def remark(self, verdict: str) -> str:
        """What is to be said where that is the verdict."""
        return self.remarks.get(verdict, "see the evidence")

    def evidence(self) -> tuple[Key, ...]:
        """All our claims that bear on it, each once, those that decide first."""
        keys = self.refuted_by + self.as_stated + self.under_condition + self.measured
        return tuple(dict.fromkeys(keys))


def _agrees(claim: Claim) -> bool:
    return claim.verdict is Verdict.AGREE


def _holds(claim: Claim) -> bool:
    return claim.verdict in (Verdict.AGREE, Verdict.EXPLAINED)
