"""Which ingredients are needed, by what, and how much smaller a model may be."""

from __future__ import annotations

import numpy as np
import pandas as pd

from bcre_studies.comparison.claim import Claim, quality_check
from bcre_studies.comparison.rounding import significant
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.comparison.wording import sentences, when
from bcre_studies.observables.named import NAMES
from bcre_studies.performance.record import specialisation
from bcre_studies.performance.scene_needs.ablation import (
    DOUBLE,
    DRY,
    GAMMA,
    KAPPA,
    LAYER,
    NONLINEARITY,
    STEPS,
    D,
    V,
)

TOLERANCES = {"1": 0.01, "5": 0.05}
WHY = (
    "1 % is about what a measurement of a pile can tell, 5 % the width of a line in the paper's "
    "figures; the scales stand with the observables"
)
PHYSICAL = (D, V, GAMMA, KAPPA, LAYER, NONLINEARITY)


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """Which ingredients are needed, by what, and how much smaller a model may be."""
    comparison = tables["comparison"]
    scenes = {name: table for name, table in tables.items() if name != "comparison"}
    return [
        *(_needed_claim(scenes, ingredient) for ingredient in PHYSICAL),
        _stability_claim(scenes),
        *(_harmless_claim(scenes, ingredient) for ingredient in (DOUBLE, DRY)),
        _together_claim(comparison),
        *(_smaller_claim(comparison, percent) for percent in TOLERANCES),
        _specialised_claim(),
    ]


def _changes(scenes: dict[str, pd.DataFrame], ingredient: str) -> list[tuple[float, str, str]]:
    """Change, scene and observable of every observable without the ingredient, largest first."""
    found = [
        (float(row[name]), scene, name)
        for scene, table in scenes.items()
        for _, row in table[table["without"] == ingredient].iterrows()
        for name in NAMES
        if name in row and not pd.isna(row[name])
    ]
    return sorted(found, key=lambda entry: (-entry[0], entry[1:]))


def _needed_claim(scenes: dict[str, pd.DataFrame], ingredient: str) -> Claim:
    changes = _changes(scenes, ingredient)
    by_scene = {
        scene: [name for changed, where, name in changes if where == scene and changed > 0.01]
        for scene in scenes
    }
    asked = "; ".join(
        f"{scene}: {', '.join(n for n in NAMES if n in names) or 'nothing'}"
        for scene, names in by_scene.items()
    )
    largest = changes[0][0] if changes else 0.0
    return quality_check(
        name=f"{ingredient} is needed",
        statement=f"Some built-in scene needs {_called(ingredient)}: left out, it changes an "
        "observable by more than 5 %.",
        verdict=Verdict.AGREE if largest > TOLERANCES["5"] else Verdict.DISAGREE,
        evidence=f"without it changes by more than 1 %, by scene: {asked}",
        tolerance=WHY,
    )


def _called(ingredient: str) -> str:
    return {
        KAPPA: "the curvature kappa_eff that the rule adds of its own",
        LAYER: "the second layer",
        NONLINEARITY: "the nonlinearity",
    }.get(ingredient, ingredient)


def _stability_claim(scenes: dict[str, pd.DataFrame]) -> Claim:
    rows = {
        scene: table.loc[table["without"] == STEPS, "runs"].iloc[0]
        for scene, table in scenes.items()
    }
    allowed = [scene for scene, runs in rows.items() if runs == "yes"]
    return quality_check(
        name="the step is needed for stability",
        statement="No built-in scene can be run with steps twice as long.",
        verdict=Verdict.DISAGREE if allowed else Verdict.AGREE,
        evidence=f"refused in {len(rows) - len(allowed)} of {len(rows)} scenes; allowed in "
        f"{', '.join(allowed) or 'none'}",
        tolerance="the upwind rule's own bound, which takes no tolerance",
    )


def _harmless_claim(scenes: dict[str, pd.DataFrame], ingredient: str) -> Claim:
    changes = _changes(scenes, ingredient)
    changed, scene, name = changes[0]
    rows = [table[table["without"] == ingredient].iloc[0] for table in scenes.values()]
    costs = [float(row["cost"]) for row in rows if row["runs"] == "yes"]
    refused = len(rows) - len(costs)
    harmless = changed <= TOLERANCES["1"] and not refused
    return quality_check(
        name=f"{ingredient} left out",
        statement={
            DOUBLE: "Single precision is enough for every observable of every scene.",
            DRY: "Cells that have fallen dry can be cut off without a change of any observable, at "
            "the cost that the cut-off itself has.",
        }[ingredient],
        verdict=Verdict.AGREE if harmless else Verdict.DISAGREE,
        evidence=f"the largest change is {changed:.2g}, of {name} in {scene}; {refused} runs are "
        f"refused; a run costs {min(costs):.2g} to {max(costs):.2g} of the full one",
        tolerance=WHY,
    )


def _together_claim(table: pd.DataFrame) -> Claim:
    broken = [
        f"{row['scene']} {row['observable']} at {percent} %"
        for percent, tolerance in TOLERANCES.items()
        for _, row in table.iterrows()
        if not row[f"together_{percent}"] <= tolerance
    ]
    cases = len(table) * len(TOLERANCES)
    return quality_check(
        name="left out together",
        statement="What can be left out one by one can be left out together.",
        verdict=Verdict.DISAGREE if broken else Verdict.AGREE,
        evidence=sentences(
            f"{cases - len(broken)} of {cases} combinations hold",
            when(
                broken,
                f"ingredients matter only together, and have been put back, in {'; '.join(broken)}",
            ),
        ),
        tolerance=WHY,
    )


def _smaller_claim(table: pd.DataFrame, percent: str) -> Claim:
    cost, changed = table[f"cost_{percent}"], table[f"change_{percent}"]
    holds = bool((changed <= TOLERANCES[percent]).all())
    least, most = table.loc[cost.idxmin()], table.loc[cost.idxmax()]
    return quality_check(
        name=f"smallest models within {percent} %",
        statement=f"For every observable of every scene a cheaper model gives it within {percent} "
        "%.",
        verdict=Verdict.AGREE if holds and float(cost.max()) < 1 else Verdict.DISAGREE,
        evidence=f"median cost {significant(float(np.median(cost)), 2):g} of the full model; from "
        f"{least[f'cost_{percent}']:g} ({least['scene']}, {least['observable']}: "
        f"{least[f'smallest_{percent}']}) to {most[f'cost_{percent}']:g} ({most['scene']}, "
        f"{most['observable']}: {most[f'smallest_{percent}']})",
        tolerance=WHY,
    )


def _specialised_claim() -> Claim:
    statement = "Leaving an absent D, kappa, v_up or cut-off out of the compiled code saves time."
    tolerance = "a ratio above 1 for each term and number of cells of the recorded measurement"
    name = "specialised kernels"
    table = specialisation.recorded()
    ratios = "; ".join(
        f"{term} " + ", ".join(f"{row.ratio:g} ({row.cells:g} cells)" for row in rows.itertuples())
        for term, rows in table.groupby("term", sort=False)
    )
    own = table[table["term"].isin(specialisation.TERMS)]
    gains = len(own) > 0 and bool((own["ratio"] > 1).all())
    return quality_check(
        name,
        statement,
        Verdict.AGREE if gains else Verdict.DISAGREE,
        f"time with the term over time without, as recorded: {ratios}",
        tolerance,
    )
