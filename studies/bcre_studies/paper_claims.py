"""What the paper claims, and which of our own claims decide each.

The sentences are ours, the claims are the paper's. A claim of the paper is *reproduced* if all our
claims under ``as_stated`` agree. It is *reproduced under conditions* if all those under
``under_condition`` agree, if need be once the automaton's own diffusion is counted. Otherwise it is
*not reproduced*. A claim that names no number, size or condition by which it could fail is *not
testable as stated*.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.verdict import Verdict

Key = tuple[str, str]

REPRODUCED = "reproduced"
CONDITIONAL = "reproduced under conditions"
REFUTED = "not reproduced"
UNTESTABLE = "not testable as stated"


@dataclass(frozen=True)
class PaperClaim:
    """A claim of the paper.

    Parameters
    ----------
    text: what the paper claims, and where.
    as_stated: (study, claim) that must hold for it to be reproduced.
    under_condition: (study, claim) that must hold for it to be reproduced under the condition.
    remark: the condition, or why it cannot be tested.
    """

    text: str
    as_stated: tuple[Key, ...]
    under_condition: tuple[Key, ...]
    remark: str

    def verdict(self, claims: Mapping[Key, Claim]) -> str:
        """The word that the rule gives."""
        if not self.as_stated and not self.under_condition:
            return UNTESTABLE
        if self.as_stated and all(_agrees(claims[key]) for key in self.as_stated):
            return REPRODUCED
        return CONDITIONAL if all(_holds(claims[key]) for key in self.under_condition) else REFUTED

    def evidence(self) -> tuple[Key, ...]:
        """All our claims that bear on it, each once."""
        return tuple(dict.fromkeys(self.as_stated + self.under_condition))


def _agrees(claim: Claim) -> bool:
    return claim.verdict is Verdict.AGREE


def _holds(claim: Claim) -> bool:
    return claim.verdict in (Verdict.AGREE, Verdict.EXPLAINED)


PAPER_CLAIMS = (
    PaperClaim(
        text="A slope close to repose that is perturbed locally avalanches and returns to an angle "
        "below the critical one (first property, figure 2)",
        as_stated=(("repose_return", "first property as printed"),),
        under_condition=(("repose_return", "all or nothing"), ("repose_return", "final slope")),
        remark="only where the avalanche runs to the top, and then to S = Sc, not below; a single "
        "small avalanche leaves the slope as it was",
    ),
    PaperClaim(
        text="Roughness of the surface dissipates through the diffusion terms of the model (second "
        "property)",
        as_stated=(
            ("roughness_decay", "roughness of the surface, long waves"),
            ("roughness_decay", "roughness of the rolling layer, long waves"),
        ),
        under_condition=(
            ("roughness_decay", "roughness of the surface, long waves"),
            ("roughness_decay", "roughness of the rolling layer, long waves"),
            ("random_roughness", "random roughness"),
        ),
        remark="R is smoothed by D; the surface is smoothed by no term of the model (BCRE with "
        "kappa = 0 only carries it uphill) but by the size of the automaton's cells, gamma d/2",
    ),
    PaperClaim(
        text="Avalanches propagate not only downhill but also uphill (third property, figure 3)",
        as_stated=(
            ("uphill_propagation", "surface wave"),
            ("uphill_propagation", "rolling front"),
            ("uphill_propagation", "reach in figure 3"),
        ),
        under_condition=(
            ("uphill_propagation", "surface wave"),
            ("uphill_propagation", "rolling front"),
            ("uphill_propagation", "scarp"),
        ),
        remark="the surface wave climbs at gamma R on any slope, the rolling layer above Sd only; "
        "in figure 3, far below Sd, what lies above the start is where the pulse already lay",
    ),
    PaperClaim(
        text="The second variable brings a second critical angle, as in the continuous model, "
        "above which any avalanche is catastrophic (figure 1)",
        as_stated=(("second_critical_angle", "second critical slope"),),
        under_condition=(
            ("second_critical_angle", "closed form of Sd, automaton"),
            ("second_critical_angle", "closed form of Sd, BCRE"),
            ("second_critical_angle", "runs to the top"),
            ("one_variable", "second critical angle"),
        ),
        remark="it exists and needs the second layer, but lies at another slope than in BCRE, "
        "which it meets only as d goes to 0; and finite pulses are catastrophic below it",
    ),
    PaperClaim(
        text="The dynamics of single-variable models can still be observed; the model extends them",
        as_stated=(("repose_return", "first property as printed"),),
        under_condition=(
            ("one_variable", "return to repose"),
            ("one_variable", "decay of roughness"),
            ("repose_return", "all or nothing"),
        ),
        remark="the same end states are reached, but only after a disturbance that runs to the "
        "top: a one-variable pile cannot stand above repose, this one can",
    ),
    PaperClaim(
        text="The two-variable automaton gives the same predictions as the continuous model",
        as_stated=(
            ("paper_figures", "figure1 profile"),
            ("second_critical_angle", "second critical slope"),
        ),
        under_condition=(
            ("paper_figures", "figure2 profile"),
            ("paper_figures", "figure3 profile"),
            ("second_critical_angle", "second critical slope"),
        ),
        remark="figures 2 and 3 agree once D_eff is counted, but Sd does not: at their cell Peclet "
        "number of 25 it is another one even then, and waves of less than twelve cells differ too",
    ),
    PaperClaim(
        text="The scheme is simpler and more efficient than the numerical solution of the PDEs",
        as_stated=(("speed_error", "efficiency"),),
        under_condition=(
            ("speed_error", "efficiency at 10 %"),
            ("speed_error", "what better rules buy"),
        ),
        remark="a step costs least of all, but being of first order the rule needs so many cells "
        "that it is the faster only where a coarse answer will do; of second order it stays so "
        "for longer",
    ),
    PaperClaim(
        text="The model is fit for interactive simulation",
        as_stated=(("scaling", "interactive"),),
        under_condition=(("scaling", "interactive"),),
        remark="sixty frames a second of its own figures, with more than a hundred times the "
        "cells; no size and no frame rate is named in the paper",
    ),
)
