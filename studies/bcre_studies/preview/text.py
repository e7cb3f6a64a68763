"""What will be run, in words."""

from __future__ import annotations

from collections.abc import Iterator

from bcre_studies.models.registry import BOTH, chosen
from bcre_studies.preview import equations, phrases
from bcre_studies.preview.cells import TOLERANCE, cells_needed
from bcre_studies.preview.effort import memory, of_automaton, of_bcre
from bcre_studies.preview.equations import number
from bcre_studies.preview.numbers import Numbers, explicit_step, numbers_of
from bcre_studies.preview.phrases import Line
from bcre_studies.running.run import notes
from bcre_studies.scenes.scene import Scene
from bcre_studies.system.memory import available
from bcre_studies.system.one_line import one_line
from bcre_studies.timing.costs import recorded


def lines(scene: Scene, frames: int, source: str) -> Iterator[Line]:
    """Everything, a line for each thing.

    Parameters
    ----------
    source: what the scene is called on the command line.

    Raises
    ------
    SceneError
        where the automaton or BCRE does not have what the scene asks for.
    """
    for model in chosen(BOTH):
        model.adapter().require_admitted(scene)
    numbers = numbers_of(scene)
    yield "scene", one_line(scene.title)
    for name, rows in equations.of(scene, numbers.rule):
        yield from phrases.under(name, rows)
    yield from _grid(scene, numbers)
    yield from phrases.dimensionless(numbers)
    yield from _effective(numbers)
    yield from _stable(scene, numbers)
    yield from phrases.slopes(numbers, scene.material.Sc, bool(scene.rolling))
    yield from _cells(scene, source)
    yield from _expected(scene, numbers, frames)
    yield from phrases.under("note", notes(scene, BOTH))


def _grid(scene: Scene, numbers: Numbers) -> Iterator[Line]:
    rule, units = numbers.rule, scene.units
    length = f" {units.length}" if units else ""
    yield (
        "domain",
        f"0 <= x <= {number(scene.domain.length)}{length}, ends {scene.domain.ends}; "
        f"{scene.domain.cells} cells of d = {number(rule.d)}{length}",
    )
    unit = units.time if units else ""
    yield phrases.time(scene.time.until, unit, numbers, scene.time.step == "auto")


def _effective(numbers: Numbers) -> Iterator[Line]:
    rule = numbers.rule
    if rule.scheme == "upwind":
        yield (
            "D_eff, kappa_eff",
            f"{number(rule.effective_diffusion())} and {number(rule.effective_curvature())}: "
            "to first order the automaton solves BCRE with these",
        )


def _stable(scene: Scene, numbers: Numbers) -> Iterator[Line]:
    wave = [number(numbers.wave_step(R)) for R in (numbers.largest_R, numbers.thickest)]
    rows = [
        f"automaton: dt <= {number(numbers.layer_step)} keeps R >= 0",
        f"automaton: dt <= d/(gamma R) = {wave[0]} at the start, at least {wave[1]} later, keeps "
        "the climbing wave stable",
    ]
    cells = scene.solver.cells or scene.domain.cells
    step = explicit_step(scene, cells, numbers.largest_R)
    rows.append(f"BCRE, Runge-Kutta on {cells} cells: dt <= {number(step)} at the start")
    yield from phrases.under("stable steps", rows)


def _cells(scene: Scene, source: str) -> Iterator[Line]:
    found = cells_needed(scene)
    name = f"cells for {100 * TOLERANCE:g} %"
    if isinstance(found, str):
        yield name, f"not known by a closed form: {found}"
        yield "", f"`bcre advise {source}` measures it by short runs"
        return
    yield name, f"{found:,} of the automaton, for R at the end, by D_eff on a frozen slope"
    yield "", f"`bcre advise {source}` measures it, and names a cheaper model where there is one"


def _expected(scene: Scene, numbers: Numbers, frames: int) -> Iterator[Line]:
    taken = memory(scene, frames)
    yield (
        "memory",
        f"about {phrases.size(taken)} of {phrases.size(available())}, for {frames} frames",
    )
    try:
        costs = recorded()
    except FileNotFoundError as missing:
        yield "time of a run", f"not known: {missing}"
        return
    for name, effort in (
        ("time, automaton", of_automaton(scene, numbers, costs, frames)),
        ("time, BCRE", of_bcre(scene, numbers, costs, frames)),
    ):
        yield (
            name,
            f"{phrases.span_of_seconds(*effort.seconds)}, "
            f"{phrases.span_of_steps(*effort.steps)} steps",
        )
    yield "", "on the machine of the record of speed; compiling comes on top, once"
