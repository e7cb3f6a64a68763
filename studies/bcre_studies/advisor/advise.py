r"""Which model, on which cells, answers a scene to a tolerance at the least cost, or in a time.

Every model is piloted (``pilot``). What the pilots predict (``candidate``) gives the cells on which
a model meets the request, and ``options`` ranks the models that do. Errors are relative to BCRE,
converged, with the material of the scene. The step follows its bounds ("auto"): the upwind rule
gains accuracy with a longer step, (v d/2)(1 - v dt/d), and the calibrated rule needs a long one;
a shorter step only costs more.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import bcre_pde
from bcre_studies.advisor.candidate import SAFETY, Candidate
from bcre_studies.advisor.closed_forms import ClosedForm, closed_form
from bcre_studies.advisor.deviation import deviation
from bcre_studies.advisor.options import PRECISE, Option, confirmed, predicted_seconds
from bcre_studies.advisor.pilot import (
    COARSEST,
    FINEST,
    REFERENCE_SHARE,
    Allowance,
    PilotError,
    Reference,
    candidate,
    reference,
    warm_up,
)
from bcre_studies.advisor.question import Question
from bcre_studies.advisor.without_layer import WithoutLayer, without_layer
from bcre_studies.models.bcre import problem_of
from bcre_studies.models.registry import BCRE, CANDIDATES, SCHEMES
from bcre_studies.scenes.scene import SceneError
from bcre_studies.timing.costs import Costs, closures_of

RESOLVED, USABLE = 0.1, 0.25
"""Target and largest usable error of the reference, as parts of the tolerance."""

GONE = 1e-6
"""A rolling layer is gone once less than this part of it is left: its error means nothing."""

LEAST_S, MOST_S, PART = 10.0, 30.0, 0.1
"""Pilots may take this part of a full reference run, within these limits in seconds."""


@dataclass(frozen=True)
class Effort:
    """How much is spent on pilots, and how it is counted.

    Parameters
    ----------
    costs: what runs are expected to take.
    clocked: whether pilots are timed and their times preferred to the costs; else the same is
        advised on every machine.
    seconds: that pilots may take; None for :data:`PART` of a full reference run, within bounds.
    finest: cells of the automaton's finest pilot.
    tell: called with the name of each pilot before it runs.
    """

    costs: Costs
    clocked: bool = True
    seconds: float | None = None
    finest: int = FINEST
    tell: Callable[[str], object] = lambda _: None

    def allowance(self, question: Question) -> Allowance:
        """The allowance of all pilots of a question."""
        limit = self.seconds
        if limit is None:
            limit = PART * _full_reference(question, self.costs)
            limit = min(max(limit, LEAST_S), MOST_S)
        return Allowance(limit, self.costs, self.clocked, self.finest, tell=self.tell)


@dataclass(frozen=True)
class Advice:
    """What is advised.

    ``options`` are the models that do what was asked for, the best one first; where there is none,
    ``why`` says for what reason. ``left_out`` gives the reason for each other
    model; ``closed`` is a closed form that meets the request, with its error, and ``without_layer``
    the quasi-static limit where it does. ``needs_width`` says that a scarp with kappa = 0 left the
    reference unresolved, and ``instead_of`` holds the advice that ended so, where this one has
    another reference (``widened``).
    """

    question: Question
    options: tuple[Option, ...] = ()
    left_out: dict[str, str] = field(default_factory=dict)
    closed: tuple[ClosedForm, float] | None = None
    without_layer: WithoutLayer | None = None
    reference_cells: int = 0
    reference_error: float = math.inf
    pilots_s: float = 0.0
    why: str = ""
    needs_width: bool = False
    instead_of: Advice | None = None


def advise(question: Question, effort: Effort) -> Advice:
    """Pilot all models, and advise one."""
    allowance = effort.allowance(question)
    try:
        against = _reference(question, effort, allowance)
    except PilotError as failure:
        return Advice(question, pilots_s=allowance.spent, why=f"no reference: {failure}")
    if against.error > USABLE * question.tolerance:
        return Advice(
            question,
            reference_cells=against.run.x.size,
            reference_error=against.error,
            pilots_s=allowance.spent,
            why=_unresolved(question, against),
            needs_width=_needs_width(question, against),
        )
    found, left_out = _piloted(question, against, effort, allowance)
    options, reasons = confirmed(question, found, against, allowance)
    return Advice(
        question,
        options,
        left_out | reasons,
        _closed(question, against),
        without_layer(question, against),
        against.run.x.size,
        against.error,
        allowance.spent,
        "" if options else "no model does what is asked",
    )


def _full_reference(question: Question, costs: Costs) -> float:
    """Seconds of BCRE on the finest grid that a reference is refined to, by its first step."""
    scene = question.scene
    _, R = scene.initial(scene.centres(COARSEST))
    step = bcre_pde.largest_explicit_step(
        problem_of(scene).material, scene.domain.length / FINEST, float(R.max())
    )
    return costs.seconds(
        BCRE.name, FINEST, scene.time.until / step, closures_of(scene), question.frames
    )


def _reference(question: Question, effort: Effort, allowance: Allowance) -> Reference:
    scene = question.scene
    if effort.clocked:
        for model in CANDIDATES:
            effort.tell(f"{model}, compiling")
            warm_up(scene, model)
    wanted = RESOLVED * question.tolerance
    if question.budget is not None:
        wanted = min(wanted, PRECISE)
    return reference(scene, question.times, question.observable, wanted, allowance)


def _piloted(
    question: Question, against: Reference, effort: Effort, allowance: Allowance
) -> tuple[list[Candidate], dict[str, str]]:
    """All models that could be piloted, and why the others could not."""
    found, left_out = [against.candidate(question.observable)], {}

    def enough(model: Candidate) -> bool:
        if question.budget is not None:
            return predicted_seconds(question, model, model.finest, allowance) > question.whole_time
        errors = [SAFETY * pilot.error + against.error for pilot in model.pilots[-2:]]
        return max(errors) <= question.tolerance

    for number, scheme in enumerate(SCHEMES, start=1):
        share = REFERENCE_SHARE + (1 - REFERENCE_SHARE) * number / len(SCHEMES)
        try:
            CANDIDATES[scheme].adapter().require_admitted(question.scene)
            found.append(
                candidate(
                    question.scene,
                    scheme,
                    against,
                    question.times,
                    question.observable,
                    enough,
                    allowance,
                    share,
                )
            )
        except SceneError as failure:
            left_out[scheme] = str(failure)
        except PilotError as failure:
            left_out[scheme] = f"could not be piloted: {failure}"
    return found, left_out


def _unresolved(question: Question, against: Reference) -> str:
    """Why the error of the reference is not small."""
    cells = against.run.x.size
    found = f"{question.observable} of BCRE is known to {against.error:.2g} only, on {cells} cells"
    left = _left(against)
    if question.observable == "R" and left < GONE:
        return f"{found}: {left:.1g} of the layer is left in the domain, which is what R is then"
    if _needs_width(question, against):
        return (
            f"{found}: past a scarp with kappa = 0 it has no converged solution to be near to; "
            "a material.kappa > 0 gives the scarp a width"
        )
    if cells < FINEST:
        return f"{found}, and finer pilots would take too long"
    return f"{found}, the finest pilots"


def _needs_width(question: Question, against: Reference) -> bool:
    """Whether it is a scarp with kappa = 0 that leaves the reference unresolved."""
    material = question.scene.material
    is_gone = question.observable == "R" and _left(against) < GONE
    return against.has_scarp and material.kappa == 0 and material.gamma > 0 and not is_gone


def _left(against: Reference) -> float:
    """The part of the rolling layer that is left at the end."""
    return float(against.run.R[-1].mean() / (against.run.R[0].mean() or 1.0))


def _closed(question: Question, against: Reference) -> tuple[ClosedForm, float] | None:
    """The closed form of the scene where its error is within the tolerance."""
    form = closed_form(question.scene)
    if form is None:
        return None
    run = form.run(question.scene, question.times, against.run.x.size)
    error = deviation(run, against.run, question.observable)
    return (form, error) if error + against.error <= question.tolerance else None
