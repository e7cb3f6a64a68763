"""From which slope on a pulse of a given size brings the pile down."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullLocator

from bcre_studies.models.registry import AUTOMATON, BCRE
from bcre_studies.publishing.pictures.panels import panels

THRESHOLD, SD = "threshold S0 - Sc", "Sd - Sc"
TOP = 3.4


def phase_diagram(comparison: pd.DataFrame, paper: tuple[float, float]) -> Figure:
    """Pulse against slope: where it stands, and from where on it comes down, in both models.

    Parameters
    ----------
    comparison: the table of ``second_critical_angle``.
    paper: amplitude and S0 - Sc of figure 1.
    """
    rows = comparison[comparison["quantity"] == THRESHOLD].sort_values("pulse")
    pulse = rows["pulse"].astype(float).to_numpy()
    own, finer, bcre = (
        rows[name].astype(float).to_numpy() for name in ("automaton", "automaton d/4", BCRE.column)
    )
    figure, (axis,) = panels(1, 1, width=4.7, height=3.7)
    axis.fill_between(pulse, 0, own, color="0.55", alpha=0.08, linewidth=0)
    axis.fill_between(pulse, own, finer, color=AUTOMATON.color, alpha=0.30, linewidth=0)
    axis.fill_between(pulse, finer, bcre, color=AUTOMATON.color, alpha=0.13, linewidth=0)
    axis.fill_between(pulse, bcre, TOP, color=BCRE.color, alpha=0.10, linewidth=0)
    axis.plot(pulse, own, **AUTOMATON.line, marker="o", label="automaton, d = 1")
    axis.plot(
        pulse,
        finer,
        color=AUTOMATON.color,
        linestyle=(0, (4, 1, 1, 1)),
        marker="o",
        markerfacecolor="white",
        label="automaton, d = 1/4",
    )
    axis.plot(pulse, bcre, **BCRE.line, marker="s", label="BCRE")
    middle = math.sqrt(pulse[0] * pulse[-1])
    top = float(np.interp(math.log(middle), np.log(pulse), bcre))
    low = float(np.interp(math.log(middle), np.log(pulse), own))
    quiet: dict[str, Any] = {"ha": "center", "va": "center"}
    axis.text(middle, (top + TOP) / 2, "the whole slope comes down\nin both models", **quiet)
    axis.text(pulse[0] * 1.6, float(own[0] + finer[0]) / 2, "only in the automaton", va="center")
    axis.text(middle, low / 2, "the pulse passes, the slope stands", **quiet)
    axis.plot(*paper, marker="*", markersize=11, color="0.2", linestyle="")
    axis.annotate("figure 1", paper, (-8, 0), textcoords="offset points", ha="right", va="center")
    axis.set(xscale="log", xlim=(pulse[0], pulse[-1]), ylim=(0, TOP))
    axis.xaxis.set_major_formatter(FuncFormatter(_plain))
    axis.xaxis.set_minor_locator(NullLocator())
    axis.set_xlabel("amplitude of the pulse")
    axis.set_ylabel("slope above repose, S0 − Sc")
    figure.legend(loc="outside lower center", ncols=3, handlelength=2.6, columnspacing=1.2)
    return figure


def _plain(value: float, _: object) -> str:
    """1e-06 as 0.000001 would be read by nobody, 10^-6 needs mathematics; 1e-6 is plain."""
    return f"{value:g}" if value >= 1e-3 else f"1e{math.log10(value):.0f}".replace("-", "−")
