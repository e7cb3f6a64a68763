"""What a run costs: seconds by model, closures, cells and steps.

    seconds = frames * frame_s + cells * steps * s(model, closures, cells)

``frame_s`` is what every recorded time takes besides its steps, the same for all schemes; s, the
seconds a cell and step, is interpolated between the measured numbers of cells, log in log, and
constant beyond them. A step of the PDE is one of its Runge-Kutta steps, six evaluations of the
right-hand side. All cells are wet: the automaton passes over dry ones, so that a narrow pulse costs
less than is said here.

A machine of its own has costs of its own: :func:`measure` takes them here, :func:`recorded` reads
those of the committed record, by which a table that rests on costs is the same everywhere.
"""

from __future__ import annotations

import itertools
import math
import statistics
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
import pandas as pd

from bcre_studies.comparison.rounding import significant
from bcre_studies.models.registry import AUTOMATON, BCRE, CANDIDATES, SCHEMES
from bcre_studies.models.run import frame_times
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.scene import Scene
from bcre_studies.system.records import record
from bcre_studies.timing.clock import Call, interleaved

CLOSURES = ("none", "kappa", "v_up", "kappa v_up")
"""What the exchange has beyond gamma R (S - Sc)."""

CELLS = (50, 800, 12_800)
"""Where the cost of a cell and step is measured."""

CELL_STEPS = dict(zip(CANDIDATES, (2e6, 2e6, 5e5, 6e4), strict=True))
"""Cell-steps of a measured run: some milliseconds."""

FRAMES = 40
"""Frames of the run that measures the cost of a frame, one step each."""

COURANT = 0.1
"""Of the measured runs: well below every bound."""

READS = "speed/costs.csv"


@dataclass(frozen=True)
class Costs:
    """A table of costs: columns model, closures, cells, cell_step_s and frame_s."""

    table: pd.DataFrame

    def seconds(
        self, model: str, cells: int, steps: float, closures: str = "none", frames: int = 1
    ) -> float:
        """Seconds of a run.

        Parameters
        ----------
        model, closures: one of ``registry.CANDIDATES`` and one of :data:`CLOSURES`.
        cells, steps: of the run; frames: recorded times after the start.

        Raises
        ------
        ValueError
            for a model or closures that the table does not have.
        """
        try:
            grids, rates, frame_s = self._rows[model, closures]
        except KeyError:
            raise ValueError(
                f"model = {model!r}, closures = {closures!r}: must be one of "
                f"{(*CANDIDATES,)} and one of "
                f"{CLOSURES}"
            ) from None
        rate = float(np.exp(np.interp(np.log(cells), grids, rates)))
        return frames * frame_s + cells * steps * rate

    @cached_property
    def _rows(self) -> dict[tuple[str, str], tuple[Array, Array, float]]:
        """By model and closures: logarithms of cells and of seconds a cell and step; frame_s."""
        return {
            key: (
                np.log(rows["cells"].to_numpy(float)),
                np.log(rows["cell_step_s"].to_numpy()),
                float(rows["frame_s"].iloc[0]),
            )
            for key, rows in self.table.groupby(["model", "closures"])
        }


def closures_of(scene: Scene) -> str:
    """Which of :data:`CLOSURES` the material of a scene has."""
    material = scene.material
    present = [
        name
        for name, there in (("kappa", material.kappa > 0), ("v_up", material.v_up is not None))
        if there
    ]
    return " ".join(present) or "none"


def recorded() -> Costs:
    """The costs of the committed record.

    Raises
    ------
    FileNotFoundError
        where there is no record.
    """
    return Costs(pd.read_csv(record(READS)))


def measure() -> pd.DataFrame:
    """Costs on this machine, all runs taking turns: about ten seconds once all is compiled."""
    runs = {case: _run(*case) for case in itertools.product(CANDIDATES, CLOSURES, CELLS)}
    frames = {(model, "frame", CELLS[0]): _frames(model) for model in CANDIDATES}
    named = {" ".join(map(str, key)): call for key, (call, _) in (runs | frames).items()}
    times = interleaved(named).set_index("name")["median_s"]
    per_frame = {model: times[f"{model} frame {CELLS[0]}"] / FRAMES for model in CANDIDATES}
    schemes = statistics.median(per_frame[model] for model in SCHEMES)  # they share that code
    rows = []
    for (model, closures, cells), (_, steps) in runs.items():
        frame_s = schemes if model in SCHEMES else per_frame[model]
        taken = max(times[f"{model} {closures} {cells}"] - frame_s, 1e-9)
        rows.append((model, closures, cells, taken / (cells * steps), frame_s))
    table = pd.DataFrame(rows, columns=["model", "closures", "cells", "cell_step_s", "frame_s"])
    for column in ("cell_step_s", "frame_s"):
        table[column] = [significant(value, 3) for value in table[column]]
    return table


def _run(model: str, closures: str, cells: int) -> tuple[Call, int]:
    """A run of one frame, and how many steps it takes."""
    return _call(model, _scene(model, closures, cells), CELL_STEPS[model] / cells, 1)


def _frames(model: str) -> tuple[Call, int]:
    return _call(model, _scene(model, "none", CELLS[0]), FRAMES, FRAMES)


def _call(model: str, scene: Scene, steps: float, frames: int) -> tuple[Call, int]:
    step = COURANT * scene.d / scene.material.v
    scene = scene.with_changes(until=math.ceil(steps) * step)
    times = frame_times(scene, frames + 1)[1:]
    if model in SCHEMES:
        return partial(AUTOMATON.run, scene.with_changes(step=step), times), math.ceil(steps)
    call = partial(BCRE.run, scene, times, scene.domain.cells)
    return call, call().steps


def _scene(model: str, closures: str, cells: int) -> Scene:
    """Waves at repose under an even layer, on cells of d = 1: all is wet, nothing grows."""
    material = {"v": 1.0, "D": 0.1, "gamma": 0.1, "Sc": 0.5}
    material |= {"kappa": 0.01} if "kappa" in closures else {}
    material |= {"v_up": 1.0} if "v_up" in closures else {}
    scheme = {"automaton": {"scheme": model}} if model in SCHEMES else {}
    return Scene.model_validate(
        {
            "title": "Waves under an even layer",
            "material": material,
            "domain": {"length": float(cells), "cells": cells, "ends": "open"},
            "time": {"until": 1.0},
            "surface": [
                {"kind": "incline", "slope": 0.5},
                {"kind": "sine", "amplitude": 0.1, "wavelength": cells / 4},
            ],
            "rolling": [{"kind": "uniform", "amplitude": 1.0}],
            **scheme,
        }
    )
