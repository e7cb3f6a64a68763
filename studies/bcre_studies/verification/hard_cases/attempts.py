"""One hard scene in one model: how it ends, with what is known of the end."""

from __future__ import annotations

import math
from typing import Any, NamedTuple, cast, get_args

import numpy as np

import bcre_ca
import bcre_pde
from bcre_ca.rule import Scheme
from bcre_studies.comparison.rounding import significant
from bcre_studies.models.registry import AUTOMATON, BCRE
from bcre_studies.scenes.domain import Array
from bcre_studies.verification.hard_cases.hard_scenes import HardScene, long_run, scenes

SCHEMES: tuple[Scheme, ...] = get_args(Scheme)
SURVIVES, REFUSED, FAILS = "survives", "refused before the start", "fails"
FRAMES = 5
LEAST_MASS_ERROR = 1e-13
"""Smaller values count as equal: rounding differs from processor to processor."""


Row = dict[str, Any]


class Attempt(NamedTuple):
    """A scene in one model; ``scheme`` and ``step`` are the automaton's."""

    scene: str
    model: str
    scheme: Scheme = "upwind"
    step: float | str = "auto"


def attempts(scene: HardScene) -> list[Attempt]:
    automaton = [
        Attempt(scene.name, AUTOMATON.name, s, step) for s in SCHEMES for step in scene.steps
    ]
    return (
        automaton if scene.name == long_run().name else [*automaton, Attempt(scene.name, BCRE.name)]
    )


class Summary(NamedTuple):
    """What is read off a run: of all frames the smallest and the largest R, of the last one h."""

    x: Array
    mass_error: float
    smallest_R: float
    largest_R: float
    h: Array
    lowered: int = 0


def tried(attempt: Attempt) -> Row:
    scene = long_run() if attempt.scene == long_run().name else scenes()[attempt.scene]
    row = {"scene": attempt.scene, "model": attempt.model}
    row |= {"scheme": "", "step": ""}
    if attempt.model == AUTOMATON.name:
        row |= {"scheme": attempt.scheme, "step": str(attempt.step)}
    try:
        with np.errstate(all="ignore"):
            end = _automaton(scene, attempt) if attempt.model == AUTOMATON.name else _pde(scene)
    except (bcre_pde.SolveError, FloatingPointError, ValueError) as failure:
        return row | _refusal(failure)
    verdict = SURVIVES
    if end.lowered:
        verdict += f" with the step lowered {end.lowered} times"
    return row | {
        "verdict": verdict,
        "mass_error_at_most": _decade(end.mass_error),
        "smallest_R": significant(_cut(end.smallest_R, end.largest_R), 1),
        "largest_R": significant(end.largest_R, 3),
        "end_slope": _slope(end),
        "message": "",
    }


def _refusal(failure: Exception) -> Row:
    """What is known of a run without an end; the failure's text says where and by which bound."""
    before = isinstance(failure, ValueError) or getattr(failure, "time", None) == 0
    blank = dict.fromkeys(("mass_error_at_most", "smallest_R", "largest_R", "end_slope"), "")
    return {"verdict": REFUSED if before else FAILS} | blank | {"message": str(failure)}


def _cut(smallest: float, largest: float) -> float:
    """Rounding errors of R are 0."""
    return 0.0 if abs(smallest) < 1e-12 * largest else smallest


def _decade(error: float) -> float:
    """The power of ten above; its digits are those of rounding errors."""
    return float(f"1e{math.ceil(math.log10(max(error, LEAST_MASS_ERROR)))}")


def _slope(end: Summary) -> float | str:
    if end.x.size < 2:
        return ""
    return round(float(-np.polyfit(end.x, end.h, 1)[0]), 3) + 0.0


def rule_for(scene: HardScene, scheme: Scheme) -> bcre_ca.Rule:
    """The scene's automaton with dt = 1; the step is chosen by :func:`bcre_ca.frames`."""
    m = scene.problem.material
    return bcre_ca.Rule(m.v, m.D, m.gamma, m.Sc, scene.d, 1.0, scheme=scheme, kappa=m.kappa)


def _automaton(scene: HardScene, attempt: Attempt) -> Summary:
    rule, x = rule_for(scene, attempt.scheme), scene.centres()
    start = bcre_ca.Pile(*scene.problem.initial(x))
    times = [scene.until * (part + 1) / FRAMES for part in range(FRAMES)]
    step = cast("Any", attempt.step)
    piles = [start, *bcre_ca.frames(start, rule, times, scene.problem.ends, step)]
    end = piles[-1]
    balance = abs(end.mass(rule.d) + end.outflow - start.mass(rule.d))
    return Summary(
        x,
        balance / _sand(start.h, start.R, rule.d),
        min(float(pile.R.min()) for pile in piles),
        max(float(pile.R.max()) for pile in piles),
        end.h,
        end.lowered,
    )


def _sand(h: Array, R: Array, d: float) -> float:
    return d * float(np.abs(h).sum() + R.sum())


def _pde(scene: HardScene) -> Summary:
    times = [scene.until * part / FRAMES for part in range(FRAMES + 1)]
    end = bcre_pde.solve(scene.problem, times, scene.cells)
    mass = end.mass()
    balance = abs(mass[-1] + end.outflow[-1] - mass[0])
    return Summary(
        end.x,
        balance / _sand(end.h[0], end.R[0], end.dx),
        float(end.R.min()),
        float(end.R.max()),
        end.h[-1],
    )
