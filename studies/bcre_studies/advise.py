r"""Which model, on which cells, answers a scene to a tolerance at the least cost, or in a time.

Every model is piloted (:mod:`bcre_studies.pilot`); what the pilots foretell
(:mod:`bcre_studies.candidate`) is asked for

    safety error(N) + e_ref <= tolerance        e_ref the error of the reference itself

and of the models that come there the one that takes the fewest seconds is advised; or, where a time
per frame is given, of all that hold it the one with the least error. Errors are relative to BCRE,
converged, with the material of the scene. The step follows its bounds ("auto"): the upwind rule is
the more accurate the longer it is, (v d/2)(1 - v dt/d), the calibrated one needs a long one, and a
shorter one would only cost more.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

import bcre_pde
from bcre_studies.candidate import FARTHEST, HALF, MODELS, SAFETY, SCHEMES, Candidate, Pilot
from bcre_studies.closed_forms import ClosedForm, closed_form
from bcre_studies.deviation import deviation, posed
from bcre_studies.pilot import (
    COARSEST,
    FINEST,
    REFERENCE_SHARE,
    Allowance,
    PilotError,
    Reference,
    candidate,
    reference,
    sees_start,
    warm_up,
)
from bcre_studies.scene import Scene
from bcre_studies.simulate import frame_times, problem_of
from bcre_studies.speed.costs import Costs, closures_of

RESOLVED, USABLE = 0.1, 0.25
"""The reference is refined to this part of the tolerance; of use if it comes to that part."""

PRECISE = 1e-3
"""Where a time is given, an error as small as this is as good as none."""

GONE = 1e-6
"""A rolling layer of which no more is left has gone: there is nothing to be right about."""

LEAST_S, MOST_S, PART = 10.0, 30.0, 0.1
"""Pilots may take this part of a full reference run, but at least and at most so many seconds."""


def seconds_of(text: str) -> float:
    """Seconds of a time such as "16ms", "0.016s" or "0.016".

    Raises
    ------
    ValueError
        for anything else.
    """
    unit = 1e-3 if text.endswith("ms") else 1.0
    try:
        seconds = float(text.removesuffix("ms").removesuffix("s")) * unit
    except ValueError:
        seconds = math.nan
    if not 0 < seconds < math.inf:
        raise ValueError(f"--budget = {text!r}: must be a time > 0 such as 16ms, 0.016s or 0.016")
    return seconds


@dataclass(frozen=True)
class Question:
    """What is asked of a scene.

    Parameters
    ----------
    tolerance: largest relative error of the observable, between 0 and 1.
    observable: one of :data:`bcre_studies.deviation.OBSERVABLES`.
    budget: seconds per frame; given, the most accurate model that holds it is wanted.
    frames: as of ``bcre run``: times from 0 to the end, frames - 1 of them to be computed.

    Raises
    ------
    ValueError
        naming key, value and what is allowed.
    """

    scene: Scene
    tolerance: float = 0.05
    observable: str = "R"
    budget: float | None = None
    frames: int = 11

    def __post_init__(self) -> None:
        if not 0 < self.tolerance < 1:
            raise ValueError(f"--tolerance = {self.tolerance!r}: must lie between 0 and 1")
        if self.observable not in posed(self.scene):
            allowed = ", ".join(posed(self.scene))
            raise ValueError(
                f"--observable = {self.observable!r}: must be one of {allowed} in this scene"
            )
        if self.budget is not None and not 0 < self.budget < math.inf:
            raise ValueError(f"--budget = {self.budget!r}: must be a time > 0 in seconds")

    @property
    def times(self) -> list[float]:
        """When the runs are recorded."""
        return frame_times(self.scene, self.frames)


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
    tell: is told which pilot runs.
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
class Option:
    """A model on so many cells: steps, error with its uncertainty, and seconds, all predicted."""

    model: str
    cells: int
    steps: float
    error: float
    spread: float
    seconds: float


@dataclass(frozen=True)
class Advice:
    """What is advised.

    ``options`` are the models that do what was asked for, the best one first; where there is none,
    ``why`` says for what reason. ``left_out`` tells of the other models why they do not; ``closed``
    is a closed form that does, with its error.
    """

    question: Question
    options: tuple[Option, ...] = ()
    left_out: dict[str, str] = field(default_factory=dict)
    closed: tuple[ClosedForm, float] | None = None
    reference_cells: int = 0
    reference_error: float = math.inf
    pilots_s: float = 0.0
    why: str = ""


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
        )
    found, left_out = _piloted(question, against, effort, allowance)
    options, reasons = _confirmed(question, found, against, allowance)
    return Advice(
        question,
        options,
        left_out | reasons,
        _closed(question, against),
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
        "pde", FINEST, scene.time.until / step, closures_of(scene), question.frames
    )


def _reference(question: Question, effort: Effort, allowance: Allowance) -> Reference:
    scene = question.scene
    if effort.clocked:
        for model in MODELS:
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
            return _seconds(question, model, model.finest, allowance) > _time(question)
        errors = [SAFETY * pilot.error + against.error for pilot in model.pilots[-2:]]
        return max(errors) <= question.tolerance

    for number, scheme in enumerate(SCHEMES, start=1):
        share = REFERENCE_SHARE + (1 - REFERENCE_SHARE) * number / len(SCHEMES)
        try:
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
        except PilotError as failure:
            left_out[scheme] = f"could not be piloted: {failure}"
    return found, left_out


def _confirmed(
    question: Question, found: list[Candidate], against: Reference, allowance: Allowance
) -> tuple[tuple[Option, ...], dict[str, str]]:
    """The options, each of them run where the allowance permits, and why other models are none.

    What was foretold of an option is replaced by what it does. That may change how many cells it
    needs, so it is asked again, until every option within reach of the pilots has been run.
    """
    models = {model.model: model for model in found}
    beyond: set[str] = set()
    while True:
        options, reasons = _options(question, models, against, allowance)
        todo = [
            option
            for option in options
            if option.model not in beyond and not models[option.model].has_pilot(option.cells)
        ]
        if not todo:
            return options, reasons
        option, model = todo[0], models[todo[0].model]
        if option.cells > allowance.finest or not allowance.permits(option.seconds):
            beyond.add(option.model)
            continue
        try:
            run = allowance.take(question.scene, option.model, question.times, option.cells)
        except PilotError:
            beyond.add(option.model)
            continue
        error = deviation(run, against.run, question.observable)
        models[option.model] = model.with_pilot(Pilot(option.cells, run.steps, run.wall_s, error))


def _options(
    question: Question, models: dict[str, Candidate], against: Reference, allowance: Allowance
) -> tuple[tuple[Option, ...], dict[str, str]]:
    """The models that do what is asked, the best first, and why the others do not."""
    options, reasons = [], {}
    for name, model in models.items():
        option = _option(question, model, against, allowance)
        if isinstance(option, str):
            reasons[name] = option
        else:
            options.append(option)
    return tuple(sorted(options, key=lambda option: _rank(question, option))), reasons


def _option(
    question: Question, model: Candidate, against: Reference, allowance: Allowance
) -> Option | str:
    """The model on the cells that do what is asked, or why it cannot."""
    if question.budget is None:
        cells = model.cells_for(question.tolerance - against.error)
        if cells is None:
            return _never(question, model)
    else:
        cells = _most_cells(question, model, allowance)
        if cells is None:
            return f"{COARSEST} cells already take longer than {question.budget:.2g} s a frame"
    error = model.error(cells)
    spread = (model.safety(cells) - 1) * error + against.error
    seconds = _seconds(question, model, cells, allowance)
    return Option(model.model, cells, model.steps(cells), error, spread, seconds)


def _never(question: Question, model: Candidate) -> str:
    last = model.pilots[-1]
    reached = f"its error is {last.error:.2g} on {last.cells} cells"
    if not model.converges:
        return f"{reached}, and it has no kappa: finer cells lead it elsewhere"
    if model.pilots[-2].error > HALF:
        return f"{reached}, too much to foretell what finer ones do"
    return f"{reached} and falls as d^{model.order:.2g}: not within {FARTHEST:.0f} times as many"


def _time(question: Question) -> float:
    """Seconds that the whole run may take."""
    assert question.budget is not None
    return question.budget * (question.frames - 1)


def _most_cells(question: Question, model: Candidate, allowance: Allowance) -> int | None:
    """Most cells that hold the frame rate, but no more than make the error :data:`PRECISE`."""
    low, high = COARSEST, int(FARTHEST * model.finest)
    if _seconds(question, model, low, allowance) > _time(question):
        return None
    while high - low > 1:
        middle = (low + high) // 2
        holds = _seconds(question, model, middle, allowance) <= _time(question)
        low, high = (middle, high) if holds else (low, middle)
    return min(low, model.cells_for(PRECISE) or low)


def _rank(question: Question, option: Option) -> tuple[float, float]:
    """The cheapest first; where a time is given the most accurate, and of equals the cheapest."""
    if question.budget is None:
        return option.seconds, option.error
    return max(option.error, PRECISE), option.seconds


def _seconds(question: Question, model: Candidate, cells: int, allowance: Allowance) -> float:
    """Predicted seconds: by the costs, times what pilots on about as many cells took of them."""
    name, frames = model.model, question.frames - 1

    def expected(cells: int, steps: float) -> float:
        return allowance.expected(question.scene, name, cells, steps, frames)

    seconds = expected(cells, model.steps(cells))
    if not allowance.clocked:
        return seconds
    grids = np.log([pilot.cells for pilot in model.pilots])
    took = np.log([p.wall_s / expected(p.cells, p.steps) for p in model.pilots])
    return seconds * float(np.exp(np.interp(math.log(cells), grids, took)))


def _unresolved(question: Question, against: Reference) -> str:
    """Why the error of the reference is not small."""
    cells = against.run.x.size
    found = f"{question.observable} of BCRE is known to {against.error:.2g} only, on {cells} cells"
    if not sees_start(question.scene, cells):
        return f"{cells} cells, the finest pilots, are wider than parts of the start"
    left = float(against.run.R[-1].mean() / (against.run.R[0].mean() or 1.0))
    if question.observable == "R" and left < GONE:
        return f"{found}: {left:.1g} of the layer is left in the domain, which is what R is then"
    if against.has_scarp and question.scene.material.kappa == 0:
        return (
            f"{found}: past a scarp with kappa = 0 it has no converged solution to be near to; "
            "a material.kappa > 0 gives the scarp a width"
        )
    if cells < FINEST:
        return f"{found}, and finer pilots would take too long"
    return f"{found}, the finest pilots"


def _closed(question: Question, against: Reference) -> tuple[ClosedForm, float] | None:
    """The closed form of the scene where its error is within the tolerance."""
    form = closed_form(question.scene)
    if form is None:
        return None
    run = form.run(question.scene, question.times, against.run.x.size)
    error = deviation(run, against.run, question.observable)
    return (form, error) if error + against.error <= question.tolerance else None
