"""The sawtooth of the slope, sizes and their tails, start slopes, small avalanches."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from bcre_studies.models.registry import AUTOMATON, BCRE, EFFECTIVE, Look
from bcre_studies.reporting import style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SHADES = ("#f0b27a", "#dc7633", "#a04000", "#5b2300")
"""From the shortest slope to the longest, and from the smallest trigger to the largest."""

LOOKS = {
    "automaton, d = 1": AUTOMATON.line | {"label": AUTOMATON.label},
    "BCRE, 48 cells": BCRE.line | {"label": BCRE.label},
    "effective, 48 cells": EFFECTIVE.line | {"label": EFFECTIVE.label},
}


def draw(tables: dict[str, pd.DataFrame], critical: tuple[float, float]) -> Figure:
    """Six panels, see their titles."""
    figure, axes = style.panels(2, 3)
    figure.set_size_inches(12.6, 7.4)
    slopes, sizes, table = tables["slopes"], tables["sizes"], tables["comparison"]
    _sawtooth(axes[0], slopes, critical)
    _beside(axes[1], slopes)
    _starts(axes[2], table, critical)
    _tail(axes[3], sizes[sizes["drive"] == "tilting, length"], "Tilting, trigger 0.001: a gap")
    _tail(axes[4], sizes[sizes["drive"] == "feeding"], "Feeding: no one power law")
    for shade, (_, row) in zip(SHADES, table[table["drive"] == "feeding"].iterrows(), strict=False):
        _law(axes[4], sizes, row, shade)
    axes[4].set_ylim(bottom=1e-4)
    _small(axes[5], tables["small"])
    return figure


def _sawtooth(axis: Axes, slopes: pd.DataFrame, critical: tuple[float, float]) -> None:
    of = slopes[slopes["drive"] == "tilting"]
    for shade, (name, rows) in zip(SHADES[1::2], of.groupby("case", sort=False), strict=True):
        axis.plot(rows["tilt"], rows["slope"], color=shade, linewidth=1.0, label=str(name))
    stuck = slopes[slopes["drive"] == "tilting, height alone"]
    axis.plot(
        stuck["tilt"],
        stuck["slope"],
        color="0.45",
        linewidth=0.9,
        linestyle=":",
        label="height alone, start and stop",
    )
    _critical(axis, critical)
    axis.set_ylim(top=3.3)
    axis.set_xlabel("tilts of 0.01")
    axis.set_ylabel(r"$S - S_c$ before each")
    axis.set_title("The slope under slow tilting", loc="left")
    axis.legend(fontsize=7.5, loc="upper right")


def _critical(axis: Axes, critical: tuple[float, float]) -> None:
    for value, model in zip(critical, (AUTOMATON, BCRE), strict=True):
        axis.axhline(value, color=model.color, linewidth=0.9, linestyle=":")
        axis.annotate(
            rf"$S_d - S_c$, {model.label}",
            (0.99, value),
            xycoords=("axes fraction", "data"),
            fontsize=7.5,
            ha="right",
            va="bottom",
            color=model.color,
        )


def _beside(axis: Axes, slopes: pd.DataFrame) -> None:
    for name, look in LOOKS.items():
        rows = slopes[slopes["case"] == name]
        axis.plot(rows["tilt"], rows["slope"], **look)
    axis.set_xlabel("tilts of 0.05")
    axis.set_ylabel(r"$S - S_c$ before each")
    axis.set_ylim(top=2.9)
    axis.set_title("L = 32, beside BCRE", loc="left")
    axis.legend(fontsize=7.5, loc="upper right")


def _starts(axis: Axes, table: pd.DataFrame, critical: tuple[float, float]) -> None:
    rows = table[table["drive"].isin(["tilting", "tilting, length"])]
    parts = rows["case"].str.extract(r"L = (?P<length>\d+), trigger (?P<trigger>[\d.e-]+)")
    rows = rows.assign(**parts.astype(float))
    for shade, (trigger, these) in zip(SHADES, rows.groupby("trigger"), strict=True):
        axis.errorbar(
            these["length"],
            these["start"],
            these["start_sd"],
            color=shade,
            marker=AUTOMATON.marker,
            capsize=3,
            label=f"trigger {trigger:g}",
        )
    _critical(axis, critical)
    axis.set_xscale("log", base=2)
    axis.set_xlabel("L")
    axis.set_ylabel(r"$S - S_c$ at the start of big ones")
    axis.set_ylim(top=3.3)
    axis.set_title("Start slope, mean and standard deviation", loc="left")
    axis.legend(fontsize=7.5, loc="upper right", ncols=2)


def _tail(axis: Axes, sizes: pd.DataFrame, title: str) -> None:
    for shade, (name, rows) in zip(SHADES, sizes.groupby("case", sort=False), strict=False):
        label = str(name).partition(",")[0]
        axis.plot(rows["size"], rows["share"], color=shade, label=label, drawstyle="steps-post")
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_xlabel("size, area that leaves")
    axis.set_ylabel("share of avalanches at least so large")
    axis.set_title(title, loc="left")
    axis.legend(fontsize=7.5, loc="lower left")


def _law(axis: Axes, sizes: pd.DataFrame, fit: pd.Series, shade: str) -> None:
    """The fitted power law, from where its tail begins."""
    rows = sizes[(sizes["drive"] == "feeding") & (sizes["case"] == fit["case"])]
    least = float(fit["from_size"])
    tail = np.geomspace(least, float(rows["size"].max()), 2)
    share = float(np.interp(least, rows["size"], rows["share"]))
    axis.plot(
        tail,
        share * (tail / least) ** (1 - float(fit["exponent"])),
        color=shade,
        linewidth=0.9,
        linestyle="--",
    )


def _small(axis: Axes, small: pd.DataFrame) -> None:
    for shade, (length, rows) in zip(SHADES, small.groupby("length"), strict=True):
        look: Look = {"color": shade, "marker": "o", "linestyle": "", "markersize": 3}
        axis.plot(rows["predicted"], rows["measured"], label=f"L = {length}", **look)
    ends = [0, small["predicted"].max()]
    axis.plot(ends, ends, color="k", linewidth=0.9)
    axis.set_xlabel(r"predicted, $\ln z\,(L - x)/d$")
    axis.set_ylabel("ln(size/trigger)")
    axis.set_title("Small avalanches are amplified triggers", loc="left")
    axis.legend(fontsize=7.5)
