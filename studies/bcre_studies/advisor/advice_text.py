"""What was advised, to be read and to be run."""

from __future__ import annotations

import math
import shlex
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

from rich.console import Console
from rich.markup import escape
from rich.progress import Progress

from bcre_studies.advisor.advise import Advice, Effort
from bcre_studies.advisor.options import PRECISE, Option
from bcre_studies.advisor.pilot import with_model
from bcre_studies.advisor.question import Question
from bcre_studies.advisor.scene_text import scene_text
from bcre_studies.advisor.widened import advise_with_reference
from bcre_studies.advisor.without_layer import WithoutLayer
from bcre_studies.comparison.rounding import significant
from bcre_studies.models.bcre import COARSEST
from bcre_studies.models.registry import AUTOMATON, BCRE, CANDIDATES, QUASI_STATIC, SCHEMES
from bcre_studies.running.place import Origin
from bcre_studies.running.run import require_runnable
from bcre_studies.system.files import replace_text, require_writable
from bcre_studies.timing.costs import Costs, measure, recorded

FOR = "# advised for "
"""So begins the line of an advised scene that names the scene which was asked about."""


def answer(question: Question, origin: Origin, path: Path) -> str:
    """Advise with pilots timed on this machine, write the advised scene, and report both.

    Parameters
    ----------
    origin: where the scene came from; path: of the file that is written.

    Raises
    ------
    SceneError
        where the scene cannot be run; OSError where the file cannot be written.
    """
    require_writable("--out", path.parent, (path.name,))
    cells = max(question.scene.domain.cells, COARSEST)  # which hold the start
    require_runnable(with_model(question.scene, BCRE.name, cells), BCRE.name, question.frames)
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task("pilots", total=None)

        def tell(pilot: str) -> None:
            progress.update(task, description=escape(f"pilot: {pilot}"), advance=1)

        advice = advise_with_reference(question, Effort(_costs(tell), tell=tell))
    write_advised(advice, origin, path)
    return text(advice, origin.name, path)


def _costs(tell: Callable[[str], object]) -> Costs:
    """What runs cost: as recorded, or measured where there is no record."""
    try:
        return recorded()
    except FileNotFoundError as missing:
        print(f"bcre: {missing}; measured now, half a minute", file=sys.stderr, flush=True)
        tell("what runs cost")
        return Costs(measure())


def text(advice: Advice, scene: str, path: Path) -> str:
    """The answer, a line for each thing.

    Parameters
    ----------
    scene: what the scene is called; path: of the file that can be run.
    """
    return "\n".join(_lines(advice, scene, path))


def advised_of(path: Path) -> list[str]:
    """The scene that a file was advised for; none where it says nothing."""
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, ValueError):
        return []
    return [line.removeprefix(FOR) for line in lines if line.startswith(FOR)]


def write_advised(advice: Advice, origin: Origin, path: Path) -> None:
    """Write the scene on the advised model and cells, where there is one."""
    if not advice.options:
        return
    best, question = advice.options[0], advice.question
    advised = with_model(question.scene, best.model, best.cells)
    comments = f"# {_option(best)}, for {question.observable}", FOR + origin.seen_from(path.parent)
    replace_text(path, scene_text(advised, path.parent, *comments))


def _lines(advice: Advice, scene: str, path: Path) -> Iterator[str]:
    question = advice.question
    yield f"asked:          {scene}: {_asked(question)}"
    if advice.instead_of is not None:
        yield from _instead(advice, advice.instead_of)
    if advice.closed is not None:
        form, error = advice.closed
        yield f"closed form:    {form.name}, error {_percent(error)}, at no cost: {form.formula}"
    if advice.without_layer is not None:
        yield from _without_layer(advice, advice.without_layer)
    if not advice.options:
        yield f"unresolved:     {advice.why}"
    else:
        yield from _recommended(advice, advice.options[0])
    for place, option in enumerate(advice.options[1:]):
        name = "runner-up:" if place == 0 else "left out:"
        yield f"{name:16}{_option(option)}{_against(advice, option)}"
    for model, why in advice.left_out.items():
        yield f"left out:       {CANDIDATES[model].label}: {why}"
    if math.isfinite(advice.reference_error):
        known = f"its own error {_percent(advice.reference_error)}"
        kappa = question.scene.material.kappa
        named = f" with kappa = {kappa:g}" if kappa else ""
        yield f"reference:      BCRE{named} on {advice.reference_cells} cells, {known}"
    yield f"pilots:         {advice.pilots_s:.2g} s"
    if advice.options:
        model = AUTOMATON.name if advice.options[0].model in SCHEMES else BCRE.name
        yield f"wrote:          {path}"
        command = f"bcre run {shlex.quote(str(path))} --model {model}{_frames(question)}"
        yield f"run it:         {command}"


def _instead(advice: Advice, first: Advice) -> Iterator[str]:
    """Which reference stands in for BCRE with kappa = 0, and why."""
    scene = advice.question.scene
    yield f"unresolved:     {first.why}"
    yield (
        f"instead:        kappa = {scene.material.kappa:g} = gamma d/2, the curvature that the "
        f"scene's cells of d = {scene.d:g} add to the automaton"
    )
    yield f"{'':16}all errors below are from BCRE with this kappa, and the advised scene has it"


def _without_layer(advice: Advice, found: WithoutLayer) -> Iterator[str]:
    """That no rolling layer is needed, the error and the cost of doing without."""
    took = _time(found.seconds)
    if advice.options:
        took += f", {_short(advice.options[0].seconds / found.seconds)} times less than recommended"
    yield (
        f"no layer:       {QUASI_STATIC.text}, isotonic steps on {found.cells} cells: error "
        f"{_percent(found.error)}, {took}"
    )
    yield f"{'':16}v/(gamma Sc l) = {found.eps:.2g} and R/(Sc l) = {found.tau:.2g} are small"
    yield f"{'':16}run the scene as it was asked about with --model {QUASI_STATIC.name}"


def _asked(question: Question) -> str:
    what = f"{question.observable} at t = {question.scene.time.until:g}"
    if question.budget is not None:
        return f"{what} as near to BCRE as {_time(question.budget)} a frame allow"
    return f"{what} within {_percent(question.tolerance)} of BCRE"


def _recommended(advice: Advice, best: Option) -> Iterator[str]:
    question = advice.question
    yield f"recommended:    {_option(best)}"
    until, length = question.scene.time.until, question.scene.domain.length
    step = f"auto, {until / best.steps:.2g} on the average, {best.steps:.0f} steps"
    yield f"cell and step:  d = {length / best.cells:.3g}; dt {step}"
    yield f"predicted:      error {_percent(best.error)} +- {_percent(best.spread)}"
    rate = (question.frames - 1) / best.seconds
    took = f"{_time(best.seconds)} for {question.frames} frames"
    yield f"                {took}, {_short(rate)} frames/s"
    if question.budget is not None and best.error < PRECISE:
        equal = f"errors below {_percent(PRECISE)} count as equal"
        yield f"                {equal}: the cheapest of them"
    if question.budget is not None and best.error + best.spread > question.tolerance:
        yield f"                that may be more than {_percent(question.tolerance)}"


def _option(option: Option) -> str:
    return f"{CANDIDATES[option.model].label}, {option.cells} cells"


def _against(advice: Advice, option: Option) -> str:
    """What the option has against it."""
    best = advice.options[0]
    ratio = f"{_short(option.seconds / best.seconds)} times the time"
    return f": error {_percent(option.error)}, {_time(option.seconds)}, {ratio}"


def _frames(question: Question) -> str:
    return "" if question.frames == 11 else f" --frames {question.frames}"


def _percent(share: float) -> str:
    return f"{100 * share:.2g} %" if share >= 1e-5 else "below 0.001 %"


def _time(seconds: float) -> str:
    return f"{_short(1000 * seconds)} ms" if seconds < 1 else f"{_short(seconds)} s"


def _short(value: float) -> str:
    return f"{significant(value, 2):,g}" if value < 1e6 else f"{value:.1e}"
