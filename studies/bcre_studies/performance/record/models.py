"""What each model costs on figure 1: seconds per simulated time, on equal cells, in turns."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from typing import Any

import pandas as pd

from bcre_studies.models.registry import AUTOMATON, EFFECTIVE, MODELS, Model
from bcre_studies.scenes.scene import Scene, load
from bcre_studies.timing.clock import LEAST_ROUNDS, LEAST_S

CELLS = (100, 400)
ROUNDS = 7
COMPARED = tuple(model for model in MODELS.values() if model is not EFFECTIVE)
"""BCRE with other coefficients costs what BCRE costs."""


def measure(cells: Sequence[int] = CELLS, rounds: int = ROUNDS) -> pd.DataFrame:
    """The solve alone, from t = 0 to the end of the scene, as ``bcre run`` counts it.

    Every model runs once before, so that no round contains compiling, and takes the longest step
    that is stable. One step of the quasi-static limit spans the whole time.

    Returns
    -------
    One row per model and number of cells: seconds per simulated time as the median over the rounds,
    and the ratio to the automaton as median, smallest and largest by round.
    """
    rounds = max(rounds, LEAST_ROUNDS)
    return pd.DataFrame([row for n in cells for row in _on_cells(n, rounds)])


def _on_cells(cells: int, rounds: int) -> list[dict[str, Any]]:
    scene = load("figure1").with_changes(cells=cells)
    first = {model.name: _run(model, scene, cells) for model in COMPARED}
    repeats = {
        name: max(int(LEAST_S / max(_run(MODELS[name], scene, cells)[0], 1e-6)), 1)
        for name in first
    }
    taken = [
        {
            name: statistics.mean(_run(MODELS[name], scene, cells)[0] for _ in range(repeats[name]))
            for name in first
        }
        for _ in range(rounds)
    ]
    return [
        {
            "model": MODELS[name].text,
            "cells": cells,
            "steps": steps,
            "seconds_per_time": statistics.median(one[name] for one in taken) / scene.time.until,
            **_ratio([one[name] / one[AUTOMATON.name] for one in taken]),
            "rounds": rounds,
        }
        for name, (_, steps) in first.items()
    ]


def _ratio(ratios: Sequence[float]) -> dict[str, float]:
    return {
        "to_automaton": statistics.median(ratios),
        "smallest": min(ratios),
        "largest": max(ratios),
    }


def _run(model: Model, scene: Scene, cells: int) -> tuple[float, int]:
    """Seconds and steps of one run."""
    run = model.run(scene, [0.0, scene.time.until], cells)
    return run.wall_s, run.steps
