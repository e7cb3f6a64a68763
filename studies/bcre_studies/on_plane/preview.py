"""What will be run on a plane, in words: ``bcre show`` of such a scene."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pandas as pd

from bcre_ca.plane import MARGIN
from bcre_pde.explicit import FEHLBERG
from bcre_studies.models.plane.bcre import problem_of, require_taken
from bcre_studies.models.registry import AUTOMATON, BCRE, Model
from bcre_studies.on_plane import equations
from bcre_studies.on_plane.command import memory_of, require_memory
from bcre_studies.on_plane.numbers import PlaneNumbers, numbers_of, opening_angles
from bcre_studies.preview import phrases
from bcre_studies.preview.equations import number
from bcre_studies.preview.phrases import Line
from bcre_studies.scenes.plane.scene import PlaneScene
from bcre_studies.scenes.refusal import SceneError
from bcre_studies.system.memory import available
from bcre_studies.system.one_line import one_line
from bcre_studies.system.records import record

FRAMES_A_SECOND = 60
RIGHT_HAND_SIDE = "BCRE right-hand side, 1e6 cells/s"


def lines(scene: PlaneScene, frames: int) -> Iterator[Line]:
    """Everything, a line for each thing.

    Raises
    ------
    ValueError
        where the scene would not fit into memory, or the automaton does not take it.
    """
    require_memory(scene, frames, models=1)
    numbers, without = numbers_of(scene), _without_bcre(scene)
    yield "scene", one_line(scene.title)
    for name, rows in equations.of(scene, numbers.rule):
        yield from phrases.under(name, rows)
    yield from phrases.under("domain", _domain(scene, numbers))
    yield phrases.time(scene.time.until, scene.units.time, numbers, scene.time.step == "auto")
    yield from phrases.dimensionless(numbers)
    yield from _effective(scene, numbers)
    yield from phrases.under("stable steps", _stable(scene, numbers, without))
    yield from phrases.slopes(numbers, scene.material.Sc, bool(scene.rolling))
    if scene.automaton.flow != "tilted":
        yield "", "Sd is that of a slope which falls along an axis of the cells, as on a line"
    yield "opening angle", _opening(scene, numbers)
    yield from _expected(scene, numbers, frames, without)


def _domain(scene: PlaneScene, numbers: PlaneNumbers) -> list[str]:
    domain, unit = scene.domain, scene.units.length
    rows, columns = domain.shape
    downhill, across = (" downhill", " across") if scene.automaton.flow == "tilted" else ("", "")
    found = [
        f"0 <= x <= {number(domain.length)} {unit}{downhill}, ends {domain.ends}; "
        f"0 <= y <= {number(domain.width)} {unit}{across}, sides {domain.sides}",
        f"{rows} x {columns} cells of d = {number(domain.d)} {unit}",
    ]
    if scene.wall:
        found.append(f"{int(scene.walls().sum())} of them walls, which hold no sand")
    if scene.base is not None:
        found.append(f"a layer of {number(scene.base.thickness)} {unit} on a rigid base")
    for source in scene.source:
        x, y = source.place
        times = f"from t = {number(source.start)}" + (
            f" to {number(source.until)}" if math.isfinite(source.until) else " on"
        )
        found.append(
            f"{number(source.rate)} {unit}^3 per {scene.units.time} poured on a disc of width "
            f"{number(source.width)} at ({number(x)}, {number(y)}), {times}"
        )
    return found


def _effective(scene: PlaneScene, numbers: PlaneNumbers) -> Iterator[Line]:
    name = "D_eff, kappa_eff"
    if scene.automaton.flow != "tilted":
        yield name, "known on a tilted plane alone: on a free surface the flow has no one direction"
        return
    rule = numbers.rule
    yield (
        name,
        f"{number(rule.effective_diffusion())} and {number(rule.effective_curvature())} along the "
        f"flow, {number(scene.material.across)} and 0 across: to first order the automaton solves "
        "BCRE with these",
    )


def _stable(scene: PlaneScene, numbers: PlaneNumbers, without: str) -> list[str]:
    law = "d/(2 gamma R)" if scene.automaton.flow == "split4" else "d/(gamma R)"
    wave = f"{law} = {number(numbers.wave_step(numbers.largest_R))} at the start, "
    least = numbers.wave_step(numbers.thickest)
    wave += f"at least {number(least)} later, " if least > 0 else "less under thicker layers, "
    step = "" if without else number(_step_of_bcre(scene, numbers.largest_R))
    return [
        f"automaton: dt <= {number(numbers.layer_step)} keeps R >= 0",
        f"automaton: dt <= {wave}keeps the surface wave stable",
        without or f"BCRE, Runge-Kutta: dt <= {step} at the start",
    ]


def _without_bcre(scene: PlaneScene) -> str:
    """Why BCRE does not take the scene; nothing where it does."""
    try:
        require_taken(scene)
    except SceneError as refused:
        return f"BCRE does not take this scene: {refused}"
    return ""


def _step_of_bcre(scene: PlaneScene, R: float) -> float:
    from bcre_pde.plane.theory import largest_explicit_step

    d = scene.domain.d
    return largest_explicit_step(problem_of(scene).material, d, d, R)


def _opening(scene: PlaneScene, numbers: PlaneNumbers) -> str:
    found = opening_angles(numbers, scene)
    if isinstance(found, str):
        return found
    own, pde = found
    far = "; the edge of a layer comes to it slowly" if scene.base and own < 90 else ""
    return (
        f"theta = {number(own)} degrees in the automaton, {number(pde)} in BCRE, for a thin pulse "
        f"on S = {number(numbers.slope[2])}{far}"
    )


def _expected(
    scene: PlaneScene, numbers: PlaneNumbers, frames: int, without: str
) -> Iterator[Line]:
    for models, which in ((1, "the automaton"), (2, "both models")):
        if models == 1 or not without:
            taken = phrases.size(memory_of(scene, frames, models))
            free = phrases.size(available())
            yield (
                "memory" if models == 1 else "",
                f"about {taken} of {free}, for {frames} frames of {which}",
            )
    steps = _steps(scene, numbers)
    known = "not known: the record of speed has the tilted plane alone"
    if scene.automaton.flow == "tilted":
        known = _time(scene, steps, AUTOMATON)
    yield "time, automaton", f"{known}, {phrases.span_of_steps(*steps)} steps"
    if without:
        yield "time, BCRE", without
        return
    least, most = (
        scene.time.until / _step_of_bcre(scene, R) for R in (numbers.largest_R, numbers.thickest)
    )
    known = _time(scene, (least, most), BCRE)
    yield "time, BCRE", f"{known}, {phrases.span_of_steps(least, most)} steps"
    yield "", "on a processor of the record of speed, were all cells wet; of BCRE the right-hand"
    yield "", "sides alone, with no step taken again; compiling comes on top"


def _steps(scene: PlaneScene, numbers: PlaneNumbers) -> tuple[float, float]:
    """The automaton's, by the step at the start and by that of the thickest layer."""
    least = scene.time.until / numbers.rule.dt
    if scene.time.step != "auto":
        return least, least
    shortest = MARGIN * numbers.wave_step(numbers.thickest)
    return least, max(least, scene.time.until / shortest if shortest > 0 else math.inf)


def _time(scene: PlaneScene, steps: tuple[float, float], model: Model) -> str:
    """Seconds by the cells and steps a second of the record."""
    try:
        slow, fast = _rates_of_automaton() if model is AUTOMATON else _rates_of_bcre()
    except FileNotFoundError as missing:
        return f"not known: {missing}"
    cells = scene.domain.cells * scene.domain.cells_across
    return phrases.span_of_seconds(cells * steps[0] / fast, cells * steps[1] / slow)


def _rates_of_automaton() -> tuple[float, float]:
    """Cell-steps a second of the planes that play at 60 frames a second on one thread."""
    rows = pd.read_csv(record("speed/plane_budget.csv")).query("threads == 1")
    rates = rows["side"] ** 2 * rows["steps_a_frame"] * FRAMES_A_SECOND
    return float(rates.min()), float(rates.max())


def _rates_of_bcre() -> tuple[float, float]:
    """Cell-steps a second, as many evaluations of the right-hand side a step as it has stages."""
    rows = pd.read_csv(record("speed/plane.csv")).set_index("ratio")
    (row,) = (rows.loc[name] for name in rows.index if name.startswith(RIGHT_HAND_SIDE))
    scale = 1e6 / FEHLBERG.weights.size
    return float(row["from"]) * scale, float(row["to"]) * scale
