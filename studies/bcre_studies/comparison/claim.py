"""What a study concludes: a claim, its verdict, the numbers, and the tolerance with its reason."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

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
    tolerance: the threshold that was set before the study ran, with its reason.
    quality: whether the claim is a check of the code, or one that no measurement can refute. Such
        a claim is reported among the quality checks, not among the verdicts on the model.
    """

    name: str
    statement: str
    verdict: Verdict
    evidence: str
    tolerance: str
    quality: bool = False


quality_check = partial(Claim, quality=True)
"""A claim about the code, or one that no measurement can refute."""
