"""The scarp of figure 1 on finer and finer grids: where is BCRE well posed past t*, and by what?

With kappa = 0 the climbing wave of h steepens into a jump, ahead of which R decays over D/(v + c),
far below a cell; max R and the place of the scarp at t = 250 then go on changing from grid to grid.
A curvature term kappa = 0.005 = gamma d/2 (d = 1) gives the scarp a width that does not depend on
the grid. The automaton's own curvature kappa_eff = gamma d/2 goes with its cells.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import pandas as pd

from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.rounding import significant
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.comparison.wording import sentences, when
from bcre_studies.models.registry import AUTOMATON, BCRE, EFFECTIVE, MODELS, Model
from bcre_studies.observables.fronts import scarps
from bcre_studies.scenes.scene import load
from bcre_studies.sweeps.parallel import each

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Row = dict[str, Any]

CELLS = (200, 400, 800, 1600)
CELLS_AUTOMATON = (100, 200, 400, 800)
TIME = 250.0
RESOLVED = 0.01
WHY = "1 % of max R and of the scarp's place from the last grid but one to the last"
MEASURED = ("max_R", "place")
SERIES = {
    (BCRE, 0.0): (BCRE, "BCRE, kappa = 0"),
    (BCRE, 0.005): (EFFECTIVE, "BCRE, kappa = 0.005"),
    (AUTOMATON, 0.0): (AUTOMATON, AUTOMATON.label),
}
"""Model and kappa, whose look they have, and what they are called."""


def run() -> pd.DataFrame:
    """Max R and the scarp's place on every grid, with the change from the grid before."""
    cases = [(BCRE.name, kappa, cells) for kappa in (0.0, 0.005) for cells in CELLS]
    cases += [(AUTOMATON.name, 0.0, cells) for cells in CELLS_AUTOMATON]
    # The longest first, so that no processor waits for them at the end.
    cases.sort(key=lambda case: -case[2])
    return with_changes(each(on_grid, cases, "hard_cases, scarp"))


def on_grid(case: tuple[str, float, int]) -> Row:
    """Max R and place of the scarp of figure 1 at t = 250."""
    model, kappa, cells = case
    scene = load("figure1").with_changes(until=TIME, kappa=kappa, step=0.4 * 100 / cells)
    run = MODELS[model].run(scene, [0.0, TIME], cells)
    _, places = scarps(run)
    return {
        "model": model,
        "kappa": kappa,
        "cells": cells,
        "max_R": significant(float(run.R[-1].max()), 4),
        "place": significant(float(places[-1]), 4),
    }


def with_changes(rows: list[Row]) -> pd.DataFrame:
    """Grids in order, with the change from the one before; a model's last change decides."""
    table = []
    for model, kappa in SERIES:
        grids = sorted(
            (row for row in rows if (row["model"], row["kappa"]) == (model.name, kappa)),
            key=lambda row: int(row["cells"]),
        )
        changes: list[Row] = [
            {f"change_{key}": round(abs(fine[key] / coarse[key] - 1), 4) for key in MEASURED}
            for coarse, fine in pairwise(grids)
        ]
        resolved = max(changes[-1].values()) <= RESOLVED
        verdict = {"verdict": "resolved" if resolved else "unresolved"}
        none: Row = dict.fromkeys(changes[-1], "")
        table += [
            row | change | verdict for row, change in zip(grids, [none, *changes], strict=True)
        ]
    return pd.DataFrame(table)


def _of(table: pd.DataFrame, model: Model, kappa: float) -> pd.DataFrame:
    return table[(table["model"] == model.name) & (table["kappa"] == kappa)]


def claim(table: pd.DataFrame) -> Claim:
    """BCRE converges past the scarp with a curvature term."""

    def series(model: Model, kappa: float) -> str:
        rows = _of(table, model, kappa)
        R, place = (", ".join(f"{value:g}" for value in rows[key]) for key in ("max_R", "place"))
        return f"max R {R}, place {place} ({rows['verdict'].iloc[-1]})"

    curved = _of(table, BCRE, 0.005)
    grids = ", ".join(map(str, CELLS))
    return Claim(
        name="the scarp needs the curvature term",
        statement="Past the scarp of figure 1 BCRE converges with kappa = 0.005.",
        verdict=Verdict.AGREE if (curved["verdict"] == "resolved").all() else Verdict.DISAGREE,
        evidence=sentences(
            f"at t = {TIME:g} on {grids} cells: with kappa = 0.005 {series(BCRE, 0.005)}; with "
            f"kappa = 0 {series(BCRE, 0.0)}; the automaton, of kappa_eff = gamma d/2, on "
            f"{', '.join(map(str, CELLS_AUTOMATON))} cells: {series(AUTOMATON, 0.0)}",
            when(
                (_of(table, AUTOMATON, 0.0)["verdict"] == "unresolved").all(),
                "the automaton's curvature goes with its cell, and the scarp with it",
            ),
        ),
        tolerance=WHY,
    )


def draw(axis: Axes, table: pd.DataFrame, key: str, label: str) -> None:
    """One measured quantity against cells."""
    for (model, kappa), (look, name) in SERIES.items():
        rows = _of(table, model, kappa)
        axis.semilogx(rows["cells"], rows[key], **look.marked_line | {"label": name})
    cells = sorted(set(table["cells"]))
    axis.set_xticks(cells, [str(count) for count in cells])
    axis.minorticks_off()
    axis.set(xlabel="cells", ylabel=label)
