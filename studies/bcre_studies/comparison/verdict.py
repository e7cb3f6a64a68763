"""The four words with which a comparison can end, and which of them applies."""

from __future__ import annotations

from collections.abc import Iterable
from enum import StrEnum


class Verdict(StrEnum):
    """From best to worst.

    ``EXPLAINED`` is a difference that D_eff and kappa_eff of the automaton's cells account for.
    """

    AGREE = "agree"
    EXPLAINED = "explained by cell size"
    UNRESOLVED = "unresolved"
    DISAGREE = "disagree"


def worst(verdicts: Iterable[str]) -> Verdict:
    """The worst of several verdicts: a claim about many cases is as good as its worst case."""
    ranking = list(Verdict)
    return max((Verdict(verdict) for verdict in verdicts), key=ranking.index)


def within(measured: float, expected: float, relative: float) -> Verdict:
    """Agree where a measured number is within ``relative`` of a closed form."""
    near = abs(measured - expected) <= relative * abs(expected)
    return Verdict.AGREE if near else Verdict.DISAGREE


def verdict_of(
    difference: float,
    resolved: bool,
    difference_effective: float,
    resolved_effective: bool,
    tolerance: float,
) -> Verdict:
    """The verdict of automaton against PDE.

    Parameters
    ----------
    difference, difference_effective: relative difference from BCRE as it stands, and from BCRE
        with the automaton's D_eff and kappa_eff.
    resolved, resolved_effective: whether the PDE's own error is small against that difference.
    tolerance: largest relative difference that counts as agreement.

    >>> print(verdict_of(0.53, True, 0.007, True, tolerance=0.05))
    explained by cell size
    """
    if resolved and difference <= tolerance:
        return Verdict.AGREE
    if not resolved:
        return Verdict.UNRESOLVED
    if resolved_effective and difference_effective <= tolerance:
        return Verdict.EXPLAINED
    return Verdict.DISAGREE if resolved_effective else Verdict.UNRESOLVED
