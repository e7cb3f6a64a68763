"""What will be run, in words."""

from __future__ import annotations

import math
from collections.abc import Iterator

from bcre_studies.comparison.rounding import significant
from bcre_studies.models.registry import BOTH, chosen
from bcre_studies.preview import equations
from bcre_studies.preview.cells import TOLERANCE, cells_needed
from bcre_studies.preview.effort import Effort, memory, of_automaton, of_bcre
from bcre_studies.preview.equations import number
from bcre_studies.preview.numbers import Numbers, explicit_step, numbers_of, regime
from bcre_studies.running.run import notes
from bcre_studies.scenes.scene import Scene
from bcre_studies.system.memory import available
from bcre_studies.system.one_line import one_line
from bcre_studies.timing.costs import recorded

Line = tuple[str, str]
"""A name, which may be empty, and what is said under it."""


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
        yield from _under(name, rows)
    yield from _grid(scene, numbers)
    yield from _dimensionless(numbers)
    yield from _stable(scene, numbers)
    yield from _slopes(scene, numbers)
    yield from _cells(scene, source)
    yield from _expected(scene, numbers, frames)
    yield from _under("note", notes(scene, BOTH))


def _under(name: str, rows: list[str]) -> Iterator[Line]:
    for index, row in enumerate(rows):
        yield ("" if index else name), row


def _grid(scene: Scene, numbers: Numbers) -> Iterator[Line]:
    rule, units = numbers.rule, scene.units
    length, time = (f" {units.length}", f" {units.time}") if units else ("", "")
    yield (
        "domain",
        f"0 <= x <= {number(scene.domain.length)}{length}, ends {scene.domain.ends}; "
        f"{scene.domain.cells} cells of d = {number(rule.d)}{length}",
    )
    how = ", at the start; a thick layer shortens it" if scene.time.step == "auto" else ""
    how = how if numbers.is_stable else ", which is not stable and will be refused"
    yield "time", f"0 <= t <= {number(scene.time.until)}{time}, dt = {number(rule.dt)}{time}{how}"


def _dimensionless(numbers: Numbers) -> Iterator[Line]:
    rule = numbers.rule
    yield "Courant number", f"v dt/d = {number(numbers.courant)}"
    yield "Peclet number", f"v d/D = {number(numbers.peclet)}"
    least, most = numbers.exchange(numbers.largest_R), numbers.exchange(numbers.thickest)
    yield (
        "exchange number",
        f"gamma R dt/d = {number(least)} for R = {number(numbers.largest_R)}, the thickest at the "
        f"start; at most {number(most)}, for R = {number(numbers.thickest)}",
    )
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
    yield from _under("stable steps", rows)


def _slopes(scene: Scene, numbers: Numbers) -> Iterator[Line]:
    Sc = scene.material.Sc
    ca, pde = (
        "no closed form" if math.isnan(Sd) else f"{number(Sd)} (Sd - Sc = {number(Sd - Sc)})"
        for Sd in (numbers.sd_automaton, numbers.sd_bcre)
    )
    yield "repose slope", f"Sc = {number(Sc)}"
    yield "critical slope", f"Sd = {ca} in the automaton, {pde} in BCRE"
    mean, least, most = numbers.slope
    is_even = most - least <= 1e-9 * max(abs(most), 1.0)
    places = [("slope at start", mean)] if is_even else [("mean slope", mean), ("steepest", most)]
    for name, slope in places:
        yield name, f"S = {number(slope)}, {regime(slope, numbers, Sc)}"
    if scene.rolling and not is_even:
        yield "", "a thick pulse may climb below Sd too"


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
    yield "memory", f"about {_bytes(taken)} of {_bytes(available())}, for {frames} frames"
    try:
        costs = recorded()
    except FileNotFoundError as missing:
        yield "time of a run", f"not known: {missing}"
        return
    for name, effort in (
        ("time, automaton", of_automaton(scene, numbers, costs, frames)),
        ("time, BCRE", of_bcre(scene, numbers, costs, frames)),
    ):
        yield name, f"{_seconds(effort)}, {_range(*effort.steps)} steps"
    yield "", "on the machine of the record of speed; compiling comes on top, once"


def _range(least: float, most: float) -> str:
    low, high = (f"{significant(max(steps, 1.0), 2):,.0f}" for steps in (least, most))
    return low if low == high else f"{low} to {high}"


def _seconds(effort: Effort) -> str:
    low, high = (_duration(seconds) for seconds in effort.seconds)
    return low if low == high else f"{low} to {high}"


def _duration(seconds: float) -> str:
    if seconds < 1:
        return f"{significant(1000 * seconds, 2):g} ms"
    return f"{significant(seconds, 2):,g} s"


def _bytes(count: int) -> str:
    return f"{significant(count / 1e6, 2):,g} MB"
