"""Speed by size, and against what the machine allows: the committed record, judged.

Rates are cell-steps per second with sand rolling on all cells, from N = 1e2 to 1e7. The limits are
measured in the same run: 7 additions a cell on data in the cache, and one pass over memory that
reads and writes h and R. The real-time budget is the finest grid on which a figure of the paper is
played at 60 frames a second, its 600 frames equally far apart; on a plane the side of the largest
square. A plane with sand rolling on every cell is set against NumPy, a pass over memory, two
threads, BCRE's right-hand side, and py-pde's from expressions. Figure 1 is timed in every model on
equal cells, each with its longest stable step.

``make speed`` measures; what stands here is the record in ``reports/speed``, which names its
machine. ``make reports`` measures the ratios of the machine at hand into ``reports/local``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pandas as pd

from bcre_studies.comparison.claim import Claim, quality_check
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.comparison.wording import joined, sentences, when
from bcre_studies.models.registry import (
    ARADIAN,
    AUTOMATON,
    BCRE,
    HADELER_KUTTLER,
    SLOPE_DRIVEN_AUTOMATON,
    THICK_AUTOMATON,
)
from bcre_studies.performance.record.record import recorded
from bcre_studies.reporting import style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PAPERS_CELLS = 100
"""Cells of d = 1, as in the paper, of a slope as long as our scenes of its figures."""

WHY_RATIO = (
    "each goal stands beside its ratio; the median over rounds in which both sides take turns, the "
    "range over the rounds behind it"
)


TWO_PROCESSORS = 1.8
WHY_BUSY = (
    "a goal that is missed decides nothing where two threads that share nothing did less than "
    f"{TWO_PROCESSORS:g} times as much as one"
)


def run() -> dict[str, pd.DataFrame]:
    """The recorded ratios, rates by size, budget and first use."""
    comparison = recorded("ratios")["ratios"]
    others = recorded("sizes", "budget", "models", "plane", "plane_budget", "first_use", "machine")
    return {"comparison": comparison, **others}


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """Every ratio against its goal; the pile that keeps 60 frames a second."""
    ratios, budget = tables["comparison"], tables["budget"]
    missed = ratios[ratios["median"] < ratios["goal"]]
    shown = missed if len(missed) else ratios
    papers = budget[budget["model"] == "automaton, upwind"]
    least = papers.loc[papers["cells"].idxmin()]
    pde = budget[budget["model"].str.startswith("PDE")]
    of_automaton = ", ".join(f"{row.scene} {row.cells:.2g} cells" for row in papers.itertuples())
    of_pde = ", ".join(f"{row.scene} {row.cells:.2g}" for row in pde.itertuples())
    return [
        quality_check(
            name="ratios",
            statement="The compiled automaton is as fast as its goals say.",
            verdict=Verdict.DISAGREE if len(missed) else Verdict.AGREE,
            evidence=f"{len(ratios) - len(missed)} of {len(ratios)} ratios reach their goal: "
            + "; ".join(
                f"{row.ratio} {row.median:.3g} (goal {row.goal:.3g})" for row in shown.itertuples()
            ),
            tolerance=WHY_RATIO,
        ),
        Claim(
            name="interactive",
            statement="The paper's automaton plays the paper's figures at 60 frames a second.",
            verdict=Verdict.AGREE if least["cells"] >= PAPERS_CELLS else Verdict.DISAGREE,
            evidence=f"with up to {of_automaton}; BCRE's solver with up to {of_pde} cells",
            tolerance=f"at least the {PAPERS_CELLS} cells of the scene in a sixtieth of a second, "
            "one core, drawing not counted",
        ),
        _plane_ratios(tables["plane"]),
        _interactive_plane(tables["plane_budget"]),
        _models_claim(tables["models"]),
    ]


def _models_claim(rows: pd.DataFrame) -> Claim:
    """Every model on figure 1, and whether an automaton of two layers beats its equation."""
    times = rows.pivot(index="cells", columns="model", values="seconds_per_time")
    pairs = {
        AUTOMATON: BCRE,
        THICK_AUTOMATON: ARADIAN,
        SLOPE_DRIVEN_AUTOMATON: HADELER_KUTTLER,
    }
    gains = {rule.text: times[model.text] / times[rule.text] for rule, model in pairs.items()}
    faster = joined(
        f"{name} {gain.min():.3g} to {gain.max():.3g} times" for name, gain in gains.items()
    )
    least = min(gain.min() for gain in gains.values())
    finest = rows[rows["cells"] == rows["cells"].max()]
    listed = "; ".join(f"{row.model} {row.seconds_per_time:.2g}" for row in finest.itertuples())
    return Claim(
        name="models on figure 1",
        statement="On equal cells the automaton of each closure is faster than its model.",
        verdict=Verdict.AGREE if least > 1 else Verdict.DISAGREE,
        evidence=f"{faster} as fast as the model. Seconds per unit of time on "
        f"{finest['cells'].iloc[0]} cells: {listed}",
        tolerance="a ratio of 1; errors differ, see ``speed_error``",
    )


def _plane_ratios(rows: pd.DataFrame) -> Claim:
    missed = rows[rows["median"] < rows["goal"]]
    return quality_check(
        name="ratios on a plane",
        statement="The compiled automaton on a plane is as fast as its goals say.",
        verdict=_unless_busy(len(missed) == 0, rows),
        evidence=sentences(
            "; ".join(
                f"{row.ratio} {row.median:.3g} (goal {row.goal:.3g})" for row in rows.itertuples()
            ),
            _said_of_others(rows),
        ),
        tolerance=f"{WHY_RATIO}; {WHY_BUSY}",
    )


def _interactive_plane(rows: pd.DataFrame) -> Claim:
    wanted = rows.dropna(subset="goal")
    return Claim(
        name="interactive on a plane",
        statement="A plane of the figures' materials plays at 60 frames a second.",
        verdict=_unless_busy(bool((wanted["side"] >= wanted["goal"]).all()), rows),
        evidence=sentences(
            "; ".join(
                f"{row.scene}, {row.threads} thread{'s' * (row.threads > 1)}: {row.side:.0f} x "
                f"{row.side:.0f} cells"
                for row in rows.itertuples()
            ),
            _said_of_others(rows),
        ),
        tolerance=" and ".join(
            f"{row.goal:.0f} x {row.goal:.0f} cells of {row.scene}" for row in wanted.itertuples()
        )
        + f" on two threads, drawing not counted; {WHY_BUSY}",
    )


def _unless_busy(good: bool, rows: pd.DataFrame) -> Verdict:
    if good:
        return Verdict.AGREE
    return (
        Verdict.UNRESOLVED
        if rows["two_threads_at_best"].min() < TWO_PROCESSORS
        else Verdict.DISAGREE
    )


def _said_of_others(rows: pd.DataFrame) -> str:
    gain = float(rows["two_threads_at_best"].min())
    return when(
        gain < TWO_PROCESSORS,
        f"two threads that share nothing did {gain:.2g} times as much as one meanwhile",
    )


def draw(tables: dict[str, pd.DataFrame]) -> Figure:
    """Rates by size with the two limits; cells at 60 frames a second."""
    sizes, budget = tables["sizes"], tables["budget"]
    figure, (rates, frames) = style.panels(1, 2)
    for (name, rows), marker in zip(sizes.groupby("model", sort=False), "ovDs.", strict=True):
        rates.loglog(rows["cells"], rows["cell_steps_per_s"], marker=marker, label=name)
    upwind = sizes[sizes["model"] == "upwind"]
    for share, dashes, label in (
        ("share_of_additions", (0, (5, 2)), "7 additions a cell"),
        ("share_of_a_pass", (0, (1, 1.5)), "one pass over memory a step"),
    ):
        limit = upwind["cell_steps_per_s"] / upwind[share]
        rates.loglog(upwind["cells"], limit, color="0.5", linestyle=dashes, label=label)
    rates.set_xlabel("cells N")
    rates.set_ylabel("cell-steps per second")
    rates.legend(fontsize=7)
    shown = budget.pivot_table(index="scene", columns="model", values="cells", sort=False)
    shown.plot.bar(ax=frames, logy=True, rot=0, width=0.8)
    frames.set_xlabel("")
    frames.set_ylabel("cells at 60 frames a second")
    frames.legend(fontsize=7)
    return figure
