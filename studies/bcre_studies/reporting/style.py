"""How every figure looks: the models told apart by line style as well as colour, bytes stable."""

from __future__ import annotations

import io
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

RC: Any = {
    "axes.axisbelow": True,
    "axes.grid": True,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlesize": 9,
    "font.size": 9,
    "grid.alpha": 0.25,
    "legend.frameon": False,
    "lines.linewidth": 1.4,
    "lines.markersize": 4.5,
    "svg.fonttype": "none",
    "svg.hashsalt": "bcre",
}

Look = dict[str, Any]

MODELS: dict[str, Look] = {
    "ca": {"color": "#b5480f", "linestyle": "-"},
    "pde": {"color": "#1f5a99", "linestyle": (0, (5, 2))},
    "pde effective": {"color": "#3b8f5a", "linestyle": (0, (1, 1.2)), "linewidth": 2.2},
}
MARKERS: dict[str, str] = {"ca": "o", "pde": "s", "pde effective": "^"}
LABELS = {
    "ca": "automaton",
    "pde": "BCRE (PDE)",
    "pde effective": r"BCRE with $D_\mathrm{eff}$, $\kappa_\mathrm{eff}$",
    "start": "start",
}
START: Look = {"color": "0.55", "linestyle": (0, (4, 2, 1, 2)), "linewidth": 1.0}


def marker(model: str, *, hollow: bool = False, **changes: Any) -> Look:
    """A model's marker without a line.

    That of the effective PDE is a frame round what it lies upon, unless a ``fillstyle`` is given.
    """
    frame = model == "pde effective" and "fillstyle" not in changes
    color = MODELS[model]["color"]
    look: Look = {"marker": MARKERS[model], "linestyle": "", "color": color}
    look |= {"markersize": 9 if frame else 5}
    if hollow or frame:
        look["markerfacecolor"] = "none"
    return look | changes


def panels(rows: int, columns: int) -> tuple[Figure, list[Axes]]:
    """A figure of so many panels, and its axes row by row."""
    mpl.rcParams.update(RC)
    figure = Figure(figsize=(4.1 * columns, 3.2 * rows + 0.4), layout="constrained")
    axes = np.atleast_1d(figure.subplots(rows, columns))
    return figure, list(axes.ravel())


def legend(figure: Figure, models: Iterable[str], *, markers: bool = False) -> None:
    """One legend below all panels that names the models."""
    handles = []
    for model in models:
        look = START if model == "start" else MODELS[model]
        marker = MARKERS.get(model, "") if markers else ""
        handles.append(Line2D([], [], label=LABELS[model], marker=marker, **look))
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles), handlelength=3.4)


def svg_of(figure: Figure) -> str:
    """The figure as SVG that depends on the figure alone; its texts are texts."""
    content = io.StringIO()
    with mpl.rc_context(RC):
        figure.savefig(content, format="svg", metadata={"Date": None})
    return content.getvalue()


def save(figure: Figure, path: Path) -> None:
    """Write an SVG whose bytes depend on the figure alone."""
    path.write_text(svg_of(figure), encoding="utf-8")
