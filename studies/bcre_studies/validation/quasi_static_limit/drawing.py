"""The map of eps and tau with the error on it, and what each number does along its axis."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from bcre_studies.models.registry import AUTOMATON, BCRE, Look
from bcre_studies.reporting import style
from bcre_studies.validation.quasi_static_limit.heaps import MODELS

LEVELS = {0.05: "-", 0.1: (0, (5, 2))}
SHORT = {"figure1": "figure 1", "figure2": "figure 2", "figure3": "figure 3"}


def draw_map(
    table: pd.DataFrame, heaps: pd.DataFrame, figures: pd.DataFrame, tolerance: float, weight: float
) -> Figure:
    """Three panels: the map, the slope over eps, and the sand at rest over tau."""
    figure, (places, slope, rest) = style.panels(1, 3)
    _draw_places(places, table, heaps, figures)
    _draw_rule(places, tolerance, weight)
    for axis, quantity, number, other, label in (
        (slope, "slope", "eps", "tau", "slope, less than $S_c$ by the part"),
        (rest, "at rest", "tau", "eps", "sand at rest, less by the part"),
    ):
        _draw_rate(axis, table, quantity, number, other)
        axis.set_xlabel(rf"$\{'epsilon' if number == 'eps' else 'tau'}$")
        axis.set_ylabel(label)
    return figure


def _draw_places(
    axis: Axes, table: pd.DataFrame, heaps: pd.DataFrame, figures: pd.DataFrame
) -> None:
    pde = table[table["model"] == BCRE.name].pivot(index="tau", columns="eps", values="error")
    eps, tau = np.meshgrid(pde.columns, pde.index)
    for level, linestyle in LEVELS.items():
        look: Look = {"colors": BCRE.color, "linewidths": BCRE.linewidth, "linestyles": [linestyle]}
        axis.contour(eps, tau, pde.to_numpy(), [level], **look)
        axis.plot([], [], color=BCRE.color, linestyle=linestyle, label=f"error {level:.0%}")
    axis.plot(eps, tau, ".", color="0.6", markersize=3)
    axis.plot(heaps["eps"], heaps["tau"], "x", color="0.35", markersize=5, label="other materials")
    for row in figures.itertuples():
        axis.plot(row.eps, row.tau, "D", color=AUTOMATON.color, markersize=5)
        axis.annotate(
            SHORT[str(row.figure)],
            (row.eps, row.tau),
            xytext=(-6, 4 if row.figure != "figure2" else -12),
            textcoords="offset points",
            ha="right",
            fontsize=8,
        )
    axis.set(xscale="log", yscale="log", xlim=(5e-3, 20), ylim=(5e-3, 10))
    axis.set_xlabel(r"$\epsilon = v/(\gamma S_c l)$")
    axis.set_ylabel(r"$\tau = Q/(v A)$")
    axis.set_title("error of h without a rolling layer, BCRE", loc="left")


def _draw_rule(axis: Axes, tolerance: float, weight: float) -> None:
    eps = np.geomspace(5e-3, 0.999 * tolerance / weight, 100)
    axis.fill_between(
        eps, 5e-3, tolerance - weight * eps, color="#cfe8d5", linewidth=0, label="no layer needed"
    )
    axis.legend(loc="upper right", bbox_to_anchor=(1.0, 0.9), fontsize=8)


def _draw_rate(axis: Axes, table: pd.DataFrame, quantity: str, number: str, other: str) -> None:
    for name, model in MODELS.items():
        rows = table[table["model"] == name]
        line = rows[rows[other] == rows[other].min()].sort_values(number)
        axis.loglog(line[number], -line[quantity], **model.marked_line)
    ends = np.array([table[number].min(), table[number].max()])
    first = float(-line[quantity].iloc[0])
    axis.loglog(ends, first * ends / ends[0], color="0.55", linewidth=1.0, label="first order")
    axis.xaxis.set_minor_formatter(NullFormatter())
    axis.yaxis.set_minor_formatter(NullFormatter())
    axis.legend()
