"""The answer in numbers, from the studies' tables, and in five sentences that hang on them.

Nothing here is typed in: :func:`headline` reads tables, :func:`answers` writes what they say, and a
sentence that draws a conclusion stands under the condition that makes it true.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import pandas as pd

from bcre_studies.models.registry import AUTOMATON, BCRE
from bcre_studies.publishing.wording import (
    figure_name,
    fixed,
    listed,
    number,
    numeric,
    of,
    percent,
    span,
)

Tables = Mapping[str, Mapping[str, pd.DataFrame]]

AT_REPOSE = 0.001
"""S = Sc to three digits."""
SMALL = 0.05
"""What counts as agreement in a profile; the studies' own tolerance."""
COARSE, FINE = 0.1, 0.01
LEAST = 1e-4
"""Smaller errors are given as this."""


@dataclass(frozen=True)
class Gap:
    """How far apart the models are in one of the paper's figures, relative L1 of R at d = 1.

    ``left`` is the same once D_eff and kappa_eff are counted, ``own_error`` BCRE's own.
    """

    figure: str
    difference: float
    left: float
    own_error: float
    resolved: bool


@dataclass(frozen=True)
class Diffusion:
    """A figure's D, and the diffusion that the rule was measured to have."""

    figure: str
    D: float
    acting: float


@dataclass(frozen=True)
class CriticalSlopes:
    """Sd - Sc at figure 1's parameters: automaton at d = 1 and d = 1/4, BCRE; how well measured.

    ``theory_gap`` is the largest relative distance of a measured one from its closed form.
    """

    automaton: float
    finer: float
    bcre: float
    theory_gap: float


@dataclass(frozen=True)
class Pulses:
    """One pulse on slopes above repose: how many came down to Sc, became steeper, fell below.

    ``most_steepened`` is S - Sc before and after where it rose most, in either model.
    """

    cases: int
    came_down: int
    came_down_bcre: int
    steeper: int
    most_steepened: tuple[float, float]
    below: int


@dataclass(frozen=True)
class Race:
    """The paper's rule against BCRE's solver at one error: scenes, who is faster, by how much."""

    error: float
    scenes: int
    won: int
    by: tuple[float, ...]
    lost_by: tuple[float, ...]
    better_won: int


@dataclass(frozen=True)
class Headline:
    """All numbers of the first screen."""

    diffusion: tuple[Diffusion, ...]
    gaps: tuple[Gap, ...]
    slopes: CriticalSlopes
    pulses: Pulses
    coarse: Race
    fine: Race
    mass_error: float
    orders: tuple[float, float]


def headline(tables: Tables) -> Headline:
    """The numbers, each from the study that measured it."""
    reach = tables["speed_error"]["recorded_reach"]
    return Headline(
        diffusion=_diffusion(tables["printed_rule"]["comparison"]),
        gaps=_gaps(tables["paper_figures"]["comparison"]),
        slopes=_slopes(tables["second_critical_angle"]["comparison"]),
        pulses=_pulses(tables["repose_return"]["comparison"]),
        coarse=_race(reach, COARSE),
        fine=_race(reach, FINE),
        mass_error=float(numeric(tables["hard_cases"]["comparison"]["mass_error_at_most"]).max()),
        orders=_orders(tables["order_of_accuracy"]["comparison"]),
    )


def _diffusion(table: pd.DataFrame) -> tuple[Diffusion, ...]:
    """Measured by ``printed_rule`` with a stable step; D is what is measured without a cell."""
    rows = of(table, step="stable", sign="consistent", order="synchronous")
    return tuple(
        Diffusion(str(row["figure"]), _own_diffusion(row), float(row["diffusion"]))
        for _, row in rows.iterrows()
    )


def _own_diffusion(row: pd.Series) -> float:
    """D of a figure at d = 1, from what its rule measures: diffusion less (v/2)(1 - v dt)."""
    v, dt = float(row["drift"]), float(row["dt"])
    return float(f"{row['diffusion'] - v / 2 * (1 - v * dt):.3g}")


def _gaps(table: pd.DataFrame) -> tuple[Gap, ...]:
    """At d = 1; of several times of one figure the last at which BCRE is resolved."""
    rows = table[table["quantity"].str.startswith("R(x)") & (table["d"] == 1.0)]
    found: dict[str, Gap] = {}
    for _, row in rows.iterrows():
        gap = Gap(
            figure=str(row["case"]),
            difference=float(row["difference"]),
            left=float(row["difference_effective"]),
            own_error=float(row["difference_error"]),
            resolved=row["verdict"] != "unresolved",
        )
        if gap.resolved or gap.figure not in found:
            found[gap.figure] = gap
    return tuple(found.values())


def _slopes(table: pd.DataFrame) -> CriticalSlopes:
    rows = of(table, quantity="Sd - Sc")
    first = rows.iloc[0]
    gaps = [
        abs(float(row[model]) / float(row[f"{model}_theory"]) - 1)
        for _, row in rows.iterrows()
        for model in (AUTOMATON.column, BCRE.column)
    ]
    return CriticalSlopes(
        float(first["automaton"]),
        float(first["automaton d/4"]),
        float(first[BCRE.column]),
        max(gaps),
    )


def _pulses(table: pd.DataFrame) -> Pulses:
    rows = of(table, quantity="final S - Sc", pulses=1)
    rows = rows[(rows["case"] != "repeated") & (rows["S0 - Sc"] > 0)]
    start, end = rows["S0 - Sc"].astype(float), rows["automaton"].astype(float)
    highest = rows[[AUTOMATON.column, BCRE.column]].astype(float).max(axis=1)
    most = (highest - start).idxmax()
    return Pulses(
        cases=len(rows),
        came_down=int((end.abs() <= AT_REPOSE).sum()),
        came_down_bcre=int((rows[BCRE.column].astype(float).abs() <= AT_REPOSE).sum()),
        steeper=int((end > start).sum()),
        most_steepened=(float(start[most]), float(highest[most])),
        below=int((end < -AT_REPOSE).sum()),
    )


def _race(reach: pd.DataFrame, error: float) -> Race:
    """Times to one error: the paper's rule, its two better schemes, and the best of BCRE's."""
    by: list[float] = []
    lost_by: list[float] = []
    better = scenes = 0
    for _, group in of(reach, error=error).groupby("scene", sort=False):
        seconds = group.set_index("contender")["seconds"]
        bcre = min((t for name, t in seconds.items() if str(name).startswith("PDE")), default=None)
        if bcre is None:
            continue
        scenes += 1
        improved = [
            seconds.get(f"automaton, {name}", math.inf) for name in ("calibrated", "limited")
        ]
        better += min(improved) < bcre
        own = seconds.get("automaton, upwind")
        if own is None:  # reached on no grid tried: at least this, or never
            bound = group["automaton_s"].iloc[0]
            lost_by.append(math.inf if pd.isna(bound) else float(bound) / bcre)
        elif own < bcre:
            by.append(bcre / own)
        else:
            lost_by.append(own / bcre)
    return Race(error, scenes, len(by), tuple(by), tuple(lost_by), better)


def _orders(table: pd.DataFrame) -> tuple[float, float]:
    """Median observed order of the paper's rule and of BCRE's right-hand side."""
    upwind = table[(table["model"] == AUTOMATON.name) & table["scheme"].str.contains("^0|^[0-9]")]
    pde = table[table["model"] == BCRE.name]
    return float(upwind["order_L1"].median()), float(pde["order_L1"].median())


# In words


@dataclass(frozen=True)
class Answer:
    """One of the five sentences: what it is about, and what came out."""

    about: str
    text: str


def short_answer(found: Headline) -> str:
    """Yes or no in one sentence."""
    judged = [gap for gap in found.gaps if gap.resolved]
    if judged and all(gap.difference <= SMALL for gap in judged):
        return "Yes: at the paper’s parameters it predicts what BCRE predicts."
    if judged and all(gap.left <= SMALL for gap in judged):
        return (
            "Not as it stands. Nearly all of the difference between the rolling layers comes from "
            "the size of the automaton’s cells."
        )
    return "No: at the paper’s parameters it differs, and its cells do not explain all of it."


def answers(found: Headline) -> list[Answer]:
    """The five sentences of the first screen."""
    return [
        Answer("What the rule is", _rule(found)),
        Answer("What that changes", _change(found)),
        Answer("The second critical slope", _critical(found)),
        Answer("What one pulse does", _pulse(found)),
        Answer("When it is faster", _speed(found)),
    ]


def _rule(found: Headline) -> str:
    most = max(found.diffusion, key=lambda row: row.acting / row.D)
    return (
        "The rule is a first-order upwind scheme of BCRE. Its cells, of length d, add v d/2 to the "
        "diffusion D of the rolling sand, which moves at speed v. They also smooth the surface by "
        "γ d/2, where γ is the rate of exchange between the layers. In "
        f"{figure_name(most.figure)}, D = {number(most.D)} acts as {number(most.acting)}."
    )


def _change(found: Headline) -> str:
    judged = [gap for gap in found.gaps if gap.resolved]
    unjudged = [figure_name(gap.figure) for gap in found.gaps if not gap.resolved]
    if not judged:
        return "BCRE is unresolved in every figure, so nothing can be said."
    apart = listed([f"{percent(gap.difference)} in {figure_name(gap.figure)}" for gap in judged])
    shares = list(dict.fromkeys(percent(gap.left) for gap in judged))
    left = f"{shares[0]} is left in each" if len(shares) == 1 else f"{listed(shares)} are left"
    text = (
        f"At the paper’s parameters the rolling layers differ by {apart}. With both terms added to "
        f"BCRE, {left}."
    )
    if unjudged:
        text += f" {listed(unjudged).capitalize()} cannot be judged: BCRE is unresolved there."
    return text


def _critical(found: Headline) -> str:
    slopes = found.slopes
    lead = (
        "Both have a slope Sd above which any disturbance, however small, brings the whole slope "
        "down. In figure 1 it lies "
    )
    if abs(slopes.automaton / slopes.bcre - 1) <= SMALL:
        return lead + f"{fixed(slopes.automaton)} above repose in both."
    nearer = abs(slopes.finer - slopes.bcre) < abs(slopes.automaton - slopes.bcre)
    finer = f"; cells a quarter as long give {fixed(slopes.finer)}" if nearer else ""
    return (
        lead + f"{fixed(slopes.automaton)} above the repose slope Sc in the automaton and "
        f"{fixed(slopes.bcre)} in BCRE{finer}. Between these slopes the two disagree."
    )


def _pulse(found: Headline) -> str:
    pulses = found.pulses
    start, end = pulses.most_steepened
    text = (
        f"In {pulses.cases} runs on slopes above repose, one pulse brought {pulses.came_down} down "
        f"to repose ({pulses.came_down_bcre} in BCRE): those where the avalanche reached the top."
    )
    if pulses.steeper:
        text += (
            f" In {pulses.steeper} the slope became steeper, at most from {fixed(start)} to "
            f"{fixed(end)} above repose."
        )
    if pulses.below:
        return text + f" {pulses.below} ended below repose."
    return text + " None ended below repose, although the paper says that they do."


def _speed(found: Headline) -> str:
    coarse, fine = found.coarse, found.fine
    parts: list[str] = []
    if coarse.won:
        parts.append(
            f"Where an error of {percent(coarse.error)} is enough, the automaton is faster in "
            f"{coarse.won} of {coarse.scenes} scenes, by a factor of {span(coarse.by)}."
        )
    finite = [value for value in fine.lost_by if math.isfinite(value)]
    if finite:
        parts.append(
            f"At {percent(fine.error)} BCRE’s solver is faster in {len(fine.lost_by)} of "
            f"{fine.scenes}, by a factor of {number(min(finite), 2)} or more."
        )
    elif fine.won == fine.scenes:
        parts.append(f"At {percent(fine.error)} it is faster in all {fine.scenes}.")
    if fine.better_won:
        parts.append(
            "With a calibrated or a flux-limited step the automaton is the faster in "
            f"{fine.better_won} of {fine.scenes} there too."
        )
    return " ".join(parts) or "Nowhere: BCRE’s solver is the faster at every error asked for."


def certainty(found: Headline) -> list[Answer]:
    """How sure the answer is: three facts."""
    judged = [gap for gap in found.gaps if gap.resolved]
    worst = max((gap.own_error for gap in judged), default=math.inf)
    automaton, bcre = found.orders
    facts = []
    if math.isfinite(worst):
        facts.append(
            Answer(
                f"± {percent(max(worst, LEAST))}",
                "at most is BCRE’s own numerical error in these differences; where it is not "
                "small, the verdict is “unresolved”",
            )
        )
    facts += [
        Answer(
            f"± {percent(max(found.slopes.theory_gap, LEAST))}",
            "at most separates a measured Sd from its closed form, in either model",
        ),
        Answer(
            f"{fixed(automaton, 1)} and {fixed(bcre, 1)}",
            "are the orders at which the automaton and BCRE’s solver converge to exact solutions",
        ),
        Answer(
            number(found.mass_error, 1),
            "of the sand at most is lost or created in any hard case that runs to its end, ten "
            "million steps included",
        ),
    ]
    return facts


__all__ = [
    "COARSE",
    "Answer",
    "Headline",
    "answers",
    "certainty",
    "headline",
    "short_answer",
]
