"""What a study concludes: a claim, its verdict, the numbers, and the tolerance with its reason."""

from __future__ import annotations

from dataclasses import dataclass

from bcre_studies.comparison.verdict import Verdict


@dataclass(frozen=True)
class Claim:
    """One sentence that can turn out wrong.

    Parameters
    ----------
    name: short and unique within the study; what ``bcre check`` compares by.
    statement: the sentence that was put to the test.
    verdict: how it ended.
    evidence: what agrees, what does not and why, with the numbers.
    tolerance: the threshold that stood before the study ran, with its reason.
    """

    name: str
    statement: str
    verdict: Verdict
    evidence: str
    tolerance: str
