"""The number that decides a claim of the paper, in a cell of a table.

One entry for each of our own claims that may come first in the evidence; where the first has none,
the count of claims that hold stands in its place.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial

import pandas as pd

from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.models.registry import AUTOMATON, BCRE
from bcre_studies.publishing.wording import fixed, number, of, percent, span, span_of

Key = tuple[str, str]
Tables = Mapping[str, pd.DataFrame]


def deciding_number(evidence: Sequence[tuple[str, Claim]], tables: Mapping[str, Tables]) -> str:
    """The number behind the first of these claims that does not agree, or else behind the first."""
    known = [
        (study, claim)
        for study, claim in evidence
        if (study, claim.name) in NUMBERS and study in tables
    ]
    known.sort(key=lambda item: item[1].verdict is Verdict.AGREE)
    if known:
        study, claim = known[0]
        return NUMBERS[study, claim.name](tables[study])
    holds = sum(claim.verdict is not Verdict.DISAGREE for _, claim in evidence)
    if not evidence:
        return "nothing to measure it by"
    return f"{holds} of {len(evidence)} of our claims hold"


def _returned(tables: Tables) -> str:
    rows = of(tables["comparison"], quantity="final S - Sc", pulses=1)
    near = rows[(rows["case"] != "repeated") & (rows["S0 - Sc"] > 0) & (rows["S0 - Sc"] <= 0.3)]
    fell = [int((near[model].astype(float) < 0).sum()) for model in (AUTOMATON.column, BCRE.column)]
    return (
        f"below Sc after a pulse: {fell[0]} of {len(near)} slopes near repose (in BCRE {fell[1]})"
    )


def _roughness(tables: Tables) -> str:
    rows = of(tables["comparison"], quantity="decay rate of u", d=1.0)
    row = rows.iloc[(rows["k"] - 0.5).abs().argmin()]
    return (
        f"decay rate of the surface at wavenumber {row['k']:.1g}: "
        f"{number(float(row['automaton']), 2)} against "
        f"{number(max(float(row[BCRE.column]), 0.0), 1)} in BCRE"
    )


def _uphill(tables: Tables) -> str:
    rows = of(tables["comparison"], quantity="front speed V", d=1.0)
    row = rows.iloc[(rows["value"] - 2.1).abs().argmin()]
    return (
        f"front of the rolling layer at S − Sc = {number(float(row['value']))}: "
        f"{number(float(row['automaton']), 2)} against "
        f"{number(float(row[BCRE.column]), 2)} in BCRE"
    )


def _wave(tables: Tables) -> str:
    rows = of(tables["comparison"], quantity="surface wave speed", d=1.0)
    return f"speed of the surface wave over γR: within {percent(float(rows['difference'].max()))}"


def _sd(tables: Tables) -> str:
    row = of(tables["comparison"], quantity="Sd - Sc").iloc[0]
    return (
        f"Sd − Sc at figure 1’s parameters: {fixed(float(row['automaton']))} against "
        f"{fixed(float(row[BCRE.column]))} in BCRE"
    )


def _one_variable(tables: Tables) -> str:
    rows = tables["comparison"]
    row = rows[rows["case"].str.endswith("pulse 0")].iloc[-1]
    return (
        f"undisturbed at {row['case'].partition(',')[0].replace('-', '−')}: "
        f"{number(float(row['one_variable']))} with one variable, "
        f"{number(float(row['automaton']))} with two"
    )


WHOLE = "the whole slope at once"


def _models(tables: Tables) -> str:
    rows = tables["comparison"].set_index("model")
    two = rows[~rows.index.str.startswith("automaton") & (rows["goes uphill"] != WHOLE)]
    has = int((two["second critical slope"] == "yes").sum())
    return f"second critical slope in {has} of {len(two)} continuous models with two layers"


def _profiles(figures: tuple[str, ...], tables: Tables) -> str:
    rows = tables["comparison"]
    rows = rows[rows["quantity"].str.startswith("R(x)") & (rows["d"] == 1.0)]
    rows = rows[rows["case"].isin(figures)]
    judged = rows[rows["verdict"] != str(Verdict.UNRESOLVED)]
    if judged.empty:
        return "BCRE is unresolved"
    worst = judged.loc[judged["difference"].idxmax()]
    return (
        f"rolling layers up to {percent(float(worst['difference']))} apart, "
        f"{percent(float(judged['difference_effective'].max()))} once cell size is counted"
    )


def _other_sd(tables: Tables) -> str:
    rows = of(tables["comparison"], quantity="Sd - Sc", case="other materials")
    left = [percent(float(gap)) for gap in rows["difference_effective"]]
    return f"Sd with cell size counted: {', '.join(left)} off at three cell Peclet numbers"


def _rolling_roughness(tables: Tables) -> str:
    rows = of(tables["comparison"], quantity="decay rate of R", d=1.0)
    row = rows.iloc[(rows["k"] - 0.5).abs().argmin()]
    return (
        f"decay rate of the rolling layer at wavenumber {row['k']:.1g}: "
        f"{number(float(row['automaton']), 2)} against "
        f"{number(float(row[BCRE.column]), 2)} in BCRE"
    )


def _cells(tables: Tables) -> str:
    rows = of(tables["comparison"], quantity="R(x)", case="figure2")
    coarse, fine = (float(rows.loc[rows["d"] == d, "difference"].iloc[0]) for d in (1.0, 0.25))
    return (
        f"figure 2’s rolling layer: {percent(coarse)} from BCRE with d = 1, {percent(fine)} "
        "with d = 1/4"
    )


def _in_both(tables: Tables, case: str, quantity: str) -> tuple[float, float]:
    row = of(tables["comparison"], case=case, quantity=quantity).iloc[0]
    return float(row[AUTOMATON.column]), float(row[BCRE.column])


def _left(tables: Tables) -> str:
    own, bcre = _in_both(tables, "figure1", "left")
    return f"left of the static layer: {percent(own)}, in BCRE {percent(bcre)}"


def _grown(tables: Tables) -> str:
    own, bcre = _in_both(tables, "figure1", "grown")
    return f"part of the slope on which it grows: {percent(own)}, in BCRE {percent(bcre)}"


def _even(tables: Tables) -> str:
    own, bcre = _in_both(tables, "figure1", "even")
    return f"slope from cell to cell off Sc by at most {number(own, 1)}, in BCRE {number(bcre, 1)}"


def _below(tables: Tables) -> str:
    own, bcre = _in_both(tables, "figure2", "rolling")
    return f"most rolling sand over that released: {number(own, 3)}, in BCRE {number(bcre, 3)}"


def _spread(tables: Tables) -> str:
    (far, _), (wide, bcre) = (_in_both(tables, "figure2", q) for q in ("travelled", "spread"))
    return (
        f"figure 2’s pulse travels {number(far, 3)} and widens by {number(wide, 2)}, in BCRE by "
        f"{number(bcre, 2)}"
    )


def _one_size(tables: Tables) -> str:
    rows = of(tables["comparison"], drive="tilting, length")
    return f"big avalanches carry {span_of(rows['share_of_sand'])} of the sand"


def _literal(tables: Tables) -> str:
    rows = of(tables["comparison"], step="literal", figure="figure2", order="synchronous")
    factor = float(rows["amplification"].iloc[0])
    return f"with v = 2.5 and d = dt = 1 the shortest wave grows {number(factor, 2)}-fold a step"


def _efficiency(tables: Tables) -> str:
    reach = tables.get("recorded_reach")
    if reach is None:
        return "not timed here"
    won, pairs = 0, 0
    for _, group in reach.groupby(["scene", "error"], sort=False):
        seconds = group.set_index("contender")["seconds"]
        bcre = [time for name, time in seconds.items() if str(name).startswith("PDE")]
        if bcre:
            pairs += 1
            won += seconds.get("automaton, upwind", float("inf")) < min(bcre)
    return f"faster at equal error in {won} of {pairs} pairs of scene and error"


def _interactive(tables: Tables) -> str:
    budget = tables["budget"]
    own = of(budget, model="automaton, upwind")["cells"]
    bcre = budget[budget["model"].str.startswith("PDE")]["cells"]
    return f"cells at 60 frames a second: {span(list(own))}, in BCRE {span(list(bcre))}"


NUMBERS: dict[Key, Callable[[Tables], str]] = {
    ("repose_return", "first property as printed"): _returned,
    ("roughness_decay", "roughness of the surface, long waves"): _roughness,
    ("roughness_decay", "diffusion smooths the surface"): _roughness,
    ("roughness_decay", "diffusion smooths the rolling layer"): _rolling_roughness,
    ("uphill_propagation", "rolling front"): _uphill,
    ("uphill_propagation", "surface wave"): _wave,
    ("second_critical_angle", "second critical slope, figure 1"): _sd,
    ("second_critical_angle", "second critical slope, other materials"): _other_sd,
    ("one_variable", "return to repose"): _one_variable,
    ("one_variable", "second critical angle"): _one_variable,
    ("which_model", "automaton of each closure"): _models,
    ("paper_figures", "figure1 profile"): partial(_profiles, ("figure1",)),
    ("paper_figures", "figure2 profile"): partial(_profiles, ("figure2", "figure3")),
    ("paper_figures", "no matter of cells"): _cells,
    ("avalanche_extent", "static layer"): _left,
    ("avalanche_extent", "rolling layer"): _grown,
    ("avalanche_extent", "even slope"): _even,
    ("avalanche_extent", "avalanche below repose"): _below,
    ("avalanche_extent", "spreads, not travels"): _spread,
    ("avalanche_statistics", "sizes under tilting"): _one_size,
    ("printed_rule", "the literal step"): _literal,
    ("speed_error", "efficiency"): _efficiency,
    ("scaling", "interactive"): _interactive,
}
"""The study and claim, and what its tables say in a few words."""
