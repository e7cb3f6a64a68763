"""Each scheme converges at its formal order; past the breaking time neither model does."""

from __future__ import annotations

from math import inf

import pandas as pd

from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.verdict import Verdict, worst
from bcre_studies.comparison.wording import joined, when
from bcre_studies.verification.order_of_accuracy.expected import (
    CA,
    EXPECTED,
    PDE,
    WHY_ERROR,
    kind,
)

NAMES = {
    CA: ("order of the automaton", "The automaton"),
    PDE: ("order of the PDE", "The PDE"),
    "calibrated": ("order of the calibrated scheme", "The calibrated automaton"),
    "limited": ("order of the limited scheme", "The limited automaton"),
}
"""The claim about each kind of scheme, and its subject."""


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """The order of each kind of scheme, and the one past the breaking time."""
    table = tables["comparison"]
    kinds = table["model"].combine(table["scheme"], kind)
    orders = [order_of(name, table[kinds == name]) for name in NAMES]
    return [
        *orders,
        _past_breaking(tables["past_breaking"]),
        _further_models(tables["further_models"]),
    ]


def order_of(name: str, rows: pd.DataFrame) -> Claim:
    """The claim about one kind of scheme, from its rows of the comparison."""
    expected, (claim, subject) = EXPECTED[name], NAMES[name]
    outside = rows[rows["verdict"] != str(Verdict.AGREE)]
    least, most = (rows.loc[at] for at in (rows["order_L1"].idxmin(), rows["order_L1"].idxmax()))
    listed = joined((f"{row.solution}: {row.order_L1:g}" for row in outside.itertuples()), "; ")
    below = when(expected.why_below and len(outside), f". {expected.why_below}")
    return Claim(
        name=claim,
        statement=f"{subject} converges to the exact solutions at order {expected.order:g}"
        f"{when(name != PDE and expected.highest == inf, ' or more')}.",
        verdict=worst(rows["verdict"]),
        evidence=f"fitted L1 orders from {least['order_L1']:g} ({least['solution']}) to "
        f"{most['order_L1']:g} ({most['solution']}) over {len(rows)} pairs of solution and "
        f"scheme, largest error on a finest grid {rows['L1_on_finest'].max():.2g}; outside: "
        f"{listed}{below}",
        tolerance=f"order at least {expected.lowest:g}: {expected.why}; "
        f"error {expected.error:g}: {WHY_ERROR}",
    )


def _past_breaking(after: pd.DataFrame) -> Claim:
    falls = bool((after["order"] <= 1.2).all())
    return Claim(
        name="past the breaking time",
        statement="Past t* the observed order of both falls to about one or below.",
        verdict=Verdict.AGREE if falls else Verdict.DISAGREE,
        evidence="orders "
        + joined(
            f"{row.order:g} ({row.model}, t = {row.t_over_t_star:g} t*, largest change at "
            f"x = {row.largest_at_x:g})"
            for row in after.itertuples()
        ),
        tolerance="order at most 1.2: a jump that is resolved by neither converges in L1 at "
        "order one at best, give or take the fit",
    )


def _further_models(rows: pd.DataFrame) -> Claim:
    """The other models, each on exact solutions of its own."""
    listed = joined(
        (
            f"{row.solution} ({row.model}) {row.error:.2g} on {row.cells:g} cells"
            + when(row.order == row.order, f", order {row.order:g}")
            for row in rows.itertuples()
        ),
        "; ",
    )
    return Claim(
        name="further models",
        statement="The other models and their rules converge to exact solutions of their own.",
        verdict=worst(rows["verdict"]),
        evidence=f"mean errors: {listed}",
        tolerance="orders at least 4 for an equation and 0.9 to 1.1 for a rule; an error below the "
        "bound beside it, 1 % for the silo, which is not at rest yet",
    )
