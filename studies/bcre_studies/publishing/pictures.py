"""The report's own pictures: what the answer looks like, in one picture and in three.

:func:`answer` shows figure 2's rolling layer in both models; :func:`space_time` figure 1 in both
models and their difference; :func:`phase_diagram` from which slope on a pulse of a given size
brings the pile down; :func:`shares` how much of every difference the automaton's cells explain.
All but the maps are drawn from tables of the studies.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullLocator

from bcre_studies.comparison.rounding import significant
from bcre_studies.models.bcre import SHARE
from bcre_studies.models.registry import AUTOMATON, BCRE, COMPARED
from bcre_studies.models.registry import EFFECTIVE as COUNTED
from bcre_studies.models.run import frame_times
from bcre_studies.publishing.wording import figure_name
from bcre_studies.reporting import style
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.scene import load
from bcre_studies.sweeps.parallel import each

Tables = dict[str, pd.DataFrame]

CA, PDE, EFFECTIVE = (model.color for model in COMPARED)
RAMP = ("#fdf0d9", "#f9d9a6", "#f2b872", "#e58f45", "#cc672a", "#a5441c", "#752a17", "#451713")
"""From little to much; the style sheet turns it round in the dark scheme."""
LESS = ("#1f5a98", "#7ba7d1")
MORE = ("#e2976b", "#b54810")


def answer(profiles: pd.DataFrame, figure_name: str = "figure2") -> Figure:
    """R(x) of one of the paper's figures at its end, in the automaton and in BCRE."""
    figure, (axis,) = _panels(1, 1, width=4.7, height=3.2)
    frames = profiles[profiles["figure"] == figure_name]
    last = frames["t"].max()
    start = frames[(frames["t"] == 0) & (frames["model"] == BCRE.name)]
    axis.plot(start["x"], start["R"], **style.START)
    axis.fill_between(start["x"], start["R"], color="0.55", alpha=0.1, linewidth=0)
    tops = {}
    for model in COMPARED:
        line = frames[(frames["t"] == last) & (frames["model"] == model.name)]
        look = model.line | {"linewidth": 2.4 if model is COUNTED else 2.0}
        axis.plot(line["x"], line["R"], **look)
        tops[model.name] = line.loc[line["R"].idxmax()]
    label: dict[str, Any] = {"textcoords": "offset points", "fontsize": 9.5}
    first = start.loc[start["R"].idxmax()]
    axis.annotate("the pulse at t = 0", (first["x"], first["R"]), (9, -3), color="0.5", **label)
    axis.annotate(
        "BCRE",
        (tops[BCRE.name]["x"], tops[BCRE.name]["R"]),
        (0, 6),
        ha="center",
        color=PDE,
        weight="bold",
        **label,
    )
    half = frames[(frames["t"] == last) & (frames["model"] == AUTOMATON.name)]
    right = half[half["R"] >= tops[AUTOMATON.name]["R"] / 2].iloc[-1]
    axis.annotate("automaton", (right["x"], right["R"]), (8, 6), color=CA, weight="bold", **label)
    axis.annotate(
        "BCRE with the cells’\nown diffusion: on top of it",
        (right["x"], right["R"]),
        (8, -20),
        color=EFFECTIVE,
        **label,
    )
    axis.set(xlabel="distance downhill x", ylabel="rolling layer R", ylim=(0, None))
    axis.set_xlim(0, float(frames["x"].max()) + 18)
    return figure


# Figure 1 in space and time


@dataclass(frozen=True)
class SpaceTime:
    """Figure 1's rolling layer in both models on the automaton's cells, R (T, N).

    ``own`` (T,) is the change of BCRE from cells twice as long, relative to its mean, and
    ``gap`` (T,) that of the automaton from BCRE; ``top`` the height of the slope above repose.
    """

    x: Array
    t: Array
    automaton: Array
    pde: Array
    own: Array
    gap: Array

    @property
    def resolved_until(self) -> float:
        """The last time up to which BCRE's own error is small against the difference."""
        bad = np.flatnonzero(self.own > SHARE * np.maximum(self.gap, SHARE))
        return float(self.t[bad[0] - 1] if bad.size else self.t[-1])


UNTIL, ROWS, GRID = 240.0, 97, 800


def measure_space_time() -> SpaceTime:
    """Figure 1 on the paper's cells, with the step at which the studies compare it."""
    scene = load("figure1").with_changes(until=UNTIL, step=0.4)
    times = frame_times(scene, ROWS)
    run = AUTOMATON.run(scene, times)
    fine, coarse = each(_figure1_of_bcre, [GRID, GRID // 2], "figure 1, space-time")
    size = fine.mean(axis=1)
    return SpaceTime(
        x=run.x,
        t=run.t,
        automaton=run.R,
        pde=fine,
        own=np.abs(fine - coarse).mean(axis=1) / size,
        gap=np.abs(fine - run.R).mean(axis=1) / size,
    )


def _figure1_of_bcre(grid: int) -> Array:
    scene = load("figure1").with_changes(until=UNTIL, step=0.4)
    solution = BCRE.run(scene, frame_times(scene, ROWS), grid)
    cells = scene.domain.cells
    return np.asarray(solution.R.reshape(ROWS, cells, -1).mean(axis=2))


R_LEVELS = (0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 1000.0)
GAP_LEVELS = (-0.5, -0.2, -0.05, 0.05, 0.2, 0.5)


def space_time(found: SpaceTime) -> Figure:
    """R(x, t) in the automaton and in BCRE, and their difference over BCRE's largest R then."""
    figure, axes = _panels(1, 3, width=3.7, height=3.5)
    for axis, R in zip(axes, (found.automaton, found.pde), strict=False):
        axis.contourf(found.x, found.t, _rounded(R), levels=R_LEVELS, colors=RAMP)
    gap = (found.automaton - found.pde) / found.pde.max(axis=1, keepdims=True)
    axes[2].contourf(
        found.x,
        found.t,
        _rounded(gap),
        levels=GAP_LEVELS,
        colors=(LESS[0], LESS[0], LESS[1], "none", MORE[0], MORE[1], MORE[1]),
        extend="both",
    )
    titles = ("Automaton", "BCRE", "Automaton minus BCRE")
    for axis, title in zip(axes, titles, strict=True):
        axis.set_title(title, loc="left", weight="bold")
        axis.set(xlabel="distance downhill x", xlim=(35, 100), ylim=(0, UNTIL))
        axis.grid(visible=False)
    axes[0].set_ylabel("time t")
    until = found.resolved_until
    if until < UNTIL:
        for axis in axes[1:]:
            axis.axhspan(until, UNTIL, facecolor="none", edgecolor="0.5", hatch="///", linewidth=0)
            axis.axhline(until, color="0.5", linewidth=0.8)
        axes[2].annotate(
            "BCRE unresolved",
            (37, until),
            (0, 4),
            textcoords="offset points",
            fontsize=9,
            backgroundcolor="white",
        )
    return figure


def _rounded(values: Array) -> Array:
    """To four digits, so that every machine finds the same contours."""
    return np.array([[significant(float(value), 4) for value in row] for row in values])


# The phase diagram


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
    figure, (axis,) = _panels(1, 1, width=4.7, height=3.7)
    axis.fill_between(pulse, 0, own, color="0.55", alpha=0.08, linewidth=0)
    axis.fill_between(pulse, own, finer, color=CA, alpha=0.30, linewidth=0)
    axis.fill_between(pulse, finer, bcre, color=CA, alpha=0.13, linewidth=0)
    axis.fill_between(pulse, bcre, TOP, color=PDE, alpha=0.10, linewidth=0)
    axis.plot(pulse, own, **AUTOMATON.line, marker="o", label="automaton, d = 1")
    axis.plot(
        pulse,
        finer,
        color=CA,
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


def _percentage(value: float, _: object) -> str:
    return f"{100 * value:g} %" if value <= 1 else ""


# What the cells explain


def shares(comparison: pd.DataFrame) -> Figure:
    """Every scene's difference as it stands and with both coefficients, by cell length.

    Parameters
    ----------
    comparison: the table of ``modified_equation``.
    """
    table = comparison[comparison["split"] == "space"]
    scenes = list(dict.fromkeys(table["scene"]))
    scenes.sort(key=lambda name: -float(table[table["scene"] == name]["nominal"].iloc[0]))
    figure, (axis,) = _panels(1, 1, width=4.7, height=5.4)
    ticks: list[float] = []
    labels: list[str] = []
    y = 0.0
    for scene in scenes:
        rows = table[table["scene"] == scene].sort_values("d", ascending=False)
        axis.annotate(
            figure_name(scene),
            (0, y),
            (-4, 0),
            weight="bold",
            va="center",
            ha="right",
            xycoords=axis.get_yaxis_transform(),
            textcoords="offset points",
        )
        y += 1
        for row in rows.itertuples():
            _share_row(axis, y, row)
            ticks.append(y)
            labels.append(f"d = {row.d:g}")
            y += 1
        y += 0.5
    axis.set(xscale="log", ylim=(y - 0.3, -0.8), xlim=(3e-5, 20))
    axis.set_yticks(ticks, labels)
    axis.tick_params(axis="y", length=0)
    axis.grid(visible=False, axis="y")
    axis.xaxis.set_major_formatter(FuncFormatter(_percentage))
    axis.set_xlabel("difference of the rolling layer R")
    handles = [
        axis.plot([], [], **BCRE.markers(markersize=6), label="from BCRE")[0],
        axis.plot(
            [],
            [],
            marker="^",
            color=EFFECTIVE,
            linestyle="",
            markersize=7,
            label="what is left once the cells are counted",
        )[0],
        axis.plot([], [], **BCRE.markers(hollow=True, markersize=6), label="BCRE unresolved")[0],
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=2)
    return figure


def _share_row(axis: Axes, y: float, row: Any) -> None:
    resolved = row.verdict != "unresolved"
    look: dict[str, Any] = {
        "linewidth": 2.2,
        "color": EFFECTIVE if resolved else "0.55",
        "alpha": 0.45,
    }
    axis.plot([row.both, row.nominal], [y, y], **look)
    axis.plot(row.nominal, y, **BCRE.markers(hollow=not resolved, markersize=6))
    axis.plot(row.both, y, marker="^", color=EFFECTIVE, linestyle="", markersize=7)
    text = f"{100 * row.explained:.0f} % explained" if resolved else "unresolved"
    axis.annotate(
        text,
        (row.nominal, y),
        (9, 0),
        textcoords="offset points",
        va="center",
        fontsize=8.5,
        color="0.25" if resolved else "0.5",
    )


def _panels(rows: int, columns: int, *, width: float, height: float) -> tuple[Figure, list[Axes]]:
    """Panels of a size of their own, in the look of all figures."""
    mpl.rcParams.update(style.RC)
    figure = Figure(figsize=(width * columns, height * rows), layout="constrained")
    axes = np.atleast_1d(figure.subplots(rows, columns))
    return figure, list(axes.ravel())
