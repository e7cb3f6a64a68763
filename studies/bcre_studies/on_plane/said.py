"""A run on a plane in words: volumes, layers and areas in every model, and how far apart."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from bcre_studies.comparison.difference import relative_difference
from bcre_studies.comparison.rounding import significant
from bcre_studies.models.plane.run import PlaneRun
from bcre_studies.models.registry import MODELS
from bcre_studies.running.columns import BOLD, add_effort, headed
from bcre_studies.system.one_line import one_line

MOVED = 1e-3
"""A cell has moved where h changed by more than this part of its largest change."""

DIGITS = 4


@dataclass(frozen=True)
class Quantity:
    """A number of a run: ``power`` of its unit of length."""

    name: str
    power: int
    of: Callable[[PlaneRun], float]


def _area(run: PlaneRun) -> float:
    return run.scene.domain.d**2


def _changes(run: PlaneRun) -> Any:
    return run.h[-1] - run.h[0]


def _moved(run: PlaneRun) -> float:
    size = np.abs(_changes(run))
    return _area(run) * int((size > MOVED * size.max(initial=0.0)).sum())


QUANTITIES = (
    Quantity("largest R", 1, lambda run: float(run.R.max())),
    Quantity("volume of R at the start", 3, lambda run: _area(run) * float(run.R[0].sum())),
    Quantity("volume of R left at the end", 3, lambda run: _area(run) * float(run.R[-1].sum())),
    Quantity("volume poured", 3, lambda run: float(run.inflow[-1])),
    Quantity("volume out through the foot", 3, lambda run: float(run.outflow[-1])),
    Quantity(
        "volume eroded", 3, lambda run: _area(run) * float(np.maximum(-_changes(run), 0).sum())
    ),
    Quantity(
        "volume laid down", 3, lambda run: _area(run) * float(np.maximum(_changes(run), 0).sum())
    ),
    Quantity("area on which h changed", 2, _moved),
)


def said(runs: Sequence[PlaneRun]) -> Iterator[RenderableType]:
    """Title, table, and how far apart the rolling layers are at the end."""
    scene, t = runs[0].scene, runs[0].t
    yield Text(one_line(scene.title), style="bold")
    yield Text(f"t = {t[0]:g} to {t[-1]:g} {scene.units.time}, {t.size} frames\n")
    yield table(runs)
    if len(runs) == 2:
        one, other = (MODELS[run.model].text for run in runs)
        apart = _percent(relative_difference(runs[0].R[-1], runs[1].R[-1]))
        yield Text(
            f"\nR of the {one} at the end is {apart} from that of {other}, on one grid, whose own "
            "error is not measured here."
        )


def table(runs: Sequence[PlaneRun]) -> Table:
    """A row for each quantity, and what the run took."""
    heads = [MODELS[run.model].text for run in runs]
    shown = headed([*heads, BOLD] if len(runs) == 2 else heads)
    unit = runs[0].scene.units.length
    for quantity in QUANTITIES:
        values = [quantity.of(run) for run in runs]
        cells = [f"{significant(value, DIGITS):g}" for value in values]
        if len(runs) == 2:
            cells.append(_percent(relative_difference(*values)))
        power = f"^{quantity.power}" if quantity.power > 1 else ""
        shown.add_row(Text(f"{quantity.name} ({unit}{power})"), *cells)
    shown.add_row("cells", *(" x ".join(map(str, run.scene.domain.shape)) for run in runs))
    add_effort(shown, runs)
    return shown


def _percent(share: float) -> str:
    return f"{significant(100 * share, 2):g} %" if math.isfinite(share) else ""


def record(runs: Sequence[PlaneRun]) -> list[dict[str, Any]]:
    """The quantities for machines."""
    unit = runs[0].scene.units.length
    return [
        {
            "quantity": quantity.name,
            "unit": unit if quantity.power == 1 else f"{unit}^{quantity.power}",
            **{run.model: quantity.of(run) for run in runs},
        }
        for quantity in QUANTITIES
    ]
