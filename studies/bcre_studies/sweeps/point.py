"""One point of a sweep: its scene in every model, the observables with their errors, one row.

    <observable>_<model>                the last place of the front, the mean of R
    <observable>_<model>_error          in the same unit, of a model whose grid is refined
    <observable>_<model>_difference     automaton from this model, relative as in every study
    <observable>_verdict                where automaton, BCRE and effective BCRE are all asked for

Models go by the names of their columns in the tables of the studies.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from bcre_pde import Measured
from bcre_studies.comparison.compare import Comparison
from bcre_studies.comparison.error import allowed_error
from bcre_studies.models.registry import AUTOMATON, BCRE, COMPARED, EFFECTIVE, MODELS, Model
from bcre_studies.models.run import Run, frame_times
from bcre_studies.observables import named
from bcre_studies.scenes.scene import Scene
from bcre_studies.sweeps.points import Point
from bcre_studies.sweeps.spec import Spec
from bcre_studies.system import memory

Row = dict[str, Any]


@dataclass(frozen=True)
class MeasurePoint:
    """Measures the points of a sweep: called with one, it returns the point's row."""

    spec: Spec

    def __call__(self, point: Point) -> Row:
        scene = self.spec.base.with_changes(**point)
        with (
            np.errstate(over="raise", divide="raise", invalid="raise"),
            warnings.catch_warnings(action="ignore", category=UserWarning),  # SciPy's, on tolerance
        ):
            for model in self._models:
                adapter = model.adapter()
                needed = adapter.memory(scene, self.spec.frames)
                _require_memory(f"domain.cells = {scene.domain.cells!r}", needed)
                adapter.require_runnable(scene)
            return self._observed(scene)

    def warm(self) -> None:
        """Compile what the points need, on the base scene for a moment of its time."""
        moment = self.spec.base.time.until * 1e-9
        for model in self._models:
            model.run(self.spec.base, [moment])

    def columns(self) -> dict[str, type]:
        """Names and types of what models and observables add to a point."""
        columns: dict[str, type] = {}
        for name in self.spec.observables:
            for model in self._models:
                column = f"{name}_{model.column}"
                columns[column] = float
                if model.adapter().refined:
                    columns[f"{column}_error"] = float
                if model is not AUTOMATON and AUTOMATON in self._models:
                    columns[f"{column}_difference"] = float
            if set(COMPARED) <= set(self._models):
                columns[f"{name}_verdict"] = str
        return columns

    @property
    def _models(self) -> list[Model]:
        """The automaton first: the others are refined until they can be compared with it."""
        return sorted(
            (MODELS[name] for name in self.spec.models), key=lambda model: model is not AUTOMATON
        )

    def _observed(self, scene: Scene) -> Row:
        solved = _Solved(scene, self.spec)
        found = {model: solved.by(model) for model in self._models}
        row: Row = {}
        for index, name in enumerate(self.spec.observables):
            of = {model: found[model][index] for model in found}
            automaton = of.get(AUTOMATON)
            for model, measured in of.items():
                column = f"{name}_{model.column}"
                row[column] = _as_number(name, measured.value)
                if model.adapter().refined:
                    row[f"{column}_error"] = measured.error
                if automaton is not None and model is not AUTOMATON:
                    against = self._comparison(automaton, measured, measured, solved.scales[index])
                    row[f"{column}_difference"] = against.difference
            if automaton is not None and BCRE in of and EFFECTIVE in of:
                compared = self._comparison(
                    automaton, of[BCRE], of[EFFECTIVE], solved.scales[index]
                )
                row[f"{name}_verdict"] = str(compared.verdict)
        return row

    def _comparison(
        self, automaton: Measured, pde: Measured, effective: Measured, scale: float | None
    ) -> Comparison:
        return Comparison(automaton.value, pde, effective, self.spec.tolerance, scale)


class _Solved:
    """The observables of one scene, model after model."""

    def __init__(self, scene: Scene, spec: Spec) -> None:
        self._scene, self._spec = scene, spec
        self._times, self._x = frame_times(scene, spec.frames), scene.centres()
        self._automaton: list[Any] | None = None
        self.scales: list[float | None] = []

    def by(self, model: Model) -> list[Measured]:
        """What the model says, each observable with its error."""
        measured = model.adapter().measured(self._scene, self._times, self._measure, self._allowed)
        if model is AUTOMATON:
            self._automaton = [quantity.value for quantity in measured]
        return measured

    def _measure(self, run: Run) -> list[Any]:
        if self._automaton is None:  # the scales are those of the first model, at its finest
            self.scales = [_scale(name, run) for name in self._spec.observables]
        return [_quantity(name, run, self._x) for name in self._spec.observables]

    def _allowed(self, values: Sequence[Any]) -> list[float]:
        others = values if self._automaton is None else self._automaton
        return [
            allowed_error(other, value, self._spec.tolerance, scale)
            for other, value, scale in zip(others, values, self.scales, strict=True)
        ]


@cache
def _require_memory(what: str, needed: int) -> None:
    """Asked once for each size: the points of a sweep are alike, and the system answers slowly."""
    memory.require(what, needed)


def _quantity(name: str, run: Run, x: Any) -> Any:
    """What is compared: of R the profiles on the automaton's cells, of the front its places."""
    if name == "R":
        return np.array([run.sample(x, frame=frame) for frame in range(run.t.size)])
    if name == "front":
        return named.front(run)
    return named.value(name, run)


def _as_number(name: str, value: Any) -> float:
    if name == "front":
        return float(value[-1])
    return float(np.mean(value))


def _scale(name: str, run: Run) -> float | None:
    """What differences are relative to; None for the mean of the model's own value."""
    return None if name == "R" else named.scale(name, run) or None
