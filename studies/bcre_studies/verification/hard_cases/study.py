r"""Hard scenes in both models: what happens, and what a model that fails says of it.

Every scene (``hard_scenes``) runs in the automaton with the schemes upwind,
calibrated and limited, with the step that follows its bounds and where named with a fixed one, and
in BCRE with its default method on the same cells. It ends in one of

    survives                                    finite layers at the end
    survives with the step lowered N times      the same, and "auto" had to shorten its step
    refused before the start                    a step or a grid that is known to be impossible
    fails                                       stopped on the way: where, when and by which bound

Both models know flow in one direction only. Where the surface rises in x, S < 0, the exchange
gamma R (S - Sc) deposits, the faster the steeper, while R is still carried on in x, there uphill,
and dies out over a length v/(gamma (Sc - S)). So what crosses the bottom of a valley is laid down
as a wedge on its far side, and what falls before a hill mostly does not reach the top. Neither is
what sand does there; it is what the equations say, in both models.

Past the shock of the climbing wave, and for the scarp of figure 1, BCRE with kappa = 0 has
no solution that its grid would converge to. The table ``scarp`` refines both: max R and place of
the scarp at t = 250 with kappa = 0 and kappa = 0.005, and the automaton, whose cell takes the
part of the curvature term, kappa_eff = gamma d/2, so that it too depends on its grid.

The tables ``scarp`` and ``adaptive_step`` are those of the modules ``scarp_grids`` and
``adaptive_step``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pandas as pd

from bcre_studies.models.registry import AUTOMATON, BCRE, Look
from bcre_studies.reporting import style
from bcre_studies.sweeps.parallel import each
from bcre_studies.verification.hard_cases import adaptive_step, claims, scarp_grids
from bcre_studies.verification.hard_cases.attempts import (
    FAILS,
    REFUSED,
    SCHEMES,
    attempts,
    tried,
)
from bcre_studies.verification.hard_cases.hard_scenes import long_run, scenes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from bcre_studies.comparison.claim import Claim

Tables = dict[str, pd.DataFrame]


def run() -> Tables:
    """One row a scene and model; the scarp, grid by grid; steps that adapt."""
    cases = [case for scene in [*scenes().values(), long_run()] for case in attempts(scene)]
    return {
        "comparison": pd.DataFrame(each(tried, cases, "hard_cases")),
        "scarp": scarp_grids.run(),
        "adaptive_step": adaptive_step.run(),
    }


def judge(tables: Tables) -> list[Claim]:
    """Finite numbers, mass, failures that say where; the scarp; steps that adapt."""
    return claims.judge(tables)


def draw(tables: Tables) -> Figure:
    """What came of every scene and model; the scarp on finer and finer grids."""
    from matplotlib.figure import Figure

    style.use()
    figure = Figure(figsize=(11.0, 7.4), layout="constrained")
    axes = figure.subplot_mosaic([["runs", "max_R"], ["runs", "place"]], width_ratios=[1.25, 1])
    _draw_runs(axes["runs"], tables["comparison"])
    for key, label in (("max_R", "max R"), ("place", "place of the scarp x")):
        scarp_grids.draw(axes[key], tables["scarp"], key, label)
    axes["max_R"].set_title("figure 1 at t = 250, on finer and finer grids", loc="left")
    axes["max_R"].legend()
    return figure


COLUMNS = {
    (AUTOMATON.name, scheme, step): scheme if step == "auto" else f"{scheme}, fixed"
    for step in ("auto", "fixed")
    for scheme in SCHEMES
} | {(BCRE.name, "", ""): BCRE.label}
MARKS: dict[str, Look] = {
    "survives": {"marker": "o", "color": "#3b8f5a"},
    "survives, step lowered": {"marker": "v", "color": "#c9962b"},
    REFUSED: {"marker": "s", "color": "#1f5a99", "markerfacecolor": "none"},
    FAILS: {"marker": "X", "color": "#a01c1c"},
}


def _draw_runs(axis: Axes, table: pd.DataFrame) -> None:
    names = list(dict.fromkeys(table["scene"]))
    columns = list(COLUMNS)
    found: dict[str, list[tuple[int, int]]] = {mark: [] for mark in MARKS}
    for row in table.itertuples():
        step = "fixed" if row.step not in ("", "auto") else row.step
        word = str(row.verdict)
        mark = "survives, step lowered" if "lowered" in word else word
        place = columns.index((row.model, row.scheme, step)), names.index(row.scene)
        found[mark].append(place)
    for mark, places in found.items():
        if places:
            x, y = zip(*places, strict=True)
            axis.plot(x, y, linestyle="", markersize=7, label=mark, **MARKS[mark])
    axis.set_xticks(range(len(columns)), list(COLUMNS.values()), rotation=35, ha="right")
    axis.set_yticks(range(len(names)), names)
    axis.set(xlim=(-0.5, len(columns) - 0.5), ylim=(len(names) - 0.5, -0.5))
    axis.legend(loc="lower center", bbox_to_anchor=(0.3, 1.0), ncols=2)
