"""The number that decides a claim of the paper, in a cell of a table.

One entry for each of our own claims that may come first in the evidence; where the first has none,
the count of claims that hold stands in its place.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import pandas as pd

from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.models.registry import AUTOMATON, BCRE
from bcre_studies.publishing.wording import fixed, number, of, percent, span

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
        f"decay rate of the surface at k = {row['k']:.1g}: {number(float(row['automaton']), 2)} "
        f"against {number(max(float(row[BCRE.column]), 0.0), 1)} in BCRE"
    )


def _uphill(tables: Tables) -> str:
    rows = of(tables["comparison"], quantity="front speed V", d=1.0)
    row = rows.iloc[(rows["value"] - 2.1).abs().argmin()]
    return (
        f"front of the rolling layer at S − Sc = {number(float(row['value']))}: "
        f"{number(float(row['automaton']), 2)} against {number(float(row[BCRE.column]), 2)} in BCRE"
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


def _profiles(tables: Tables) -> str:
    rows = tables["comparison"]
    rows = rows[rows["quantity"].str.startswith("R(x)") & (rows["d"] == 1.0)]
    judged = rows[rows["verdict"] != str(Verdict.UNRESOLVED)]
    if judged.empty:
        return "unresolved in every figure"
    worst = judged.loc[judged["difference"].idxmax()]
    return (
        f"rolling layers up to {percent(float(worst['difference']))} apart, "
        f"{percent(float(judged['difference_effective'].max()))} once cell size is counted"
    )


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
    ("uphill_propagation", "rolling front"): _uphill,
    ("uphill_propagation", "surface wave"): _wave,
    ("second_critical_angle", "second critical slope"): _sd,
    ("one_variable", "return to repose"): _one_variable,
    ("one_variable", "second critical angle"): _one_variable,
    ("paper_figures", "figure1 profile"): _profiles,
    ("paper_figures", "figure2 profile"): _profiles,
    ("speed_error", "efficiency"): _efficiency,
    ("scaling", "interactive"): _interactive,
}
"""The study and claim, and what its tables say in a few words."""
