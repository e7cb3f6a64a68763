"""Figure 2's rolling layer in both models."""

from __future__ import annotations

from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from bcre_studies.models.registry import AUTOMATON, BCRE, COMPARED, EFFECTIVE
from bcre_studies.publishing.pictures.panels import panels
from bcre_studies.reporting import style


def answer(profiles: pd.DataFrame, figure_name: str = "figure2") -> Figure:
    """R(x) of one of the paper's figures at its end, in the automaton and in BCRE."""
    figure, (axis,) = panels(1, 1, width=4.7, height=3.2)
    frames = profiles[profiles["figure"] == figure_name]
    last = frames["t"].max()
    start = frames[(frames["t"] == 0) & (frames["model"] == BCRE.name)]
    axis.plot(start["x"], start["R"], **style.START)
    axis.fill_between(start["x"], start["R"], color="0.55", alpha=0.1, linewidth=0)
    tops = {}
    for model in COMPARED:
        line = frames[(frames["t"] == last) & (frames["model"] == model.name)]
        look = model.line | {"linewidth": 2.4 if model is EFFECTIVE else 2.0}
        axis.plot(line["x"], line["R"], **look)
        tops[model.name] = line.loc[line["R"].idxmax()]
    label: dict[str, Any] = {"textcoords": "offset points", "fontsize": 9.5}
    first = start.loc[start["R"].idxmax()]
    axis.annotate("the pulse at t = 0", (first["x"], first["R"]), (9, -3), color="0.5", **label)
    axis.annotate(
        "BCRE",
        (tops[BCRE.name]["x"], tops[BCRE.name]["R"]),
        (0, 6),
        ha="center",
        color=BCRE.color,
        weight="bold",
        **label,
    )
    half = frames[(frames["t"] == last) & (frames["model"] == AUTOMATON.name)]
    right = half[half["R"] >= tops[AUTOMATON.name]["R"] / 2].iloc[-1]
    axis.annotate(
        "automaton", (right["x"], right["R"]), (8, 6), color=AUTOMATON.color, weight="bold", **label
    )
    axis.annotate(
        "BCRE with the cells’\nown diffusion: on top of it",
        (right["x"], right["R"]),
        (8, -20),
        color=EFFECTIVE.color,
        **label,
    )
    axis.set(xlabel="distance downhill x", ylabel="rolling layer R", ylim=(0, None))
    axis.set_xlim(0, float(frames["x"].max()) + 18)
    return figure
