"""Matrices of ingredients by observables."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from matplotlib.colors import BoundaryNorm, ListedColormap

from bcre_studies.observables.named import NAMES
from bcre_studies.performance.scene_needs.claims import TOLERANCES
from bcre_studies.reporting import style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

BOUNDS = (0.0, 1e-6, 1e-4, 1e-3, 0.01, 0.05, 0.5, np.inf)
COLOURS = ("#ffffff", "#eef3f8", "#d6e4f0", "#b3cde3", "#fdd9a0", "#f28e4b", "#b5370f")
LABELS = ("< 1e-6", "1e-4", "1e-3", "1 %", "5 %", "50 %", "more")


def draw(tables: dict[str, pd.DataFrame]) -> Figure:
    """One matrix a scene: ingredients by observables, coloured by the relative change.

    Colours change from blue to orange at 1 %; a ring marks more than 1 %, a disc more than 5 %.
    """
    scenes = [name for name in tables if name != "comparison"]
    figure, axes = style.panels(2, (len(scenes) + 1) // 2)
    for axis, scene in zip(axes, scenes, strict=False):
        _matrix(axis, tables[scene])
        axis.set_title(scene, loc="left")
    for axis in axes[len(scenes) :]:
        axis.set_axis_off()
        _key(axis)
    return figure


def _matrix(axis: Axes, table: pd.DataFrame) -> None:
    norm = BoundaryNorm([*BOUNDS[:-1], 1e9], len(COLOURS))
    names = list(NAMES)
    values = np.full((len(table), len(names)), np.nan)
    for column, name in enumerate(names):
        if name in table:
            values[:, column] = table[name].to_numpy(dtype=float)
    colours = ListedColormap(list(COLOURS))
    colours.set_bad("#e8e8e8")
    finite = np.minimum(values, 1e8)
    axis.pcolormesh(finite, cmap=colours, norm=norm, edgecolors="0.85", linewidth=0.5)
    for row, column in np.ndindex(*values.shape):
        place, changed = (column + 0.5, row + 0.5), values[row, column]
        if names[column] not in table:
            continue
        if table["runs"].iloc[row] == "refused":
            axis.plot(*place, "kx", markersize=4)
        elif changed > TOLERANCES["1"]:
            filled = "k" if changed > TOLERANCES["5"] else "none"
            axis.plot(*place, "o", color="k", markerfacecolor=filled, markersize=4)
    axis.set_xticks(np.arange(len(names)) + 0.5, names, rotation=60, fontsize=7)
    axis.set_yticks(np.arange(len(table)) + 0.5, list(table["without"]), fontsize=7)
    axis.tick_params(length=0)
    axis.invert_yaxis()
    axis.grid(visible=False)


def _key(axis: Axes) -> None:
    for colour, label in zip(COLOURS, LABELS, strict=True):
        axis.plot([], [], "s", color=colour, markeredgecolor="0.6", markersize=9, label=label)
    axis.plot([], [], "ko", markerfacecolor="none", label="more than 1 %")
    axis.plot([], [], "ko", label="more than 5 %")
    axis.plot([], [], "kx", label="refused: needed for stability")
    axis.plot([], [], "s", color="#e8e8e8", markeredgecolor="0.6", label="not posed by the scene")
    axis.legend(loc="center left", title="relative change up to", fontsize=8, ncols=1)
