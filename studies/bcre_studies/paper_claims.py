"""What the paper claims, and which of our own claims decide each.

The sentences are ours, the claims are the paper's. A claim of the paper is *not reproduced* if one
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


PAPER_CLAIMS = (
    PaperClaim(
        "A slope close to repose that is perturbed locally avalanches and returns to an angle "
        "below the critical one (first property, figure 2)",
        as_stated=(("repose_return", "first property as printed"),),
        under_condition=(("repose_return", "all or nothing"), ("repose_return", "final slope")),
        remarks={
            CONDITIONAL: "only where the avalanche runs to the top, and then to S = Sc, not below; "
            "a single small avalanche leaves the slope as it was, or steeper"
        },
    ),
    PaperClaim(
        "An avalanche occurs on a slope below repose that is perturbed (first property, figure 2)",
        as_stated=(("avalanche_extent", "avalanche below repose"),),
        remarks={REFUTED: "below repose a pulse only loses sand to the surface"},
    ),
    PaperClaim(
        "Roughness of the surface dissipates through the diffusion terms (second property)",
        as_stated=(("roughness_decay", "diffusion smooths the surface"),),
        measured=(
            ("roughness_decay", "roughness of the surface, long waves"),
            ("roughness_decay", "rough slope under steady flow"),
            ("random_roughness", "random roughness"),
        ),
        remarks={
            REFUTED: "no term of the model smooths the surface; the automaton smooths it by the "
            "size of its cells, kappa_eff = gamma d/2"
        },
    ),
    PaperClaim(
        "Roughness of the rolling layer dissipates through the diffusion terms (second property)",
        as_stated=(("roughness_decay", "diffusion smooths the rolling layer"),),
        measured=(("roughness_decay", "roughness of the rolling layer, long waves"),),
        remarks={REPRODUCED: "D smooths R; the automaton's cells add v d/2 to it"},
    ),
    PaperClaim(
        "A perturbation spreads down the slope instead of just travelling (second property)",
        as_stated=(("avalanche_extent", "spreads, not travels"),),
        measured=(("paper_figures", "figure2 profile"),),
        remarks={REFUTED: "it does both, and travels much farther than it spreads"},
    ),
    PaperClaim(
        "Avalanches propagate not only downhill but also uphill (third property, figure 3)",
        as_stated=(
            ("uphill_propagation", "surface wave"),
            ("uphill_propagation", "rolling front"),
            ("uphill_propagation", "reach in figure 3"),
        ),
        under_condition=(
            ("uphill_propagation", "surface wave"),
            ("uphill_propagation", "rolling front"),
        ),
        measured=(("uphill_propagation", "scarp"), ("opening_angle", "90 degrees at Sd")),
        remarks={CONDITIONAL: "a wave always, a front above Sd"},
    ),
    PaperClaim(
        "The second variable brings a second critical angle, as in the continuous model, above "
        "which any perturbation is catastrophic (figure 1)",
        as_stated=(("second_critical_angle", "second critical slope, figure 1"),),
        under_condition=(
            ("second_critical_angle", "closed form of Sd, automaton"),
            ("second_critical_angle", "closed form of Sd, BCRE"),
            ("second_critical_angle", "second critical slope, figure 1"),
            ("second_critical_angle", "runs to the top"),
        ),
        measured=(
            ("one_variable", "second critical angle"),
            ("which_model", "second critical slope"),
        ),
        remarks={
            CONDITIONAL: "it exists, but lies at another slope than in BCRE, which it meets only "
            "as d goes to 0; and finite pulses are catastrophic below it. One layer with angles of "
            "start and stop has one too, and not every continuous model has"
        },
    ),
    PaperClaim(
        "In a catastrophic avalanche the static layer loses all of its matter (figure 1)",
        as_stated=(("avalanche_extent", "static layer"),),
        remarks={REFUTED: "the wedge at repose stays, Sc/S0 of it"},
    ),
    PaperClaim(
        "In a catastrophic avalanche the rolling layer grows along the whole slope (figure 1)",
        as_stated=(("avalanche_extent", "rolling layer"),),
        remarks={REPRODUCED: "in both models, as the scarp climbs to the top"},
    ),
    PaperClaim(
        "The dynamics of single-variable models can still be observed; the model extends them",
        as_stated=(("repose_return", "first property as printed"),),
        under_condition=(
            ("one_variable", "return to repose"),
            ("one_variable", "decay of roughness"),
            ("repose_return", "all or nothing"),
        ),
        remarks={
            CONDITIONAL: "the same end states are reached, but only after a disturbance that runs "
            "to the top: a one-variable pile cannot stand above repose, this one can"
        },
    ),
    PaperClaim(
        "The surface reaches an almost homogeneous slope, as in single-variable models",
        as_stated=(("avalanche_extent", "even slope"), ("one_variable", "decay of roughness")),
        measured=(("roughness_decay", "rough slope under steady flow"),),
        remarks={REPRODUCED: "where an avalanche ran to the top"},
    ),
    PaperClaim(
        "The automaton gives the same predictions as the continuous model: figure 1",
        as_stated=(
            ("paper_figures", "figure1 profile"),
            ("second_critical_angle", "second critical slope, figure 1"),
        ),
        under_condition=(
            ("paper_figures", "figure1 profile"),
            ("second_critical_angle", "second critical slope, figure 1"),
            ("second_critical_angle", "threshold against pulse"),
        ),
        measured=(
            ("paper_figures", "figure1 profile at t = 250, effective"),
            ("paper_figures", "figure1 climb, effective"),
            ("opening_angle", "opening angle, figure 1"),
            ("plane_agreement", "figure 1, later on a plane"),
        ),
        remarks={
            CONDITIONAL: "with cell size counted, at a cell Peclet number v d/D of 1, and up to "
            "t = 200; later even D_eff and kappa_eff leave more than the tolerance"
        },
    ),
    PaperClaim(
        "The automaton gives the same predictions as the continuous model: figures 2 and 3",
        as_stated=(
            ("paper_figures", "figure2 profile"),
            ("paper_figures", "figure3 profile"),
            ("second_critical_angle", "second critical slope, figures 2 and 3"),
        ),
        under_condition=(
            ("paper_figures", "figure2 profile"),
            ("paper_figures", "figure3 profile"),
            ("repose_return", "final slope"),
        ),
        measured=(
            ("second_critical_angle", "second critical slope, figures 2 and 3"),
            ("plane_agreement", "figure 2 on a plane"),
            ("plane_agreement", "figure 3 on a plane"),
        ),
        remarks={
            CONDITIONAL: "with cell size counted, which at their cell Peclet number of 25 makes D "
            "seven times what it is; Sd differs even then, but at 89.7 degrees and more, where no "
            "sand stands"
        },
    ),
    PaperClaim(
        "The automaton provides the same predictions as continuous models do",
        as_stated=(
            ("which_model", "automaton of each closure"),
            ("which_model", "profiles of each closure"),
        ),
        measured=(
            ("which_model", "return to repose"),
            ("which_model", "smoothing"),
            ("which_model", "second critical slope"),
        ),
        remarks={
            REFUTED: "the continuous models differ in what they predict; given the closure of one, "
            "the rule follows that one, but for the roughness that its cells smooth"
        },
    ),
    PaperClaim(
        "The automaton gives the same predictions as the continuous model: other parameters",
        as_stated=(("second_critical_angle", "second critical slope, other materials"),),
        under_condition=(
            ("second_critical_angle", "second critical slope, other materials"),
            ("roughness_decay", "short waves"),
        ),
        measured=(
            ("opening_angle", "opening angle, other materials"),
            ("plane_agreement", "an isotropic D_eff"),
        ),
        remarks={
            REFUTED: "with cell size counted it does up to a cell Peclet number of about 1 and "
            "for waves of twelve cells or more, beyond which the expansion in d ends"
        },
    ),
    PaperClaim(
        "The scheme is simpler and more efficient than the numerical solution of the PDEs",
        as_stated=(("speed_error", "efficiency"),),
        under_condition=(
            ("speed_error", "efficiency at 10 %"),
            ("speed_error", "what better rules buy"),
        ),
        remarks={
            CONDITIONAL: "a step costs least of all, but being of first order the rule needs so "
            "many cells that it is faster only for a coarse answer and before a scarp; of second "
            "order it stays so for longer"
        },
    ),
    PaperClaim(
        "The computation is not performed on a discretization of the data but on the data itself",
        as_stated=(("paper_figures", "no matter of cells"),),
        measured=(
            ("modified_equation", "explained in space"),
            ("order_of_accuracy", "order of the automaton"),
        ),
        remarks={REFUTED: "the rule is a first-order discretization of BCRE: D_eff goes with d"},
    ),
    PaperClaim(
        "It avoids the technical considerations that the solution of differential equations needs",
        refuted_by=(("printed_rule", "the literal step"),),
        measured=(("stability", "boundary of the automaton's rules"),),
        remarks={
            REFUTED: "with v = 2.5, D = 0.1 and d = 1 it is unstable for dt above 0.370, and the "
            "step, the sign and the order of the printed rule must be chosen"
        },
    ),
    PaperClaim(
        "The model is fit for interactive simulation",
        measured=(("scaling", "interactive"), ("scaling", "interactive on a plane")),
        remarks={UNTESTABLE: "no size and no frame rate is named; what we measured stands beside"},
    ),
    PaperClaim(
        "Statistical properties of avalanches will be met",
        as_stated=(
            ("avalanche_statistics", "sizes under tilting"),
            ("avalanche_statistics", "sizes under feeding"),
        ),
        under_condition=(("avalanche_statistics", "oscillation between two slopes"),),
        measured=(("avalanche_statistics", "small avalanches"),),
        remarks={
            CONDITIONAL: "not the power laws of critical systems: driven slowly, the slope "
            "oscillates as in BCRE, with avalanches of one size that carry nearly all the sand"
        },
    ),
    PaperClaim(
        "The model agrees with what experiments on real granular systems show",
        undecided=UNDECIDED,
        remarks={
            UNDECIDED: "nothing here is compared with an experiment: both models are equations"
        },
    ),
)
