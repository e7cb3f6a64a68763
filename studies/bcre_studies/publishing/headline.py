"""The numbers of the page's first screen, read from the studies' tables."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import pandas as pd

from bcre_studies.comparison.verdict import Verdict
from bcre_studies.models.registry import AUTOMATON, BCRE
from bcre_studies.publishing.wording import (
    of,
)

Tables = Mapping[str, Mapping[str, pd.DataFrame]]

AT_REPOSE = 0.001
"""S = Sc to three digits."""
SMALL = 0.05
"""What counts as agreement in a profile; the studies' own tolerance."""
COARSE, FINE = 0.1, 0.01
NOT_POSED = "-"
"""Stands in the study of our choices where a scene has no such choice."""


@dataclass(frozen=True)
class Gap:
    """How far apart the models are in one of the paper's figures, relative L1 of R at d = 1.

    ``left`` is the same once D_eff and kappa_eff are counted, ``own_error`` BCRE's own. ``until``
    is the time of all this where BCRE is unresolved later on.
    """

    figure: str
    difference: float
    left: float
    own_error: float
    resolved: bool
    until: float | None = None


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

    ``most_steepened`` is S - Sc before and after where the automaton's rose most,
    ``most_steepened_bcre`` likewise; ``below`` counts both models.
    """

    cases: int
    came_down: int
    came_down_bcre: int
    steeper: int
    most_steepened: tuple[float, float]
    most_steepened_bcre: tuple[float, float]
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
    """All numbers of the first screen.

    ``choices``: changes of a choice of ours that leave the verdict, of all that were tried;
    ``orders``: at which the paper's rule and BCRE's solver converge.
    """

    diffusion: tuple[Diffusion, ...]
    gaps: tuple[Gap, ...]
    slopes: CriticalSlopes
    pulses: Pulses
    coarse: Race
    fine: Race
    choices: tuple[int, int]
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
        choices=_choices(tables["choices"]["comparison"]),
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
    gaps = []
    for figure, times in rows.groupby("case", sort=False):
        times = times.sort_values("t")
        resolved = times[times["verdict"] != Verdict.UNRESOLVED]
        last = (resolved if len(resolved) else times).iloc[-1]
        later = len(resolved) and last["t"] < times["t"].max()
        gaps.append(
            Gap(
                figure=str(figure),
                difference=float(last["difference"]),
                left=float(last["difference_effective"]),
                own_error=float(last["difference_error"]),
                resolved=len(resolved) > 0,
                until=float(last["t"]) if later else None,
            )
        )
    return tuple(gaps)


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
    start, end, end_bcre = (
        rows[column].astype(float) for column in ("S0 - Sc", AUTOMATON.column, BCRE.column)
    )
    most, most_bcre = ((last - start).idxmax() for last in (end, end_bcre))
    return Pulses(
        cases=len(rows),
        came_down=int((end.abs() <= AT_REPOSE).sum()),
        came_down_bcre=int((end_bcre.abs() <= AT_REPOSE).sum()),
        steeper=int((end > start).sum()),
        most_steepened=(float(start[most]), float(end[most])),
        most_steepened_bcre=(float(start[most_bcre]), float(end_bcre[most_bcre])),
        below=int((end < -AT_REPOSE).sum() + (end_bcre < -AT_REPOSE).sum()),
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


def _choices(table: pd.DataFrame) -> tuple[int, int]:
    """How many changes of a choice of ours leave the verdict's word, and how many there are."""
    changed = table[["halved", "doubled"]]
    posed = changed != NOT_POSED
    same = changed.eq(table["as it stands"], axis=0)
    return int((same & posed).to_numpy().sum()), int(posed.to_numpy().sum())


def _orders(table: pd.DataFrame) -> tuple[float, float]:
    """Median observed order of the paper's rule and of BCRE's right-hand side."""
    upwind = table[(table["model"] == AUTOMATON.name) & table["scheme"].str.contains("^0|^[0-9]")]
    pde = table[table["model"] == BCRE.name]
    return float(upwind["order_L1"].median()), float(pde["order_L1"].median())
