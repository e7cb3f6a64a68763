"""One picture: models down, properties across, in each cell the word and the number behind it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from bcre_studies.validation.which_model.properties import (
    AFTER,
    ALWAYS,
    FRONT,
    PULSES,
    SUBJECTS,
    WHOLE,
    YES,
)

HAS, PARTLY, LACKS = "#cfe8d5", "#fbeecb", "#f4d6d2"
VANISHING, SMALL, LARGE = (f"least, pulse {pulse:g}" for pulse in PULSES)
HEADS = (
    "returns to $S_c$",
    "smooths",
    "goes uphill",
    "second critical slope",
    "a pulse of 1; of 10",
)

Cell = tuple[str, str, str]
"""Colour, word and number."""


def _slope(value: float) -> str:
    return f"{value:g}" if math.isfinite(value) else "none"


def _end(value: float) -> str:
    return f"{value + 0.0:.2g}" if abs(value) >= 0.01 else "0"


def _returns(row: Any) -> Cell:
    word = row["returns to Sc"]
    colour = {ALWAYS: HAS, AFTER: PARTLY}.get(word, LACKS)
    return colour, word, f"3.2 to {_end(row['after a pulse'])}, alone {_end(row['undisturbed'])}"


def _smooths(row: Any) -> Cell:
    colour = HAS if row["smooths"] == YES else LACKS
    return colour, row["smooths"], f"{row['roughness left']:.0%} left"


def _uphill(row: Any) -> Cell:
    word = row["goes uphill"]
    colour = HAS if word in (FRONT, WHOLE) else PARTLY
    return colour, word, f"reach {row['reach uphill']:g}"


def _second(row: Any) -> Cell:
    has = row["second critical slope"] == YES
    number = f"$S_0 - S_c$ from {_slope(row[VANISHING])} on" if has else ""
    return (HAS if has else LACKS), row["second critical slope"], number


def _pulses(row: Any) -> Cell:
    if row["goes uphill"] == WHOLE:
        return HAS, "any slope", "needs no pulse"
    small, large = row[SMALL], row[LARGE]
    if not (math.isfinite(small) or math.isfinite(large)):
        return LACKS, "never brings the top down", ""
    return PARTLY, "brings the top down", f"$S_0 - S_c$ from {_slope(small)}; {_slope(large)} on"


CELLS: tuple[Callable[[Any], Cell], ...] = (_returns, _smooths, _uphill, _second, _pulses)


def draw_table(table: pd.DataFrame) -> Figure:
    """The table as a figure."""
    rows = table.set_index("model")
    figure = Figure(figsize=(11.0, 0.5 * len(rows) + 1.2), layout="constrained")
    axis = figure.subplots()
    for column, head in enumerate(HEADS):
        axis.text(column + 0.5, -0.25, head, ha="center", va="bottom", weight="bold")
    for line, subject in enumerate(SUBJECTS):
        axis.text(-0.04, line + 0.5, subject.name, ha="right", va="center")
        for column, cell in enumerate(CELLS):
            _put(axis, column, line, cell(rows.loc[subject.name]))
    for line in _breaks():
        axis.axhline(line, color="k", linewidth=1.2)
    axis.set(xlim=(-1.1, len(HEADS)), ylim=(len(rows), -0.6))
    axis.set_axis_off()
    return figure


def _put(axis: Axes, column: int, line: int, cell: Cell) -> None:
    colour, word, number = cell
    axis.add_patch(Rectangle((column, line), 1, 1, facecolor=colour, edgecolor="w", linewidth=2))
    low = 0.36 if number else 0.5
    axis.text(column + 0.5, line + low, word, ha="center", va="center")
    axis.text(column + 0.5, line + 0.72, number, ha="center", va="center", size=7, color="0.3")


def _breaks() -> list[int]:
    """Above the first two-layer model and above the first automaton."""
    two = next(i for i, subject in enumerate(SUBJECTS) if subject.closure)
    rule = next(i for i, subject in enumerate(SUBJECTS) if subject.closure and subject.is_rule)
    return [two, rule]
