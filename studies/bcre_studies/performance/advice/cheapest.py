"""Which model is really the cheapest that meets the tolerance, and what was advised."""

from __future__ import annotations

from bcre_studies.advisor.deviation import deviation
from bcre_studies.advisor.pilot import run_model
from bcre_studies.comparison.rounding import significant
from bcre_studies.models.registry import CANDIDATES
from bcre_studies.models.run import frame_times
from bcre_studies.performance.advice.truth import FRAMES, TOLERANCE, Row, Truth, advice_on, truth
from bcre_studies.scenes.scene import Scene, SceneError, load
from bcre_studies.timing.costs import closures_of, recorded

OWN = "two_pulses"
LADDER = {
    model: [round(25 * 2 ** (k / 4)) for k in range(steps)]
    for model, steps in zip(CANDIDATES, (33, 25, 21, 17), strict=True)
}
"""Cells tried of every model to find its cheapest: up to 6400, 1600, 800 and 400."""


def own_scene() -> Scene:
    """A heap that is neither built in nor drawn: two pulses on a wavy slope above repose."""
    return Scene.model_validate(
        {
            "title": "Two pulses on a wavy slope above repose, with curvature",
            "material": {"v": 0.8, "D": 0.15, "gamma": 0.04, "kappa": 0.02, "Sc": 0.6},
            "domain": {"length": 60.0, "cells": 120, "ends": "open"},
            "time": {"until": 25.0},
            "surface": [
                {"kind": "incline", "slope": 0.75},
                {"kind": "sine", "amplitude": 0.05, "wavelength": 12.0},
            ],
            "rolling": [
                {"kind": "gaussian", "amplitude": 0.5, "centre": 12.0, "width": 2.5},
                {"kind": "gaussian", "amplitude": 0.2, "centre": 30.0, "width": 4.0},
            ],
        }
    )


def compared(name: str) -> list[Row]:
    """Every model on finer and finer grids of a scene, and what was advised."""
    scene = own_scene() if name == OWN else load(name)
    true = truth(scene)
    if not true.resolved("R"):
        return [_unjudged(name, scene)]
    cheapest = [(model, *found) for model in CANDIDATES if (found := _least(scene, model, true))]
    best = advice_on(scene, "R").options[0]
    advised = run_model(scene, best.model, frame_times(scene, FRAMES), best.cells)
    error = deviation(advised, true.run)
    priced = sorted((_price(scene, *found), *found[:2]) for found in cheapest)
    bare = min(_price(scene, *found, frames=0) for found in cheapest)
    chosen = best.model, best.cells, advised.steps
    return [
        {
            "scene": name,
            "advised": best.model,
            "cells": best.cells,
            "true_error": significant(error, 2),
            "cheapest": priced[0][1],
            "cheapest_cells": priced[0][2],
            "dearer": significant(_price(scene, *chosen) / priced[0][0], 2),
            "dearer_in_steps": significant(_price(scene, *chosen, frames=0) / bare, 2),
            **{f"{model}_cells": cells for model, cells, _ in cheapest},
            "result": "met" if error <= TOLERANCE else "missed",
        }
    ]


def _price(scene: Scene, model: str, cells: int, steps: float, frames: int = FRAMES - 1) -> float:
    """Seconds by the recorded costs; without frames, those of the steps alone."""
    return recorded().seconds(model, cells, steps, closures_of(scene), frames)


def _unjudged(name: str, scene: Scene) -> Row:
    """A scene without a converged solution; the advice should say so too."""
    advice = advice_on(scene, "R")
    return {"scene": name, "result": "unresolved" if not advice.options else "not said"}


def _least(scene: Scene, model: str, true: Truth) -> tuple[int, int] | None:
    """Fewest cells of :data:`LADDER` from which on the model meets the tolerance, and its steps."""
    found = None
    for cells in reversed(LADDER[model]):
        try:
            run = run_model(scene, model, frame_times(scene, FRAMES), cells)
        except SceneError:  # cells that cannot hold the start
            break
        if deviation(run, true.run) > TOLERANCE:
            break
        found = cells, run.steps
    return found
