r"""What a scene needs: which ingredients of the automaton change what a person asks of it.

The reference is the automaton as each built-in scene stands (the paper's upwind rule on the
scene's own cells and steps), not BCRE: asked is what a part of the model does, not whether it is
right. Each ingredient is left out in turn (``ablation`` says how), and the change of every
observable is taken over that observable's scale (``observables`` has their definitions, units and
scales).
An ingredient that changes an observable by at most 1 % (5 %) is not needed for it. "refused" is a
model whose step is not stable: the ingredient is needed for stability.

What is not needed one by one is then left out together, and ingredients are put back until the
observable holds, on cells of d, 2 d, 4 d and 8 d and in all three schemes (``smallest``). The
smallest model is the cheapest found; its change and its cost, over that of the full one, are those
of a run of it.

Cost is counted, not measured: cells stepped, times the committed record of what a step of a cell
takes (``reports/speed``). The kernels leave an absent kappa, v_up and cut-off out of the code; an
absent D they multiply by zero.

The table "comparison" has a row per scene and observable: the full model's value and scale, what
is needed, the change by all that is not needed left out together, and the smallest model. The
table of each scene has a row per ingredient: the change of every observable, and what a run
without it costs.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from matplotlib.colors import BoundaryNorm, ListedColormap

from bcre_studies.comparison.claim import Claim, quality_check
from bcre_studies.comparison.rounding import significant
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.comparison.wording import sentences, when
from bcre_studies.observables.named import NAMES, posed, scale, value
from bcre_studies.performance.record import specialisation
from bcre_studies.performance.scene_needs.ablation import (
    DOUBLE,
    DRY,
    GAMMA,
    INGREDIENTS,
    KAPPA,
    LAYER,
    NONLINEARITY,
    STEPS,
    D,
    V,
)
from bcre_studies.performance.scene_needs.smallest import (
    Trials,
    dispensable,
    smallest,
    together,
    without,
)
from bcre_studies.reporting import style
from bcre_studies.scenes.listing import studied_names
from bcre_studies.scenes.scene import load
from bcre_studies.sweeps.parallel import each

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

TOLERANCES = {"1": 0.01, "5": 0.05}
WHY = (
    "1 % is about what a measurement of a pile can tell, 5 % the width of a line in the paper's "
    "figures; the scales stand with the observables"
)
SMALLEST_SHOWN = 1e-6
"""Less is rounding, and shown as 0."""

PHYSICAL = (D, V, GAMMA, KAPPA, LAYER, NONLINEARITY)
Row = dict[str, Any]


def run() -> dict[str, pd.DataFrame]:
    """The comparison, and a table per scene."""
    names = studied_names()
    found = each(needs_of, names, "scene_needs")
    comparison = [row for rows, _ in found for row in rows]
    tables = {name: pd.DataFrame(rows) for name, (_, rows) in zip(names, found, strict=True)}
    return {"comparison": pd.DataFrame(comparison), **tables}


def needs_of(name: str) -> tuple[list[Row], list[Row]]:
    """The rows of a scene: one per observable, and one per ingredient."""
    trials = Trials(load(name))
    observables = posed(trials.scene)
    return (
        [_row_of_observable(name, trials, observable) for observable in observables],
        [_row_of_ingredient(trials, ingredient) for ingredient in INGREDIENTS],
    )


def _row_of_ingredient(trials: Trials, ingredient: str) -> Row:
    model = without(ingredient)
    changes = {name: shown(trials.change(model, name)) for name in posed(trials.scene)}
    cost = trials.cost(model)
    ran = math.isfinite(cost)
    return {
        "without": ingredient,
        "runs": "yes" if ran else "refused",
        **{name: changed if ran else math.nan for name, changed in changes.items()},
        "cost": significant(cost, 3) if ran else math.nan,
        "saves": significant(round(1 - cost, 3), 3) if ran else math.nan,
    }


def _row_of_observable(name: str, trials: Trials, observable: str) -> Row:
    record = trials.full.record
    row: Row = {
        "scene": name,
        "observable": observable,
        "value": significant(round(value(observable, record), 9), 4),
        "scale": significant(scale(observable, record), 3),
    }
    for percent, tolerance in TOLERANCES.items():
        spare = dispensable(trials, observable, tolerance)
        joint = together(trials, observable, tolerance)
        model = smallest(trials, observable, tolerance)
        row |= {
            f"needed_{percent}": ", ".join(n for n in INGREDIENTS if n not in spare),
            f"together_{percent}": shown(trials.change(joint, observable)),
            f"smallest_{percent}": str(model),
            f"change_{percent}": shown(trials.change(model, observable)),
            f"cost_{percent}": significant(trials.cost(model), 2),
        }
    return row


def shown(change: float) -> float:
    """Two digits, and none below :data:`SMALLEST_SHOWN`."""
    if not math.isfinite(change):
        return change
    return significant(round(change, round(-math.log10(SMALLEST_SHOWN))), 2)


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


BOUNDS = (0.0, 1e-6, 1e-4, 1e-3, 0.01, 0.05, 0.5, np.inf)
COLOURS = ("#ffffff", "#eef3f8", "#d6e4f0", "#b3cde3", "#fdd9a0", "#f28e4b", "#b5370f")
LABELS = ("< 1e-6", "1e-4", "1e-3", "1 %", "5 %", "50 %", "more")


def draw(tables: dict[str, pd.DataFrame]) -> Figure:
    """One matrix a scene: ingredients by observables, coloured by the relative change.

    Colours change from blue to orange at 1 %; a ring marks more than 1 %, a disc more than 5 %.
    """
    scenes = [name for name in tables if name != "comparison"]
    figure, axes = style.panels(2, (len(scenes) + 1) // 2)
    for axis, scene in zip(axes, scenes, strict=False):
        _matrix(axis, tables[scene])
        axis.set_title(scene, loc="left")
    for axis in axes[len(scenes) :]:
        axis.set_axis_off()
        _key(axis)
    return figure


def _matrix(axis: Axes, table: pd.DataFrame) -> None:
    norm = BoundaryNorm([*BOUNDS[:-1], 1e9], len(COLOURS))
    names = list(NAMES)
    values = np.full((len(table), len(names)), np.nan)
    for column, name in enumerate(names):
        if name in table:
            values[:, column] = table[name].to_numpy(dtype=float)
    colours = ListedColormap(list(COLOURS))
    colours.set_bad("#e8e8e8")
    finite = np.minimum(values, 1e8)
    axis.pcolormesh(finite, cmap=colours, norm=norm, edgecolors="0.85", linewidth=0.5)
    for row, column in np.ndindex(*values.shape):
        place, changed = (column + 0.5, row + 0.5), values[row, column]
        if names[column] not in table:
            continue
        if table["runs"].iloc[row] == "refused":
            axis.plot(*place, "kx", markersize=4)
        elif changed > TOLERANCES["1"]:
            filled = "k" if changed > TOLERANCES["5"] else "none"
            axis.plot(*place, "o", color="k", markerfacecolor=filled, markersize=4)
    axis.set_xticks(np.arange(len(names)) + 0.5, names, rotation=60, fontsize=7)
    axis.set_yticks(np.arange(len(table)) + 0.5, list(table["without"]), fontsize=7)
    axis.tick_params(length=0)
    axis.invert_yaxis()
    axis.grid(visible=False)


def _key(axis: Axes) -> None:
    for colour, label in zip(COLOURS, LABELS, strict=True):
        axis.plot([], [], "s", color=colour, markeredgecolor="0.6", markersize=9, label=label)
    axis.plot([], [], "ko", markerfacecolor="none", label="more than 1 %")
    axis.plot([], [], "ko", label="more than 5 %")
    axis.plot([], [], "kx", label="refused: needed for stability")
    axis.plot([], [], "s", color="#e8e8e8", markeredgecolor="0.6", label="not posed by the scene")
    axis.legend(loc="center left", title="relative change up to", fontsize=8, ncols=1)
