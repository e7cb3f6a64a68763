"""What is advised for random scenes, and what it really does."""

from __future__ import annotations

import numpy as np

from bcre_studies.advisor.deviation import deviation
from bcre_studies.comparison.rounding import significant
from bcre_studies.models.registry import SCHEMES
from bcre_studies.models.run import frame_times
from bcre_studies.performance.advice.truth import (
    FINEST_TRUTH,
    FRAMES,
    OBSERVED,
    TOLERANCE,
    Row,
    Truth,
    advice_on,
    error_of,
    truth,
)
from bcre_studies.performance.random_scenes import kind_of, random_scene
from bcre_studies.scenes.scene import Scene

FEW = 100
"""Cells of the finest pilot of the extrapolated predictions."""


def random_rows(index: int) -> tuple[list[Row], list[Row]]:
    """What is advised for a random scene, and what is extrapolated, with what they really do."""
    scene = random_scene(index)
    true = truth(scene)
    advised = [_advised(index, scene, observable, true) for observable in OBSERVED]
    return advised, _extrapolated(index, scene, true) if true.resolved("R") else []


def _advised(index: int, scene: Scene, observable: str, true: Truth) -> Row:
    """What is advised, and what it really does."""
    advice = advice_on(scene, observable)
    resolved = true.resolved(observable)
    row: Row = {
        "scene": index,
        "kind": kind_of(scene),
        "observable": observable,
        "model": "",
        "cells": 0,
        "predicted_error": np.nan,
        "true_error": np.nan,
        "truth_error": significant(true.error(observable), 1),
        "closed_form_error": np.nan,
        "result": "declined" if resolved else "unresolved",
    }
    if advice.closed is not None:
        form = advice.closed[0].run(scene, frame_times(scene, FRAMES), true.run.x.size)
        row["closed_form_error"] = significant(deviation(form, true.run, observable), 2)
    if not advice.options:
        return row
    best = advice.options[0]
    error = error_of(scene, best.model, best.cells, true, observable)
    row |= {"model": best.model, "cells": best.cells}
    row |= {"predicted_error": significant(best.error, 2), "true_error": significant(error, 2)}
    if resolved:
        row["result"] = "met" if error <= TOLERANCE else "missed"
    return row


def _extrapolated(index: int, scene: Scene, true: Truth) -> list[Row]:
    """Every scheme that is predicted beyond its pilots, with what it really does there."""
    rows = []
    for option in advice_on(scene, "R", finest=FEW).options:
        if option.model in SCHEMES and FEW < option.cells <= FINEST_TRUTH:
            error = error_of(scene, option.model, option.cells, true, "R")
            rows.append(
                {
                    "scene": index,
                    "model": option.model,
                    "cells": option.cells,
                    "predicted_error": significant(option.error, 2),
                    "true_error": significant(error, 2),
                    "result": "met" if error <= TOLERANCE else "missed",
                }
            )
    return rows
