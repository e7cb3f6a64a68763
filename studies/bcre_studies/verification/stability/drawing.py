"""The planes of steps: stable points, predicted boundaries and bounds."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from bcre_studies.models.registry import AUTOMATON, MODELS, Look
from bcre_studies.reporting import style
from bcre_studies.verification.stability.boundaries import POINTS
from bcre_studies.verification.stability.diagram import (
    CLIMB_AND_DRIFT,
    DRIFT_AND_SPREAD,
    VARIANTS,
    Diagram,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LABELS = {
    DRIFT_AND_SPREAD: ("v dt/d", "D dt/d²"),
    CLIMB_AND_DRIFT: ("gamma R dt/d", "v dt/d"),
}


def draw(tables: dict[str, pd.DataFrame]) -> Figure:
    """Measured stable points shaded, the predicted boundary and the model's own bound as lines."""
    table = tables["comparison"]
    figure, axes = style.panels(4, 4)
    for axis, (_, head) in zip(axes, table.iterrows(), strict=True):
        _draw_plane(axis, head, tables)
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(handles))
    return figure


def _draw_plane(axis: Axes, head: pd.Series[Any], tables: dict[str, pd.DataFrame]) -> None:
    def of(name: str) -> pd.DataFrame:
        rows = tables[name]
        return rows[(rows["variant"] == head["variant"]) & (rows["plane"] == head["plane"])]

    variant = next((v for v in VARIANTS if str(v) == head["variant"]), head["variant"])
    width, height = Diagram(head["model"], variant, head["plane"]).limits()
    model = MODELS[head["model"]]
    for row in of("points").itertuples():
        stable_cells = [i for i, mark in enumerate(row.stable) if mark == "1"]
        runs = [(i * width / POINTS, width / POINTS) for i in stable_cells]
        axis.broken_barh(
            _joined(runs),
            (float(row.y) - height / POINTS / 2, height / POINTS),
            color=model.color,
            alpha=0.22,
            linewidth=0,
        )
    rows = of("boundaries")
    angle = np.radians(rows["angle"])
    for column, line in LINES.items():
        x, y = (
            rows[column] * size * part
            for size, part in ((width, np.cos(angle)), (height, np.sin(angle)))
        )
        axis.plot(x, y, **line)
    axis.set(xlim=(0, width), ylim=(0, height))
    x_label, y_label = LABELS[head["plane"]]
    cell = "d" if model is AUTOMATON else "dx"
    axis.set_xlabel(x_label.replace("dt/d", f"dt/{cell}"))
    axis.set_ylabel(y_label.replace("dt/d", f"dt/{cell}"))
    axis.set_title(f"{model.label}, {head['variant']}", loc="left")


LINES: dict[str, Look] = {
    "predicted": {"color": "black", "linewidth": 1.2, "label": "predicted, |G| = 1"},
    "bound": {
        "color": "0.35",
        "linewidth": 1.2,
        "linestyle": (0, (3, 2)),
        "label": "the model's own bound",
    },
    "measured": {
        "color": "#a01c5a",
        "linestyle": "",
        "marker": ".",
        "markersize": 4,
        "label": "measured, by bisection (shaded: stable points)",
    },
}


def _joined(runs: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Neighbouring bars as one."""
    joined: list[tuple[float, float]] = []
    for start, length in runs:
        if joined and abs(sum(joined[-1]) - start) < length / 2:
            joined[-1] = joined[-1][0], joined[-1][1] + length
        else:
            joined.append((start, length))
    return joined
