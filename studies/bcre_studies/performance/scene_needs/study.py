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

import pandas as pd

from bcre_studies.comparison.rounding import significant
from bcre_studies.observables.named import posed, scale, value
from bcre_studies.performance.scene_needs import claims, drawing
from bcre_studies.performance.scene_needs.ablation import INGREDIENTS
from bcre_studies.performance.scene_needs.claims import TOLERANCES
from bcre_studies.performance.scene_needs.smallest import (
    Trials,
    dispensable,
    smallest,
    together,
    without,
)
from bcre_studies.scenes.listing import studied_names
from bcre_studies.scenes.scene import load
from bcre_studies.sweeps.parallel import each

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from bcre_studies.comparison.claim import Claim

SMALLEST_SHOWN = 1e-6
"""Less is rounding, and shown as 0."""

Row = dict[str, Any]
Tables = dict[str, pd.DataFrame]


def run() -> Tables:
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


def judge(tables: Tables) -> list[Claim]:
    """Which ingredients are needed, by what, and how much smaller a model may be."""
    return claims.judge(tables)


def draw(tables: Tables) -> Figure:
    """One matrix a scene: ingredients by observables, coloured by the relative change."""
    return drawing.draw(tables)
