"""The four observations in one model after another, and the words that follow from the numbers."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from bcre_studies.comparison.rounding import significant
from bcre_studies.models.registry import (
    ARADIAN,
    AUTOMATON,
    BCRE,
    HADELER_KUTTLER,
    HEIGHT_ONLY,
    HWA_KARDAR,
    QUASI_STATIC,
    SLOPE_DRIVEN_AUTOMATON,
    THICK_AUTOMATON,
    Model,
)
from bcre_studies.models.run import Run
from bcre_studies.observables.outcome import FALLEN, reached_the_top, slope
from bcre_studies.scenes.scene import Scene, load

Row = dict[str, Any]

STEEP, GENTLE = 3.2, 0.5
PULSES = (1e-6, 1.0, 10.0)
UNTIL, LONGEST, FRAMES = 2000.0, 6000.0, 31
EXCESSES = tuple(round(0.1 * k, 1) for k in range(1, 41))
"""Slopes S0 - Sc on which a pulse is tried."""

CELLS, WAVE_CELLS = 200, 400
"""Grids of the models that solve equations; the rough slope asks for the finer one."""

CHANGED = 0.01
AT_REPOSE = 0.05
SMOOTHED = 0.95

ALWAYS, AFTER, NEVER = "always", "after a run to the top", "no"
YES, NO = "yes", "no"
FRONT, WET, WHOLE = "a front, above Sd", "only where it is wet", "the whole slope at once"

RULES = (AUTOMATON, THICK_AUTOMATON, SLOPE_DRIVEN_AUTOMATON, HEIGHT_ONLY, QUASI_STATIC)


@dataclass(frozen=True)
class Subject:
    """A model, with what is changed in every scene for it.

    Parameters
    ----------
    closure: the model of the rolling layer that it is, or whose automaton it is.
    """

    name: str
    model: Model
    closure: str = ""
    changes: Mapping[str, Any] = field(default_factory=dict)

    @property
    def is_rule(self) -> bool:
        """Whether it runs on the cells of the scene itself."""
        return self.model in RULES

    def run(self, scene: Scene, times: list[float], cells: int = CELLS, **options: Any) -> Run:
        """The scene in this model; ``cells`` for one that solves an equation."""
        changed = scene.with_changes(**self.changes) if self.changes else scene
        return self.model.run(changed, times, None if self.is_rule else cells, **options)


NO_D = {"D": 0.0}
SUBJECTS = (
    Subject("height alone (Bak et al.)", HEIGHT_ONLY),
    Subject("Hwa-Kardar", HWA_KARDAR),
    Subject("Prigozhin-Zaltzman", QUASI_STATIC),
    Subject("de Gennes 1995 (D = 0)", BCRE, "D = 0", NO_D),
    Subject("BCRE", BCRE, "BCRE"),
    Subject("Aradian et al.", ARADIAN, "Aradian"),
    Subject("Hadeler-Kuttler", HADELER_KUTTLER, "Hadeler-Kuttler"),
    Subject("automaton, D = 0", AUTOMATON, "D = 0", NO_D),
    Subject("automaton", AUTOMATON, "BCRE"),
    Subject("automaton of Aradian et al.", THICK_AUTOMATON, "Aradian"),
    Subject(
        "automaton of Hadeler-Kuttler", SLOPE_DRIVEN_AUTOMATON, "Hadeler-Kuttler", {"step": "auto"}
    ),
)
"""One-layer models, two-layer models and, in the same order, their automata."""


def pulse_scene(excess: float, pulse: float, until: float) -> Scene:
    """Figure 1 on a slope Sc + excess with a pulse of this height."""
    return load("figure1").with_changes(
        **{"until": until, "surface.0.slope": 0.5 + excess, "rolling.0.amplitude": pulse},
        **{"solver.tolerance": 1e-4},
    )


def final_slope(subject: Subject, excess: float, pulse: float) -> float:
    """S - Sc at t = 2000."""
    scene = pulse_scene(excess, pulse, UNTIL)
    run = subject.run(scene, [0.0, UNTIL])
    return slope(run.x, run.h[-1]) - scene.material.Sc


def climbs(
    subject: Subject,
    excess: float,
    pulse: float,
    cells: int | None = None,
    until: float = LONGEST,
    fallen: float = FALLEN,
) -> bool:
    """Whether the top comes down by ``until``: loses the part ``fallen`` of its excess height.

    Parameters
    ----------
    cells: of a rule or an equation; left out, those of the figure, or :data:`CELLS`.
    """

    def is_down(run: Run) -> bool:
        return reached_the_top(run.x, run.u[0], run.u[-1], fallen=fallen)

    def over(run: Run) -> bool:
        return is_down(run) or (run.t[-1] > 0 and run.R[0].any() and not run.R[-1].any())

    times = [float(t) for t in np.linspace(0.0, until, FRAMES)]
    scene = pulse_scene(excess, pulse, until)
    if cells is not None:
        scene = scene.with_changes(cells=cells)
    return is_down(subject.run(scene, times, cells or CELLS, stop=over))


def least_excesses(subject: Subject) -> list[float]:
    """The gentlest of the slopes that each pulse brings down; infinite where it brings down none.

    Steeper slopes than one that comes down are taken to come down too, and so are slopes under
    thicker pulses where the gentlest comes down under the thinnest.
    """
    if climbs(subject, EXCESSES[0], PULSES[0]):
        return [EXCESSES[0]] * len(PULSES)
    return [_least(subject, pulse) for pulse in PULSES]


def _least(subject: Subject, pulse: float) -> float:
    low, high = -1, len(EXCESSES)
    while high - low > 1:
        middle = (low + high) // 2
        if climbs(subject, EXCESSES[middle], pulse):
            high = middle
        else:
            low = middle
    return EXCESSES[high] if high < len(EXCESSES) else math.inf


def roughness(subject: Subject) -> float:
    """RMS of u at the end of rough_slope, relative to the start."""
    scene = load("rough_slope")
    run = subject.run(scene, [0.0, scene.time.until], WAVE_CELLS)
    return float(np.std(run.u[-1]) / np.std(run.u[0]))


def reach(subject: Subject) -> float:
    """How far above the pulse's centre figure 3's surface changes by 1 % of the most."""
    scene = load("figure3")
    x, (_, R) = scene.centres(), scene.initial(scene.centres())
    run = subject.run(scene, [0.0, scene.time.until])
    change = np.abs(run.h[-1] - run.h[0])
    return float(R @ x / R.sum()) - float(run.x[change >= CHANGED * change.max()][0])


def properties(number: int) -> Row:
    """The row of one of :data:`SUBJECTS`: the words, and the numbers that decide."""
    subject = SUBJECTS[number]
    numbers = {
        "undisturbed": final_slope(subject, STEEP, 0.0),
        "after a pulse": final_slope(subject, STEEP, 1.0),
        "gentle": final_slope(subject, GENTLE, 1.0),
        **{
            f"least, pulse {pulse:g}": least
            for pulse, least in zip(PULSES, least_excesses(subject), strict=True)
        },
        "roughness left": roughness(subject),
        "reach uphill": reach(subject),
    }
    rounded = {name: significant(round(value, 4) + 0.0, 3) for name, value in numbers.items()}
    return {"model": subject.name} | words(rounded) | rounded


def words(row: Row) -> Row:
    """What the numbers say."""
    moves_alone = abs(row["undisturbed"]) <= AT_REPOSE * STEEP
    returns = ALWAYS if moves_alone and abs(row["gentle"]) <= AT_REPOSE * GENTLE else NEVER
    if not moves_alone and abs(row["after a pulse"]) <= AT_REPOSE * STEEP:
        returns = AFTER
    vanishing = row[f"least, pulse {PULSES[0]:g}"]
    has_second = not moves_alone and math.isfinite(vanishing)
    return {
        "returns to Sc": returns,
        "smooths": YES if row["roughness left"] < SMOOTHED else NO,
        "goes uphill": WHOLE if moves_alone else FRONT if has_second else WET,
        "second critical slope": YES if has_second else NO,
    }


WORDS = ("returns to Sc", "smooths", "goes uphill", "second critical slope")
