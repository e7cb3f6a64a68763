r"""The second critical angle: above which slope does any perturbation bring the pile down?

A rolling layer on a slope S grows at a fixed place, against being carried away, where S > Sd:

    BCRE        gamma (Sd - Sc) = v^2/(4 D)
    automaton   gamma (Sd - Sc) = (sqrt(v/d + D/d^2) - sqrt(D/d^2))^2        for any stable dt

(Bouchaud et al. 1994; ``bcre_ca.theory``). Their ratio depends on the cell Peclet number
Pe = v d/D only.

* Sd is measured by growth at a fixed place from R = 1e-150 (``critical_slope``) for five sets of
  parameters; "effective" is BCRE with D_eff = D + v d/2, what the automaton's cells add to D at Sd.
* That of the calibrated automaton (``Sd - Sc, calibrated``) follows from the D that its step leaves
  to it, D - (v d/2)(1 - v dt/d) instead of D in the closed form (``Rule.second_critical_slope``).
* Whether the avalanche runs to the top (``climb``, definitions in ``outcome``): pulses 1e-6, 1 and
  10 near the foot of figure 1's slope, with dt = 0.2 d; "effective" has D_eff = 0.149 and
  kappa_eff = 0.005.
* The threshold: the slope from which on a pulse climbs, against its amplitude. Its error is half of
  the bracket that holds on two grids.

The column "automaton d/4" is the automaton with cells four times smaller.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

import bcre_pde
import bcre_pde.theory
from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.compare import Comparison
from bcre_studies.comparison.rounding import shown
from bcre_studies.comparison.verdict import within, worst
from bcre_studies.comparison.wording import sentences, when
from bcre_studies.models.effective import effective_at_critical_slope
from bcre_studies.models.registry import AUTOMATON, BCRE, COMPARED, Model
from bcre_studies.reporting import style
from bcre_studies.sweeps.parallel import each
from bcre_studies.validation.second_critical_angle import finite_pulses
from bcre_studies.validation.second_critical_angle.critical_slope import (
    calibrated_rule,
    measure_sd_automaton,
    measure_sd_pde,
    upwind_rule,
)
from bcre_studies.validation.second_critical_angle.finite_pulses import (
    FINER,
    OUTCOME,
    THRESHOLD,
    TOLERANCE,
    WHY,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

AUTOMATON_TOLERANCE, PDE_TOLERANCE = 0.001, 0.01
THEORY_WHY = "of the estimate 1/t leaves under 0.01 % at the times taken; the rest is reserve"
LAST_DIGIT = 1e-5

SD, SD_CALIBRATED = "Sd - Sc", "Sd - Sc, calibrated"
QUANTITIES = (SD, OUTCOME, THRESHOLD, SD_CALIBRATED)

SETS = {
    (0.1, 0.1, 0.01, 1.0): "figure 1",
    (0.3, 0.1, 0.05, 1.0): "other materials",
    (0.3, 0.1, 0.05, 0.25): "other materials",
    (0.2, 0.4, 0.02, 0.5): "other materials",
    (2.5, 0.1, 0.01, 1.0): "figures 2 and 3",
}
"""v, D, gamma, d, and whose parameters those are."""
SC = 0.5
STEEPEST = 5.0
"""A slope of 79 degrees, above any at which sand stands."""

CALIBRATED = [key for key in SETS if key[0] != 0.3]
"""Of these the calibrated rule is measured too: Pe = 1, 0.25 and 25."""

RULES = {SD: upwind_rule, SD_CALIBRATED: calibrated_rule}

Row = dict[str, Any]
Case = tuple[Callable[..., Row], tuple[Any, ...]]


def run() -> dict[str, pd.DataFrame]:
    """All rows; the slow ones first, so that no processor waits for the last one."""
    cases: list[Case] = finite_pulses.cases()
    cases += [(sd_row, (SD, *parameters)) for parameters in SETS]
    cases += [(sd_row, (SD_CALIBRATED, *parameters)) for parameters in CALIBRATED]
    rows = each(_case, cases, "second_critical_angle")
    rows.sort(key=lambda row: QUANTITIES.index(row["quantity"]))
    return {"comparison": pd.DataFrame(rows)}


def _case(case: Case) -> Row:
    function, arguments = case
    return function(*arguments)


def sd_row(quantity: str, v: float, D: float, gamma: float, d: float) -> Row:
    """Sd - Sc by growth at a fixed place, in both models."""
    material = bcre_pde.Material(v, D, gamma, SC)
    make = RULES[quantity]
    rule = make(material, d)
    with_own = effective_at_critical_slope(replace(material, D=rule.diffusion_left()), d)
    result = Comparison(
        measure_sd_automaton(rule), measure_sd_pde(material), measure_sd_pde(with_own), TOLERANCE
    )
    head = {"v": v, "D": D, "gamma": gamma, "d": d}
    return {
        "quantity": quantity,
        "case": SETS[v, D, gamma, d],
        **head,
        FINER: shown(measure_sd_automaton(make(material, d / 4))),
        **result.row(
            rule.second_critical_slope() - rule.Sc,
            bcre_pde.theory.second_critical_slope(v, D, gamma, 0.0),
        ),
    }


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """The two closed forms, the two models' Sd, whether the avalanche climbs, and from where on."""
    table = tables["comparison"]
    sd, outcomes, thresholds, calibrated = (_of(table, quantity) for quantity in QUANTITIES)
    return [
        _closed_form_claim(sd, AUTOMATON, "the automaton", AUTOMATON_TOLERANCE),
        _closed_form_claim(sd, BCRE, "BCRE", PDE_TOLERANCE),
        *(_sd_claim(str(what), rows) for what, rows in sd.groupby("case", sort=False)),
        *finite_pulses.claims(outcomes, thresholds, sd.iloc[0]),
        _closed_form_claim(calibrated, AUTOMATON, "the calibrated automaton", AUTOMATON_TOLERANCE),
        _calibrated_claim(calibrated, sd),
    ]


def _of(table: pd.DataFrame, quantity: str) -> pd.DataFrame:
    return table[table["quantity"] == quantity]


def _closed_form_claim(rows: pd.DataFrame, model: Model, who: str, tolerance: float) -> Claim:
    column = model.column
    pairs = list(zip(rows[column], rows[f"{column}_theory"], strict=True))
    gap = max(abs(measured / theory - 1) for measured, theory in pairs)
    return Claim(
        f"closed form of Sd, {who.removeprefix('the ')}",
        f"Sd measured in {who} is that of its closed form.",
        worst(within(measured, theory, tolerance) for measured, theory in pairs),
        f"{len(pairs)} sets of parameters, Sd - Sc from {rows[column].min():g} to "
        f"{rows[column].max():g}: largest relative difference {max(gap, LAST_DIGIT):.0e}",
        f"{tolerance:.1%}: {THEORY_WHY}",
    )


def _peclet(row: Any) -> float:
    return float(row["v"] * row["d"] / row["D"])


def _sd_claim(what: str, rows: pd.DataFrame) -> Claim:
    cases = [
        f"Pe = {_peclet(row):g}: Sd - Sc = {row.automaton:.4g} in the automaton and "
        f"{row.pde:.4g} in BCRE, {row['difference']:.0%} apart, and "
        f"{row['difference_effective']:.2g} with D + v d/2; {row[FINER]:.4g} on cells of d/4"
        for _, row in rows.iterrows()
    ]
    steep = rows[rows[[AUTOMATON.column, BCRE.column]].min(axis=1) + SC > STEEPEST]
    left = rows[rows["difference_effective"] > TOLERANCE]
    return Claim(
        f"second critical slope, {what}",
        f"At the parameters of {what} the automaton's second critical slope is that of BCRE.",
        worst(rows["verdict"]),
        sentences(
            "; ".join(cases),
            when(
                len(left),
                "the expansion in Pe does not reach Pe = "
                + " and ".join(f"{_peclet(row):g}" for _, row in left.iterrows()),
            ),
            when(
                len(steep),
                f"in both models these slopes are above {_degrees(STEEPEST):.0f} degrees "
                f"(up to {_degrees(rows.automaton.max() + SC):.1f} and "
                f"{_degrees(rows.pde.max() + SC):.2f}), where no sand stands",
            ),
        ),
        f"{TOLERANCE:.0%} {WHY}",
    )


def _degrees(slope: float) -> float:
    return math.degrees(math.atan(slope))


def _calibrated_claim(rows: pd.DataFrame, upwind: pd.DataFrame) -> Claim:
    printed = upwind.set_index(["v", "D", "gamma", "d"])["difference"]
    gaps = [
        (row["difference"], printed[row["v"], row["D"], row["gamma"], row["d"]], _peclet(row))
        for _, row in rows.iterrows()
    ]
    return Claim(
        "second critical slope, calibrated",
        "The calibrated automaton's second critical slope is that of BCRE.",
        worst(rows["verdict"]),
        sentences(
            "relative difference "
            + ", ".join(
                f"{own:.1%} (Pe = {Pe:g}; the printed rule {papers:.0%})"
                for own, papers, Pe in gaps
            ),
            when(
                any(own > TOLERANCE for own, _, _ in gaps),
                "D_eff = D holds for a layer that is carried. At Sd nothing changes in time, so "
                "the part -v^2 dt/2 that the calibrated step relies on is missing: to first order "
                "in Pe, Sd is that of D + v^2 dt/2",
            ),
        ),
        f"{TOLERANCE:.0%} {WHY}",
    )


def draw(tables: dict[str, pd.DataFrame]) -> Figure:
    """Sd against the cell Peclet number, what became of each pulse, and the threshold."""
    table = tables["comparison"]
    figure, axes = style.panels(1, 3)
    _draw_sd(axes[0], _of(table, SD), _of(table, SD_CALIBRATED))
    finite_pulses.draw_outcomes(axes[1], _of(table, OUTCOME))
    finite_pulses.draw_thresholds(axes[2], _of(table, THRESHOLD))
    style.legend(figure, COMPARED, markers=True)
    return figure


def _draw_sd(axis: Axes, rows: pd.DataFrame, calibrated: pd.DataFrame) -> None:
    """All over v^2/(4 D gamma): what is left depends on Pe = v d/D only, but for the calibrated
    rule, whose step counts too."""
    Pe = np.geomspace(0.1, 40, 200)
    ratio = 4 * (np.sqrt(1 + Pe) - 1) ** 2 / Pe**2
    for model, y in zip(COMPARED, (ratio, np.ones_like(Pe), 1 / (1 + Pe / 2)), strict=True):
        axis.plot(Pe, y, **model.line)
        measured = (rows[model.column] / rows["pde_theory"]).astype(float)
        axis.plot(rows["v"] * rows["d"] / rows["D"], measured, **model.markers())
    y = (calibrated.automaton / calibrated["pde_theory"]).astype(float)
    look = AUTOMATON.markers(marker="D", hollow=True)
    axis.plot(calibrated["v"] * calibrated["d"] / calibrated["D"], y, **look, label="calibrated")
    axis.legend(loc="lower left")
    axis.set(xscale="log", ylim=(0, 1.1), xlabel="cell Peclet number v d/D")
    axis.set_ylabel("(Sd - Sc) / (v²/4 D gamma)")
    axis.set_title("Sd measured (markers) and closed form", loc="left")
