"""How much of every difference the automaton's cells explain."""

from __future__ import annotations

from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter

from bcre_studies.models.registry import BCRE, EFFECTIVE
from bcre_studies.publishing.pictures.panels import panels
from bcre_studies.publishing.wording import figure_name


def shares(comparison: pd.DataFrame) -> Figure:
    """Every scene's difference as it stands and with both coefficients, by cell length.

    Parameters
    ----------
    comparison: the table of ``modified_equation``.
    """
    table = comparison[comparison["split"] == "space"]
    scenes = list(dict.fromkeys(table["scene"]))
    scenes.sort(key=lambda name: -float(table[table["scene"] == name]["nominal"].iloc[0]))
    figure, (axis,) = panels(1, 1, width=4.7, height=5.4)
    ticks: list[float] = []
    labels: list[str] = []
    y = 0.0
    for scene in scenes:
        rows = table[table["scene"] == scene].sort_values("d", ascending=False)
        axis.annotate(
            figure_name(scene),
            (0, y),
            (-4, 0),
            weight="bold",
            va="center",
            ha="right",
            xycoords=axis.get_yaxis_transform(),
            textcoords="offset points",
        )
        y += 1
        for row in rows.itertuples():
            _share_row(axis, y, row)
            ticks.append(y)
            labels.append(f"d = {row.d:g}")
            y += 1
        y += 0.5
    axis.set(xscale="log", ylim=(y - 0.3, -0.8), xlim=(3e-5, 20))
    axis.set_yticks(ticks, labels)
    axis.tick_params(axis="y", length=0)
    axis.grid(visible=False, axis="y")
    axis.xaxis.set_major_formatter(FuncFormatter(_percentage))
    axis.set_xlabel("difference of the rolling layer R")
    handles = [
        axis.plot([], [], **BCRE.markers(markersize=6), label="from BCRE")[0],
        axis.plot(
            [],
            [],
            marker="^",
            color=EFFECTIVE.color,
            linestyle="",
            markersize=7,
            label="what is left once the cells are counted",
        )[0],
        axis.plot([], [], **BCRE.markers(hollow=True, markersize=6), label="BCRE unresolved")[0],
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=2)
    return figure


def _share_row(axis: Axes, y: float, row: Any) -> None:
    resolved = row.verdict != "unresolved"
    look: dict[str, Any] = {
        "linewidth": 2.2,
        "color": EFFECTIVE.color if resolved else "0.55",
        "alpha": 0.45,
    }
    axis.plot([row.both, row.nominal], [y, y], **look)
    axis.plot(row.nominal, y, **BCRE.markers(hollow=not resolved, markersize=6))
    axis.plot(row.both, y, marker="^", color=EFFECTIVE.color, linestyle="", markersize=7)
    text = f"{100 * row.explained:.0f} % explained" if resolved else "unresolved"
    axis.annotate(
        text,
        (row.nominal, y),
        (9, 0),
        textcoords="offset points",
        va="center",
        fontsize=8.5,
        color="0.25" if resolved else "0.5",
    )


def _percentage(value: float, _: object) -> str:
    return f"{100 * value:g} %" if value <= 1 else ""
