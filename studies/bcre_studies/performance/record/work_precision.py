"""Work against precision: what an error of R costs each contender, scene by scene."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pandas as pd

from bcre_studies.models.registry import BCRE, SCHEMES, Look
from bcre_studies.performance.record.record import TARGETS
from bcre_studies.reporting import style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LOOKS: dict[str, Look] = {
    **{scheme.label: scheme.marked_line for scheme in SCHEMES.values()},
    "PDE, runge-kutta": BCRE.line | {"marker": BCRE.marker},
    "NumPy automaton": {"color": SCHEMES["upwind"].color, "linestyle": ":", "marker": "."},
    "SciPy LSODA, banded": {"color": "0.45", "linestyle": ":", "marker": "x"},
    "py-pde expressions, central": {"color": "#3b8f5a", "linestyle": ":", "marker": "+"},
    "FiPy": {"color": "0.7", "linestyle": ":", "marker": "1"},
}
"""The contenders that are drawn."""


def draw(errors: pd.DataFrame, recorded: pd.DataFrame | None) -> Figure:
    """Error of R against cell-steps and, where recorded, against seconds; one column a scene."""
    labels = list(dict.fromkeys(errors["scene"]))
    figure, axes = style.panels(1 if recorded is None else 2, len(labels))
    for axis, label in zip(axes, labels, strict=False):
        _draw_scene(axis, errors, label, "cell_steps", "cell-steps")
        axis.set_title(label, loc="left")
    if recorded is not None:
        for axis, label in zip(axes[len(labels) :], labels, strict=True):
            _draw_scene(axis, recorded, label, "median_s", "seconds")
    handles = {line.get_label(): line for axis in axes for line in axis.get_lines()}
    figure.legend(
        handles=[handles[name] for name in LOOKS if name in handles],
        loc="outside lower center",
        ncols=8,
    )
    return figure


def _draw_scene(axis: Axes, table: pd.DataFrame, label: str, cost: str, unit: str) -> None:
    rows = table[table["scene"] == label]
    for name, line in rows.groupby("contender", sort=False):
        if name in LOOKS:
            axis.loglog(line[cost], line["error_R"], **LOOKS[str(name)] | {"label": name})
    for target in TARGETS:
        axis.axhline(target, color="0.8", linewidth=0.6, zorder=0)
    axis.set_ylim(5e-5, 3)
    axis.set_xlabel(unit)
    axis.set_ylabel("L1 error of R")
