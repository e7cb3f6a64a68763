"""The figure of the study: a triangle, angles over slope, edges over distance, thresholds."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from matplotlib.colors import ListedColormap

from bcre_ca.plane.theory import edge
from bcre_pde.plane import Material, theory
from bcre_studies.models.registry import AUTOMATON, BCRE, EFFECTIVE
from bcre_studies.on_plane.picture import shaded
from bcre_studies.reporting import style
from bcre_studies.validation.opening_angle.layer import THICKNESS, Triangle
from bcre_studies.validation.opening_angle.trace import with_diffusion_of_cells

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

EVERY = 2
"""Cells between two of those that the map shows."""

MAPPED = 256
"""Rows of the map."""

LOOKS = {1.0: "#b5480f", 10.0: "#7b3f8c", 100.0: "#3b8f5a"}
"""Colours of pulses."""


def table_of(found: Triangle) -> pd.DataFrame:
    """Depth eroded in every second cell, one row of cells a row."""
    rows = np.flatnonzero((found.x > -20) & (found.x < MAPPED))[::EVERY]
    columns = np.flatnonzero(found.y < MAPPED / 2)[::EVERY]
    values = found.eroded[np.ix_(rows, columns)].round(3)
    names = [f"y = {y:g}" for y in found.y[columns]]
    return pd.DataFrame(values, columns=names).assign(x=found.x[rows])


def draw(
    angles: pd.DataFrame, thresholds: pd.DataFrame, edges: pd.DataFrame, eroded: pd.DataFrame
) -> Figure:
    """All four."""
    figure, axes = style.panels(2, 2)
    figure.set_size_inches(9.0, 8.0)
    _draw_triangle(figure, axes[0], eroded, angles)
    _draw_angles(axes[1], angles)
    _draw_edges(axes[2], edges, angles)
    _draw_thresholds(axes[3], thresholds)
    style.legend(figure, (AUTOMATON, BCRE, EFFECTIVE), markers=True)
    return figure


def _material(row: Any) -> Material:
    return Material(row["v"], row["D"], row["D across"], row["gamma"], 0.0)


def _draw_triangle(figure: Figure, axis: Axes, table: pd.DataFrame, angles: pd.DataFrame) -> None:
    x = table["x"].to_numpy()
    half = table.drop(columns="x").to_numpy()
    depth = np.concatenate([half[:, ::-1], half], axis=1)
    d = float(x[1] - x[0])
    reach = half.shape[1] * d
    extent = (-reach, reach, x[-1] + d / 2, x[0] - d / 2)
    look: Any = {"extent": extent, "interpolation": "nearest", "aspect": "equal"}
    axis.imshow(shaded(-depth, d), cmap="gray", vmin=-0.2, vmax=1.1, **look)
    fading = np.array([[0.71, 0.28, 0.06, a] for a in np.linspace(0, 0.75, 64)])
    image = axis.imshow(depth, cmap=ListedColormap(fading), vmin=0, vmax=THICKNESS, **look)
    figure.colorbar(image, ax=axis, label="sand eroded (length)", shrink=0.8)
    row = angles[(angles["S - Sc"] == 0.5) & (angles["d"] == 1.0)].iloc[0]
    for model, column in ((AUTOMATON, "automaton_theory"), (BCRE, "pde_theory")):
        y = x[-1] * math.tan(math.radians(row[column]))
        axis.plot([-y, 0, y], [x[-1], 0, x[-1]], **model.line)
    axis.grid(visible=False)
    axis.set(xlim=(-reach, reach), ylim=(x[-1] + d / 2, x[0] - d / 2))
    axis.set(xlabel="y, across (length)", ylabel="x, downhill (length)")
    axis.set_title("what a pulse leaves, S0 - Sc = 0.5; lines: theta", loc="left")


def _draw_angles(axis: Axes, rows: pd.DataFrame) -> None:
    own = rows[rows["case"] == "figure 1"]
    material = _material(own.iloc[0])
    slopes = np.linspace(0.02, 2.6, 400)
    with_own = with_diffusion_of_cells(material, 1.0)
    m = material
    curves = {
        AUTOMATON: [edge(m.v, m.D_x, m.D_y, m.gamma * s, 1.0).theta for s in slopes],
        BCRE: [theory.opening_angle(material, s) for s in slopes],
        EFFECTIVE: [theory.opening_angle(with_own, s) for s in slopes],
    }
    for model, curve in curves.items():
        axis.plot(slopes, curve, **model.line)
        axis.plot(own["S - Sc"], own[model.column], **model.markers())
    axis.set(ylim=(0, 95), xlabel="S - Sc", ylabel="theta (degrees)")
    axis.set_yticks(range(0, 91, 15))
    axis.set_title("figure 1's material; 90 degrees from Sd on", loc="left")


def _draw_edges(axis: Axes, edges: pd.DataFrame, angles: pd.DataFrame) -> None:
    """Behind its asymptote, y falls back as ln x does."""
    row = angles[(angles["S - Sc"] == 0.5) & (angles["d"] == 1.0)].iloc[0]
    m = _material(row)
    wave = edge(m.v, m.D_x, m.D_y, m.gamma * 0.5, 1.0)
    for pulse, line in edges[edges["excess"] == 0.5].groupby("pulse"):
        behind = line["x"] * math.tan(math.radians(wave.theta)) - line["y"]
        chosen = line["x"] >= 50
        color = LOOKS[float(str(pulse))]
        y = (behind - behind.iloc[-1])[chosen]
        axis.plot(line["x"][chosen], y, color=color, label=f"pulse {pulse:g}")
    x = np.geomspace(50, edges["x"].max(), 50)
    for factor, dashes in ((1.5, (4, 2)), (0.5, (1, 1.5))):
        y = factor / wave.across * np.log(x / x[-1])
        axis.plot(x, y, color="0.4", dashes=dashes, label=f"({factor:g}/n) ln x")
    axis.set(xscale="log", xlabel="x (length)", ylabel="x tan(theta) - y, less its last value")
    axis.set_xticks([50, 100, 200, 500], ["50", "100", "200", "500"])
    axis.minorticks_off()
    axis.legend(loc="lower right")
    axis.set_title("how far the edge of a layer falls behind", loc="left")


def _draw_thresholds(axis: Axes, rows: pd.DataFrame) -> None:
    """Hollow on a line, full on a plane."""
    for model, line in ((AUTOMATON, "line"), (BCRE, "line_pde")):
        for column, fill, where in ((line, "none", "line"), (model.column, "full", "plane")):
            look = model.markers(fillstyle=fill) | model.line | {"linewidth": 0.8}
            axis.plot(rows["pulse"], rows[column], **look, label=f"{model.label}, {where}")
    axis.plot(rows["pulse"], rows[EFFECTIVE.column], **EFFECTIVE.markers())
    axis.set(xscale="log", ylim=(0, None), xlabel="pulse amplitude (length)")
    axis.set_ylabel("threshold S0 - Sc")
    axis.legend()
    axis.set_title("from here on a pulse brings the top down", loc="left")
