r"""Speed against error: what a cell-step, and what a second, buys in each model.

Compared at the end of a scene are the relative L1 errors of R and of h (of what moved), the place
of the downhill front and the mean slope, on grids twice as fine each, of the automaton with the
paper's upwind rule, calibrated (D and kappa lessened by what the rule adds of its own) and
flux-limited, and of BCRE by each method of its solver. The truth is the exact solution for the
nonlinear wave, else BCRE on 400, 800 and 1600 cells with the error that their grid convergence
index gives. Errors against cell-steps (of BCRE: cells times evaluations of the right-hand side) are
the same on every machine and stand here.

Seconds are those of the committed record (``reports/speed``, made by ``make speed`` on the machine
that it names), where also what a user would pick instead takes part: the rule in plain NumPy,
py-pde's expressions (on two scenes: they compile for half a minute a grid), SciPy's LSODA on the
method of lines (its band holds for open ends only, on the nonlinear wave it has none), FiPy (a few
coarse grids: a step takes a millisecond and more). All times of a scene come from one
run in which all take turns; a time is the median of at least five rounds. Where the paper's rule
reaches an error on no grid tried, its time is a lower bound, by first order from its finest grid:
half the error takes at least twice the cells and four times the cell-steps.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import pandas as pd

from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.rounding import significant
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.comparison.wording import joined, sentences, when
from bcre_studies.models.registry import SCHEMES
from bcre_studies.performance.record import contest, work_precision
from bcre_studies.performance.record.record import TARGETS, cheapest, recorded
from bcre_studies.sweeps.parallel import each

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PAPERS, *BETTER = (scheme.label for scheme in SCHEMES.values())
TRUTH_SHARE = 0.1
"""An error is reported only where the reference's own error is below this part of it."""
WHY_TIME = (
    "a time is the shortest among the grids measured whose error of R is no more than the one "
    "asked for; two models differ where the ratio of their medians in one run excludes 1"
)


def run() -> dict[str, pd.DataFrame]:
    """Errors on every grid, and the fewest cell-steps that reach an error."""
    record = recorded("contest", "reach")
    cases = [(label, index) for label in contest.scenes() for index in range(len(contest.own()))]
    rows = [row for rows in each(_errors_of, cases, "speed_error") for row in rows]
    errors = pd.DataFrame(rows)
    return {
        "comparison": fewest_cell_steps(errors),
        "errors": errors,
        **{f"recorded_{name}": table for name, table in record.items()},
    }


def _errors_of(case: tuple[str, int]) -> list[dict[str, Any]]:
    label, index = case
    contender, scene = contest.own()[index], contest.scenes()[label]
    finest = contest.truth_of(scene).error / TRUTH_SHARE
    rows = []
    for cells, _, end in contest.rungs(contender, scene):
        row = contest.row_of(label, contender, cells, end)
        if row["error_R"] >= finest:
            rows.append(
                row
                | {name: significant(value, 2) for name, value in row.items() if name in ERRORS}
                | counted(row)
            )
    return rows


ERRORS = ("error_R", "error_h", "error_front", "error_slope")


def counted(row: dict[str, Any]) -> dict[str, Any]:
    """Steps and cell-steps; of adaptive solvers two digits, since the last bits decide on them."""
    return {name: int(significant(row[name], 2)) for name in ("steps", "cell_steps")}


def fewest_cell_steps(errors: pd.DataFrame) -> pd.DataFrame:
    """Per scene and contender, the fewest cell-steps that reach each error of R."""
    rows = []
    for (label, contender), group in errors.groupby(["scene", "contender"], sort=False):
        row: dict[str, Any] = {"scene": label, "contender": contender}
        for target in TARGETS:
            best = cheapest(group, target, "cell_steps")
            row[f"cell-steps to {_percent(target)}"] = (
                "not reached" if best is None else f"{best['cell_steps']:.2g}"
            )
        rows.append(row)
    return pd.DataFrame(rows)


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """Where the automaton is the more efficient, and where the PDE is."""
    claims = [_fewer_cell_steps(tables["errors"])]
    if "recorded_reach" in tables:
        seconds = tables["recorded_reach"]
        claims = [_efficiency(seconds), _coarse(seconds), _improved(seconds), *claims]
    return claims


def _winners(seconds: pd.DataFrame, ours: Sequence[str]) -> list[dict[str, Any]]:
    """Per scene and error: the best of ours against the best of BCRE's methods."""
    rows = []
    for (label, target), group in seconds.groupby(["scene", "error"], sort=False):
        mine = group[group["contender"].isin(ours)]
        pde = group[group["contender"].str.startswith("PDE")]
        fastest = mine["seconds"].min() if len(mine) else math.inf
        bound = group["automaton_s"].fillna(math.inf).iloc[0]
        rows.append(
            {
                "scene": label,
                "error": target,
                "ours": fastest,
                "BCRE": pde["seconds"].min() if len(pde) else math.inf,
                "at_least": fastest if len(mine) else bound,
            }
        )
    return rows


def _won(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    return [row for row in rows if row["ours"] < row["BCRE"]]


def _efficiency(seconds: pd.DataFrame) -> Claim:
    papers, better = _winners(seconds, (PAPERS,)), _winners(seconds, BETTER)
    won = _won(papers)
    return Claim(
        name="efficiency",
        statement="At equal error the paper's automaton takes less time than BCRE's solver.",
        verdict=Verdict.AGREE if len(won) == len(papers) else Verdict.DISAGREE,
        evidence=f"{_where_it_wins(papers)}. {_where_the_pde_wins(papers)}. "
        f"{_what_better_rules_win(better)}",
        tolerance=WHY_TIME,
    )


def _where_it_wins(rows: list[dict[str, Any]]) -> str:
    won = _won(rows)
    coarse = [row for row in won if row["error"] == TARGETS[0]]
    least, most = _span([row["BCRE"] / row["ours"] for row in coarse])
    return (
        f"the paper's automaton is the faster in {len(won)} of {len(rows)} pairs of scene and "
        f"error; at 10 % in {len(coarse)} of {len({row['scene'] for row in rows})} scenes, by "
        f"{least:.2g} to {most:.2g} times, and at 0.1 % in "
        + (" and ".join(row["scene"] for row in won if row["error"] == TARGETS[-1]) or "none")
    )


def _where_the_pde_wins(rows: list[dict[str, Any]]) -> str:
    lost = [row for row in rows if row["ours"] > row["BCRE"]]
    bounded = [row for row in lost if math.isfinite(row["at_least"])]
    never = sorted({row["scene"] for row in lost if math.isinf(row["at_least"])})
    by = ", ".join(
        f"{_percent(target)} by {least:.2g} to {most:.2g} times"
        for target in TARGETS
        for least, most in [
            _span([r["at_least"] / r["BCRE"] for r in bounded if r["error"] == target])
        ]
        if most > 0
    )
    sentence = f"BCRE's solver is the faster in {len(lost)}"
    if by:
        sentence += f": at {by}, or more where the automaton reached the error on no grid tried"
    if never:
        sentence += (
            f"; the automaton never does in {' and '.join(never)}, where its error grows as its "
            "cells, and with them its curvature, get smaller"
        )
    return sentence


def _what_better_rules_win(rows: list[dict[str, Any]]) -> str:
    down_to_1 = [row for row in rows if row["error"] >= 0.01]
    finest = [row for row in rows if row["error"] == TARGETS[-1]]
    won = _won(down_to_1)
    least, most = _span([row["BCRE"] / row["ours"] for row in won])
    return (
        f"Calibrated or flux-limited, the automaton is the faster in {len(won)} of "
        f"{len(down_to_1)} pairs down to 1 %, by {least:.2g} to {most:.2g} times, and in "
        f"{len(_won(finest))} of {len(finest)} at 0.1 %"
    )


def _span(ratios: list[float]) -> tuple[float, float]:
    return (min(ratios), max(ratios)) if ratios else (0.0, 0.0)


def _percent(target: float) -> str:
    return f"{100 * target:g} %"


def _race(row: dict[str, Any]) -> str:
    mine = _ms(row["ours"])
    if math.isinf(row["ours"]):
        bound = row["at_least"]
        mine = f"at least {_ms(bound)}" if math.isfinite(bound) else "never"
    return f"{row['scene']} at {_percent(row['error'])}: {mine} against {_ms(row['BCRE'])}"


def _ms(seconds: float) -> str:
    if math.isinf(seconds):
        return "not reached"
    if seconds > 100:
        return f"{seconds:.1g} s"
    return f"{seconds:.2g} s" if seconds >= 1 else f"{1000 * seconds:.2g} ms"


def _coarse(seconds: pd.DataFrame) -> Claim:
    """The condition is one of the scene, not of what the automaton reaches."""
    rows = [row for row in _winners(seconds, (PAPERS,)) if row["error"] == TARGETS[0]]
    judged = [row for row in rows if row["scene"] != contest.PAST_SCARP]
    past = [row for row in rows if row["scene"] == contest.PAST_SCARP]
    return Claim(
        name="efficiency at 10 %",
        statement="Where an error of 10 % does, the paper's automaton is faster than BCRE's "
        "solver, but for figure 1 past its scarp.",
        verdict=Verdict.AGREE if judged == _won(judged) != [] else Verdict.DISAGREE,
        evidence=sentences(
            _races(judged), when(past, f"past the scarp: {'; '.join(map(_race, past))}")
        ),
        tolerance=WHY_TIME,
    )


def _races(rows: list[dict[str, Any]]) -> str:
    return f"the automaton is faster in {len(_won(rows))} of {len(rows)} cases: " + joined(
        map(_race, rows), "; "
    )


def _improved(seconds: pd.DataFrame) -> Claim:
    rows = [row for row in _winners(seconds, BETTER) if row["error"] >= 0.01]
    return Claim(
        name="efficiency, better rules",
        statement="Down to 1 % the calibrated or the flux-limited automaton is faster than BCRE's "
        "solver.",
        verdict=Verdict.AGREE if _won(rows) == rows else Verdict.DISAGREE,
        evidence=_races(rows),
        tolerance=WHY_TIME,
    )


def _fewer_cell_steps(errors: pd.DataFrame) -> Claim:
    """Down to 1 %, in cell-steps, which are the same on every machine."""
    lines, fewer = [], []
    for label, group in errors.groupby("scene", sort=False):
        best = {
            name: cheapest(group[group["contender"] == name], 0.01, "cell_steps")
            for name in (PAPERS, *BETTER)
        }
        least = {name: math.inf if row is None else row["cell_steps"] for name, row in best.items()}
        papers, better = least[PAPERS], min(least[name] for name in BETTER)
        fewer.append(better < papers)
        against = "on no grid tried" if math.isinf(papers) else f"against {papers:.2g}"
        lines.append(f"{label}: {better:.2g} {against}")
    return Claim(
        name="what better rules buy",
        statement="The better of the calibrated and the flux-limited rule reaches 1 % in fewer "
        "cell-steps than the paper's.",
        verdict=Verdict.AGREE if all(fewer) else Verdict.DISAGREE,
        evidence="; ".join(lines),
        tolerance="fewer cell-steps on the cheapest grid of error 1 % or less",
    )


def draw(tables: dict[str, pd.DataFrame]) -> Figure:
    """Error of R against cell-steps, and against the recorded seconds, one column a scene."""
    return work_precision.draw(tables["errors"], tables.get("recorded_contest"))
