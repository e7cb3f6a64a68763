"""How every figure looks, down to the bytes; how each model looks stands in the registry."""

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

from bcre_studies.models.registry import Look, Model

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


def use() -> None:
    """Draw in this look from here on, whatever a user's own matplotlibrc says."""
    mpl.rcdefaults()
    mpl.rcParams.update(RC)


START: Look = {"color": "0.55", "linestyle": (0, (4, 2, 1, 2)), "linewidth": 1.0}


def panels(rows: int, columns: int) -> tuple[Figure, list[Axes]]:
    """A figure of so many panels, and its axes row by row."""
    use()
    figure = Figure(figsize=(4.1 * columns, 3.2 * rows + 0.4), layout="constrained")
    axes = np.atleast_1d(figure.subplots(rows, columns))
    return figure, list(axes.ravel())


def legend(
    figure: Figure, models: Iterable[Model], *, markers: bool = False, start: bool = False
) -> None:
    """One legend below all panels that names the models, and the state at the start if asked."""
    looks: list[Look] = [
        {"label": model.label, "marker": model.marker if markers else ""} | model.line
        for model in models
    ]
    looks += [{"label": "start"} | START] if start else []
    handles = [Line2D([], [], **look) for look in looks]
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
