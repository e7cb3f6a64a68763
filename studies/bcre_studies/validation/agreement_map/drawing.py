"""The maps: where the models differ, what predicts it, and which slopes let a pulse run."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm

import bcre_ca
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.models.registry import AUTOMATON, BCRE
from bcre_studies.reporting import style
from bcre_studies.validation.agreement_map.measured import FAILED, TOLERANCE
from bcre_studies.validation.agreement_map.prediction import (
    by_width,
    by_width_place_and_mass,
    largest_broadening,
)
from bcre_studies.validation.agreement_map.pulses import Pulse
from bcre_studies.validation.agreement_map.thresholds import (
    LENGTH,
    THICKNESSES,
    TO_FOOT,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LOOKS: dict[str, dict[str, Any]] = {
    Verdict.AGREE: {"color": "#2b6ca3", "marker": "o"},
    Verdict.EXPLAINED: {"color": "#d99a1c", "marker": "^"},
    Verdict.UNRESOLVED: {"color": "0.5", "marker": "s"},
    Verdict.DISAGREE: {"color": "#b3362b", "marker": "x"},
}
SHADES = ("#f0b27a", "#dc7633", "#a04000", "#5b2300")
"""From the thinnest pulse to the thickest."""

LEAST, MOST = 1e-3, 1.0
"""Differences that the maps tell apart."""

MANY = 5_000
"""Scenes from which on their marks are drawn as pixels."""


def draw(tables: dict[str, pd.DataFrame]) -> Figure:
    """Six panels, see their titles."""
    ran = tables["scenes"][tables["scenes"]["verdict"] != FAILED]
    pulses = [Pulse(**row) for row in ran[[f.name for f in fields(Pulse)]].to_dict("records")]
    ran = ran.assign(
        broadening=[pulse.broadening for pulse in pulses],
        predicted=[by_width_place_and_mass(pulse) for pulse in pulses],
        place=[abs(pulse.growth) / pulse.final_variance**0.5 for pulse in pulses],
    )
    figure, axes = style.panels(2, 3)
    figure.set_size_inches(12.6, 7.6)
    _map(axes[0], ran, "difference_R", "difference in R")
    _map(axes[1], ran, "difference_h", "difference in the change of h")
    _verdicts(axes[2], ran)
    _predictions(axes[3], ran)
    _slopes(axes[4], tables["thresholds"])
    _distances(axes[5], tables["thresholds"])
    return figure


def _map(axis: Axes, ran: pd.DataFrame, column: str, label: str) -> None:
    """A difference over r and G."""
    values = ran[column].clip(LEAST, MOST)
    points = axis.scatter(
        ran["broadening"],
        ran["growth"],
        c=values,
        s=14,
        norm=LogNorm(LEAST, MOST),
        cmap="viridis_r",
    )
    bar = axis.figure.colorbar(points, ax=axis)
    bar.set_label(f"relative {label}")
    axis.axvline(largest_broadening(TOLERANCE), color="k", linewidth=0.9, linestyle="--")
    axis.set_xscale("log")
    axis.set_xlabel(r"$r = v d (1 - c) t/(w^2/2 + 2 D t)$")
    axis.set_ylabel(r"$G = \gamma (S_0 - S_c) t$")
    axis.set_title(f"Relative {label}", loc="left")


def _verdicts(axis: Axes, ran: pd.DataFrame) -> None:
    """Difference in R over r, with the closed form of a pulse that keeps its shape."""
    _by_verdict(axis, ran, "broadening", "difference_R")
    r = np.geomspace(ran["broadening"].min(), ran["broadening"].max(), 200)
    axis.plot(r, [by_width(each) for each in r], color="k", label="thin, without growth")
    axis.axhline(TOLERANCE, color="k", linewidth=0.9, linestyle="--")
    axis.set_xlabel("r")
    axis.set_ylabel("relative difference in R")
    axis.set_title("A lower bound by r alone", loc="left")
    axis.legend(fontsize=7.5)


def _predictions(axis: Axes, ran: pd.DataFrame) -> None:
    """Measured difference over that of width, place and mass."""
    _by_verdict(axis, ran, "predicted", "difference_R")
    ends = [5 * LEAST, ran["predicted"].max()]
    axis.plot(ends, ends, color="k", linewidth=0.9)
    axis.axvline(TOLERANCE, color="k", linewidth=0.9, linestyle="--")
    axis.axhline(TOLERANCE, color="k", linewidth=0.9, linestyle="--")
    axis.set_xlabel("predicted by width, place and mass")
    axis.set_ylabel("relative difference in R")
    axis.set_title("The rule against what was measured", loc="left")


def _by_verdict(axis: Axes, ran: pd.DataFrame, x: str, y: str) -> None:
    for word, look in LOOKS.items():
        rows = ran[ran["verdict"] == str(word)]
        if len(rows):
            marks = look | {"linestyle": "", "markersize": 3.2, "rasterized": len(ran) > MANY}
            axis.plot(rows[x], rows[y], label=str(word), **marks)
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_ylim(bottom=5 * LEAST)


def _slopes(axis: Axes, thresholds: pd.DataFrame) -> None:
    """The steepness at which a pulse runs, over Pe: the automaton's and BCRE's."""
    usual = thresholds[(thresholds["length"] == LENGTH) & (thresholds["to_foot"] == TO_FOOT)]
    peclets = np.geomspace(0.02, 10, 100)
    axis.plot(peclets, [critical(peclet) for peclet in peclets], color="k", label="Sd, closed form")
    own = usual[usual["model"] == AUTOMATON.name]
    for shade, (thickness, rows) in zip(SHADES, own.groupby("thickness"), strict=True):
        look = AUTOMATON.marked_line | {"color": shade, "label": f"a = {thickness:g}"}
        axis.plot(rows["peclet"], rows["s"], **look)
        both = usual[(usual["model"] == BCRE.name) & (usual["thickness"] == thickness)]
        s = both.sort_values("peclet")["s"].iloc[0] if len(both) else 1.0
        axis.axhline(s, color=shade, linestyle=BCRE.linestyle, linewidth=1.0)
    axis.set_xscale("log")
    axis.set_xlabel("Pe = v d/D")
    axis.set_ylabel(r"$(S - S_c)/(S_d - S_c)$ of BCRE")
    axis.set_title("Slope at which a pulse runs up (dashed: BCRE)", loc="left")
    axis.legend(fontsize=7.5, loc="lower left")


def critical(peclet: float) -> float:
    """s of an infinitely thin pulse in the automaton: its second critical slope."""
    rule = bcre_ca.Rule(v=1.0, D=1.0, gamma=1.0, Sc=0.0, d=peclet, dt=1.0)
    return 4 * rule.second_critical_slope()


def _distances(axis: Axes, thresholds: pd.DataFrame) -> None:
    """Both models' at Pe = 1, over the distance to the foot; on a longer slope hollow."""
    thick = thresholds[thresholds["thickness"].isin(THICKNESSES[1:])]
    for shade, (thickness, rows) in zip(SHADES[1:], thick.groupby("thickness"), strict=True):
        for model in (AUTOMATON, BCRE):
            of = rows[(rows["model"] == model.name) & (rows["peclet"] <= 1)]
            of = of.sort_values("peclet").groupby(["length", "to_foot"]).tail(1)
            usual = of[of["length"] == LENGTH].sort_values("to_foot")
            longer = of[of["length"] != LENGTH]
            look = model.marked_line | {"color": shade, "linewidth": 1.2, "markersize": 4.5}
            look["label"] = f"a = {thickness:g}, {model.label}"
            axis.plot(usual["to_foot"], usual["s"], **look)
            hollow = model.markers(hollow=True, color=shade, markersize=9)
            axis.plot(longer["to_foot"], longer["s"], **hollow)
    axis.set_xlabel(f"distance to the foot, D/v (large: L = {2 * LENGTH:g})")
    axis.set_ylabel(r"$(S - S_c)/(S_d - S_c)$ of BCRE")
    axis.set_title("The same at Pe = 1, by place and length", loc="left")
    axis.set_ylim(top=1.12)
    axis.legend(fontsize=7, ncols=2, loc="upper right")
