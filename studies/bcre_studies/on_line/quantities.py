"""What the models say of a scene, how far apart they are, and how sure BCRE's number is.

    apart = |q_ca - q_pde|       error = that of q_pde by its own grids (bcre_pde.convergence)

Of the layers R and h the mean over all frames and cells counts, relative to the mean layer R, and
to the mean change of h since the start.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

import bcre_pde
from bcre_pde.convergence import changes
from bcre_studies.comparison.difference import relative_difference
from bcre_studies.models.run import Run
from bcre_studies.observables import named
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.scene import Scene

LEAST_CELLS = 8
"""Fewer cells have no slope over their middle half, and no edges."""

PLACES = FRONT, REACH = "front of R at the end, x", "reach uphill of the pulse"
"""Where a profile passes a level; known to half a cell at best, because the profile is."""

LAYER, LARGEST, LEFT = "R, mean", "largest R", "area of R left at the end"
OF_LAYER = LAYER, LARGEST, LEFT, FRONT

Measure = Callable[[Run], float]


@dataclass(frozen=True)
class Quantity:
    """A number in every model, with its unit.

    Parameters
    ----------
    values: by the model's name.
    apart: of two models; relative where ``is_relative``, else in the unit of the values.
    error: BCRE's own, as ``apart``; infinite where it is not known, NaN without BCRE.
    """

    name: str
    unit: str
    values: dict[str, float]
    apart: float = math.nan
    error: float = math.nan
    is_relative: bool = True


def quantities(runs: Sequence[Run]) -> list[Quantity]:
    """What is said of one run or two of the same scene, the layers first.

    A model without a rolling layer has none of its numbers.
    """
    measures = _measures(runs[0].scene, min(run.x.size for run in runs))
    numbers = [_number(runs, *parts) for parts in measures]
    found = [*(_layer(runs, field) for field in "Rh"), *numbers]
    has_layer = any(run.R.any() for run in runs)
    return [quantity for quantity in found if has_layer or quantity.name not in OF_LAYER]


def _measures(scene: Scene, cells: int) -> list[tuple[str, str, Measure, bool]]:
    """Name, unit, function, and whether differences are relative to the value."""
    length = scene.units.length if scene.units else ""
    area = f"{length}^2" if length else ""
    measures: list[tuple[str, str, Measure, bool]] = [
        (LARGEST, length, lambda run: float(run.R.max()), True),
        (LEFT, area, lambda run: run.d * float(run.R[-1].sum()), False),
    ]
    if scene.domain.ends != "periodic":
        measures.append(("area out through the foot", area, _out, False))
    measures.append(("area eroded", area, named.eroded, False))
    if cells >= LEAST_CELLS:
        measures.append(("slope S at the end", "", named.slope, False))
        if "front" in named.posed(scene):
            measures.append((FRONT, length, _front, False))
            if scene.initial(scene.centres())[1].any():  # else there is no pulse to reach from
                measures.append((REACH, length, named.reach, False))
    return measures


def _out(run: Run) -> float:
    return float(run.outflow[-1])


def _front(run: Run) -> float:
    return named.value("front", run)


def _number(
    runs: Sequence[Run], name: str, unit: str, measure: Measure, is_relative: bool
) -> Quantity:
    values = {run.model: measure(run) for run in runs}
    last = runs[-1]
    error = _error([measure(run) for run in (*last.coarser, last)], last)
    if name in PLACES and not math.isnan(error):
        error = max(error, last.d / 2)
    apart = math.nan
    if len(runs) == 2:
        one, other = values.values()
        apart = relative_difference(one, other) if is_relative else abs(one - other)
    if is_relative and values[last.model]:
        error /= abs(values[last.model])
    return Quantity(name, unit, values, apart, error, is_relative)


def _error(on_grids: list[float], run: Run) -> float:
    """Error of the last value; NaN in a model that is not refined."""
    if not run.coarser:
        return math.nan if "error_estimate" not in run.facts else math.inf
    jump = bcre_pde.jump_stands(run.coarser[-1], run)
    return bcre_pde.error_of_finest(changes(on_grids), jump=jump).error


def _layer(runs: Sequence[Run], field: str) -> Quantity:
    """Mean of R over all frames, or mean change of h since the start."""
    unit = runs[0].units["h"] if runs[0].scene.units else ""
    name = LAYER if field == "R" else "change of h, mean"
    last = runs[-1]
    x = runs[0].x
    profiles = [_profile(run, field, x) for run in runs]
    values = {run.model: float(np.abs(p).mean()) for run, p in zip(runs, profiles, strict=True)}
    apart = relative_difference(profiles[0], profiles[1]) if len(runs) == 2 else math.nan
    key = "error_estimate" if field == "R" else "error_estimate_h"
    error = last.facts.get(key, math.nan)
    error = math.inf if error is None else error
    if field == "h":  # which the facts hold relative to R
        size = values[last.model]
        error = error * float(np.abs(last.R).mean() or 1.0) / size if size > 0 else math.inf
    return Quantity(name, unit, values, apart, float(error))


def _profile(run: Run, field: str, x: Array) -> Array:
    """R, or what u has changed by, in every frame at positions x."""
    name = "R" if field == "R" else "u"
    rows = np.array([run.sample(x, name, frame) for frame in range(run.t.size)])
    return rows if field == "R" else rows - rows[0]
