r"""What an avalanche moves: how much, how far, and when. The paper's words, one number for each.

* *Left*: area of h at the end of figure 1, over that at the start. At S = Sc on the whole slope
  there is left, with a last cell of length d that keeps its height,

      Sc/S0 + (1 - Sc/S0) d/L

* *Grown*: part of the slope on which R at some time exceeds the pulse that was released.
* *Even*: largest |S - Sc| from cell to cell at the end, from a tenth to nine tenths of the way.
* *Rolling*: most sand that rolls at any time, over the pulse. Below repose E = gamma R (S - Sc) is
  negative, so that it can only fall; it has grown where more rolls than was released.
* *Travelled* and *spread*: how far the pulse of figure 2 moves, v t, and by how much its standard
  deviation grows, from w/sqrt(2) to sqrt(w^2/2 + 2 D t).

Figure 1 runs to t = 2000 with dt = 0.2, figure 2 to its end; BCRE on 200 cells.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.rounding import significant
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.comparison.wording import sentences, when
from bcre_studies.models.registry import AUTOMATON, BCRE, COMPARED, MODELS
from bcre_studies.models.run import Run, frame_times
from bcre_studies.observables.outcome import slope
from bcre_studies.reporting import style
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.scene import Scene, load
from bcre_studies.sweeps.parallel import each

if TYPE_CHECKING:
    from matplotlib.figure import Figure

CELLS = 200
FRAMES = 101
"""Whole steps of either figure lie between them."""
LEFT, GROWN, EVEN, ROLLING = "left", "grown", "even", "rolling"
TRAVELLED, SPREAD = "travelled", "spread"
ASKED = {"figure1": (LEFT, GROWN, EVEN, ROLLING), "figure2": (ROLLING, TRAVELLED, SPREAD)}
LAST_DIGIT = 6
"""Decimals that are kept: what is smaller is rounding."""
COLUMNS = [AUTOMATON.column, BCRE.column]
NOTHING = 0.01
WHY_NOTHING = "one cell of the hundred"
EVENNESS = 0.01
WHY_EVEN = "2 % of Sc, half a degree: as near as an angle of repose is measured"
Row = dict[str, Any]


def run() -> dict[str, pd.DataFrame]:
    """One row a quantity and scene, with the closed form if there is one; first and last layers."""
    found = each(measured, tuple(ASKED), "avalanche_extent")
    return {
        "comparison": pd.DataFrame([row for rows, _ in found for row in rows]),
        "profiles": pd.concat([table for _, table in found], ignore_index=True),
    }


def measured(name: str) -> tuple[list[Row], pd.DataFrame]:
    """The quantities of one of the two figures in all models, and their layers at both ends."""
    scene = load(name)
    if name == "figure1":
        scene = scene.with_changes(until=2000.0, step=0.2)
    times = frame_times(scene, FRAMES)
    runs = {
        model: model.run(scene, times, None if model is AUTOMATON else CELLS) for model in COMPARED
    }
    found = {model: quantities(run) for model, run in runs.items()}
    expected = closed_forms(scene)
    rows = [
        {"quantity": quantity, "case": name}
        | {model.column: shown(found[model][quantity]) for model in COMPARED}
        | {"expected": shown(expected.get(quantity, np.nan))}
        for quantity in ASKED[name]
    ]
    ends = [_ends(run).to_dataframe(case=name) for run in runs.values()]
    return rows, pd.concat(ends)


def shown(value: float) -> float:
    """Four digits, and what is not rounding."""
    return significant(round(value, LAST_DIGIT), 4)


def _ends(run: Run) -> Run:
    return replace(run, t=run.t[[0, -1]], h=run.h[[0, -1]], R=run.R[[0, -1]])


def quantities(run: Run) -> dict[str, float]:
    """All of them; which of them mean something depends on the scene."""
    Sc, L = run.scene.material.Sc, run.scene.domain.length
    inner = (run.x >= L / 10) & (run.x <= 9 * L / 10)
    rolling = run.R.sum(axis=1)
    (start, narrow), (end, wide) = (_place(run.x, run.R[frame]) for frame in (0, -1))
    return {
        LEFT: float(run.h[-1].sum() / run.h[0].sum()),
        GROWN: float(np.mean(run.R.max(axis=0) > run.R[0].max())),
        EVEN: float(np.abs(-np.diff(run.h[-1][inner]) / run.d - Sc).max()),
        ROLLING: float(rolling.max() / rolling[0]),
        TRAVELLED: end - start,
        SPREAD: wide - narrow,
    }


def _place(x: Array, R: Array) -> tuple[float, float]:
    """Mean and standard deviation of the layer."""
    if not R.any():
        return np.nan, np.nan
    mean = float(R @ x / R.sum())
    return mean, float(np.sqrt(R @ (x - mean) ** 2 / R.sum()))


def closed_forms(scene: Scene) -> dict[str, float]:
    """What is left of the automaton's wedge at repose; a pulse that only drifts and diffuses."""
    m, x, until = scene.material, scene.centres(), scene.time.until
    h, R = scene.initial(x)
    part = m.Sc / slope(x, h)
    _, width = _place(x, R)
    return {
        LEFT: part + (1 - part) * scene.d / scene.domain.length,
        TRAVELLED: m.v * until,
        SPREAD: float(np.sqrt(width**2 + 2 * m.D * until) - width),
    }


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """The paper's five statements, each in both models."""
    table = tables["comparison"].set_index(["case", "quantity"])
    left, grown, even, rolls = (table.loc["figure1", q] for q in (LEFT, GROWN, EVEN, ROLLING))
    below, travelled, spread = (table.loc["figure2", q] for q in (ROLLING, TRAVELLED, SPREAD))
    at_repose = abs(left.automaton - left["expected"]) <= NOTHING
    return [
        _claim(
            "static layer",
            "In figure 1 the static layer loses all of its matter.",
            (left[COLUMNS] <= NOTHING).all(),
            sentences(
                f"{left.automaton:.1%} of it is left in the automaton and {left.pde:.1%} in BCRE",
                when(
                    at_repose,
                    f"that is the wedge at repose, Sc/S0 and the last cell "
                    f"({left['expected']:.1%}): almost zero only where S0 is far above Sc",
                ),
            ),
            f"{NOTHING:.0%} of the area at the start: {WHY_NOTHING}",
        ),
        _claim(
            "rolling layer",
            "In figure 1 the rolling layer grows along the whole slope.",
            (grown[COLUMNS] >= 1 - NOTHING).all(),
            f"it passes the pulse's height on {grown.automaton:.1%} of the slope in the automaton "
            f"and on {grown.pde:.1%} in BCRE; at most {rolls.automaton:.3g} and {rolls.pde:.3g} "
            "times the sand of the pulse rolls at once",
            f"all but {NOTHING:.0%} of the slope: {WHY_NOTHING}",
        ),
        _claim(
            "even slope",
            "An avalanche that ran to the top leaves an almost homogeneous slope.",
            (even[COLUMNS] <= EVENNESS).all(),
            f"from cell to cell S differs from Sc by at most {even.automaton:.1g} in the automaton "
            f"and {even.pde:.1g} in BCRE at the end of figure 1",
            f"{EVENNESS:g}: {WHY_EVEN}",
        ),
        _claim(
            "avalanche below repose",
            "A pulse sets off an avalanche on a slope below repose (figure 2).",
            (below[COLUMNS] > 1 + NOTHING).all(),
            sentences(
                f"at most {below.automaton:.3g} times the sand of the pulse rolls at once in the "
                f"automaton and {below.pde:.3g} in BCRE",
                when((below[COLUMNS] <= 1).all(), "no more rolls than was released"),
            ),
            f"grown by {NOTHING:.0%}",
        ),
        _claim(
            "spreads, not travels",
            "The perturbation of figure 2 spreads down the slope rather than travels.",
            (spread[COLUMNS] >= travelled[COLUMNS]).all(),
            f"it travels {travelled.automaton:.3g} in the automaton and {travelled.pde:.3g} in "
            f"BCRE (v t = {travelled['expected']:g}), and its standard deviation grows by "
            f"{spread.automaton:.2g} and {spread.pde:.2g} (from D alone "
            f"{spread['expected']:.2g})",
            "it spreads by as much as it travels",
        ),
    ]


def _claim(name: str, statement: str, good: object, evidence: str, tolerance: str) -> Claim:
    verdict = Verdict.AGREE if good else Verdict.DISAGREE
    return Claim(name, statement, verdict, evidence, tolerance)


def draw(tables: dict[str, pd.DataFrame]) -> Figure:
    """The static layer of figure 1 and the rolling layer of figure 2, at the start and the end."""
    figure, axes = style.panels(1, 2)
    table = tables["profiles"]
    panels = (("figure1", "h", "static layer h"), ("figure2", "R", "rolling layer R"))
    for axis, (case, column, label) in zip(axes, panels, strict=True):
        for (name, t), line in table[table["case"] == case].groupby(["model", "t"], sort=False):
            look = MODELS[str(name)].line if t > 0 else style.START
            axis.plot(line["x"], line[column], **look)
        axis.set(xlabel="x (downhill)", ylabel=label)
        axis.set_title(f"Figure {case[-1]}: start and end", loc="left")
    style.legend(figure, COMPARED, start=True)
    return figure
