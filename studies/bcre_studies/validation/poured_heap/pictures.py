"""The figure of the study: heaps of three flow rules as maps, and how their error falls."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from bcre_studies.on_plane.picture import shaded
from bcre_studies.reporting import style
from bcre_studies.scenes.domain import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LARGEST = 1.0
"""Of the colour scale, a length."""

LOOKS = {"split4": ("#b5480f", "o"), "facet8": ("#1f5a99", "s"), "d8": ("0.3", "^")}


def table_of(flow: str, h: Array, expected: Array) -> pd.DataFrame:
    """h on an eighth of the plane, where there is sand, and its difference from the radial h."""
    rows, columns = np.nonzero(np.tril(h + expected > 1e-3))
    off = h - expected
    layers = {"h": h[rows, columns].round(2), "difference": off[rows, columns].round(3)}
    return pd.DataFrame({"flow": flow, "i": rows, "j": columns} | layers)


def draw(poured: pd.DataFrame, maps: pd.DataFrame) -> Figure:
    """Three maps and a panel of errors."""
    figure, axes = style.panels(2, 2)
    figure.set_size_inches(8.6, 8.0)
    d = float(sorted(poured["d"].unique())[1])
    for axis, (flow, table) in zip(axes, maps.groupby("flow", sort=False), strict=False):
        image = _draw_map(axis, table, d)
        axis.set_title(f"{flow}, d = {d:g}", loc="left")
    label = "h - h of the radial solution (length)"
    figure.colorbar(image, ax=axes[:3], label=label, shrink=0.5, location="bottom")
    _draw_errors(axes[3], poured)
    return figure


def _draw_map(axis: Axes, table: pd.DataFrame, d: float) -> Any:
    cells = int(table[["i", "j"]].max().max()) + 4
    layers = np.zeros((2, cells, cells))
    for layer, column in zip(layers, ("h", "difference"), strict=True):
        layer[table["i"], table["j"]] = layer[table["j"], table["i"]] = table[column]
    h, off = (np.block([[q[::-1, ::-1], q[::-1]], [q[:, ::-1], q]]) for q in layers)
    reach = cells * d
    extent = (-reach, reach, reach, -reach)
    look: Any = {"extent": extent, "interpolation": "nearest", "aspect": "equal"}
    axis.imshow(shaded(h, d), cmap="gray", vmin=-0.2, vmax=1.1, **look)
    image = axis.imshow(off, cmap="RdBu_r", vmin=-LARGEST, vmax=LARGEST, alpha=0.55, **look)
    axis.grid(visible=False)
    axis.set(xlabel="y (length)", ylabel="x (length)")
    return image


def _draw_errors(axis: Axes, rows: pd.DataFrame) -> None:
    for flow, line in rows.groupby("flow", sort=False):
        color, marker = LOOKS[str(flow)]
        axis.plot(line["d"], line["difference"], color=color, marker=marker, label=str(flow))
    d = np.array([0.25, 1.0])
    axis.plot(d, 0.008 * d, color="0.6", dashes=(4, 2), label="first order")
    axis.set(xscale="log", yscale="log", xlabel="cell length d", ylabel="relative L1 error of h")
    axis.set_xticks([0.25, 0.5, 1.0], ["1/4", "1/2", "1"])
    axis.set_yticks([0.002, 0.005, 0.01, 0.02, 0.05], ["0.2 %", "0.5 %", "1 %", "2 %", "5 %"])
    axis.minorticks_off()
    axis.legend()
    axis.set_title("a poured heap against the radial solution", loc="left")
