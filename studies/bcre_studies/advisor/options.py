r"""Which models do what is asked, on how many cells, and in what order they are to be preferred.

To a tolerance every model gets the fewest cells with

    safety error(N) + e_ref <= tolerance        e_ref the error of the reference itself

and the one that takes the fewest seconds comes first; where a time per frame is given every model
gets the most cells that hold it, and the one with the least error comes first.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from bcre_studies.advisor.candidate import FARTHEST, HALF, Candidate, Pilot
from bcre_studies.advisor.deviation import deviation
from bcre_studies.advisor.pilot import COARSEST, Allowance, PilotError, Reference
from bcre_studies.advisor.question import Question

PRECISE = 1e-3
"""Where a time is given, an error as small as this is as good as none."""


@dataclass(frozen=True)
class Option:
    """A model on so many cells: steps, error with its uncertainty, and seconds, all predicted."""

    model: str
    cells: int
    steps: float
    error: float
    spread: float
    seconds: float


def confirmed(
    question: Question, found: list[Candidate], against: Reference, allowance: Allowance
) -> tuple[tuple[Option, ...], dict[str, str]]:
    """The options, each of them run where the allowance permits, and why other models are none.

    A measured value replaces the predicted one. That may change how many cells an option needs, so
    the search repeats until every option within reach of the pilots has been run.
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
    seconds = predicted_seconds(question, model, cells, allowance)
    return Option(model.model, cells, model.steps(cells), error, spread, seconds)


def _never(question: Question, model: Candidate) -> str:
    last = model.pilots[-1]
    reached = f"its error is {last.error:.2g} on {last.cells} cells"
    if not model.converges:
        return f"{reached}, and it has no kappa: finer cells lead it elsewhere"
    if model.pilots[-2].error > HALF:
        return f"{reached}, too far to predict finer grids"
    return f"{reached} and falls as d^{model.order:.2g}: not within {FARTHEST:.0f} times as many"


def _most_cells(question: Question, model: Candidate, allowance: Allowance) -> int | None:
    """Most cells that hold the frame rate, but no more than make the error :data:`PRECISE`."""
    low, high = COARSEST, int(FARTHEST * model.finest)
    if predicted_seconds(question, model, low, allowance) > question.whole_time:
        return None
    while high - low > 1:
        middle = (low + high) // 2
        holds = predicted_seconds(question, model, middle, allowance) <= question.whole_time
        low, high = (middle, high) if holds else (low, middle)
    return min(low, model.cells_for(PRECISE) or low)


def _rank(question: Question, option: Option) -> tuple[float, float]:
    """The cheapest first; where a time is given the most accurate, and of equals the cheapest."""
    if question.budget is None:
        return option.seconds, option.error
    return max(option.error, PRECISE), option.seconds


def predicted_seconds(
    question: Question, model: Candidate, cells: int, allowance: Allowance
) -> float:
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
