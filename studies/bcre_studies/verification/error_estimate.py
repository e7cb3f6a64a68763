r"""How often the error that BCRE states of its own solution covers the true one.

On exact solutions the true error e = mean|f - f_exact| of R and of u is known, and so is

    estimate/e,   which must be at least 1

for the estimate of :mod:`bcre_pde.convergence`, with the errors of the steps in time added, and
beside it for the grid convergence index of the last three grids alone. Before the breaking time
t* = 1/(gamma max R0') the solutions are those of ``order_of_accuracy`` and the climbing wave up to
0.99 t*. Past it there is the scarp that climbs at constant speed
(:mod:`bcre_pde.travelling_scarp`), placed so that its jump falls between the cells in different
ways. The error of the steps in time is that of a solve to the tolerance against one to 1e-11 on the
same grid.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pandas as pd

import bcre_pde
from bcre_pde import exact, simple_wave
from bcre_pde.solve import TOLERANCE
from bcre_pde.travelling_scarp import travelling_scarp
from bcre_studies.comparison.claim import Claim, quality_check
from bcre_studies.comparison.rounding import significant
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.models.registry import BCRE
from bcre_studies.models.run import between
from bcre_studies.reporting import style
from bcre_studies.scenes.domain import Array
from bcre_studies.sweeps.parallel import each

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BEFORE, PAST = "before t*", "past t*"
GRIDS = (20, 40, 80, 160, 320)
PARTS = (0.3, 0.6, 0.8, 0.9, 0.95, 0.99)
"""Of the breaking time of the climbing wave."""

SCARPS = (
    (bcre_pde.Material(v=0.5, D=0.5, gamma=0.5, Sc=0.5), 3.0),
    (bcre_pde.Material(v=0.5, D=0.1, gamma=0.5, Sc=0.5), 3.0),
    (bcre_pde.Material(v=1.0, D=0.3, gamma=2.0, Sc=0.5), 1.0),
    (bcre_pde.Material(v=0.2, D=0.02, gamma=1.0, Sc=0.5), 1.0),
    (bcre_pde.Material(v=0.3, D=0.2, gamma=0.3, Sc=0.5, v_up=0.4), 5.0),
)
"""Materials and heights of the scarps: D/(v + c) from a thirtieth of a cell to four cells."""

STARTS = (30.0, 29.3, 28.87)
LENGTH, CLIMB = 40.0, 12.0
TOLERANCES = (1e-3, 1e-4, 1e-6)
TIME_CELLS, NO_TIME_ERROR = 40, 1e-11
PLACES, MARGIN = 400, 0.02
"""Where profiles are compared, and the part of the domain left out next to an open end."""

ROUNDING = 1e-9
"""Errors below this part of the range are those of rounding and of the exact solution."""

STEPS = "steps in time"
TWO_TRIPLES, ONE_TRIPLE = "two triples and more", "one triple"
INDEX, ADDED_UP = "index of three grids", "local errors added up"

COVERED = 0.95
WHY = "as a confidence of 95 % is commonly asked of a grid convergence index"


class Case(NamedTuple):
    """An exact solution, compared at the end; of some the steps in time are judged too."""

    regime: str
    solution: exact.ExactSolution
    in_time: bool = False


@cache
def cases() -> tuple[Case, ...]:
    """All of them."""
    hump = exact.climbing_hump(v=1.0, gamma=0.5, height=0.3, width=1.5, length=20.0, until=2.0)
    breaking = simple_wave.breaking_time(0.5 * 0.3 / 1.5 * float(np.sqrt(2 / math.e)))
    smooth = (
        exact.rolling_mode(wavenumber=0.5, v=1.0, D=0.1),
        exact.frozen_slope_release(excess=0.6, v=1.0, D=0.3, gamma=0.2),
        exact.tilted_climbing_wave(excess=0.4, v=1.0, gamma=0.2, height=0.3, width=2.5),
        exact.steady_filling(w=0.1, v=1.0, gamma=0.2),
        exact.saturated_flow(amplitude=0.3, wavenumber=0.5, v=1.0, v_up=0.7),
    )
    scarps = [
        travelling_scarp(material, H, start, LENGTH, CLIMB)
        for material, H in SCARPS
        for start in STARTS
    ]
    return (
        *(Case(BEFORE, _until(s, part), part == 1) for s in smooth for part in (0.5, 1)),
        *(Case(BEFORE, replace(hump, until=part * breaking)) for part in PARTS),
        *(Case(PAST, _until(s, part)) for s in scarps for part in (0.25, 0.5, 1)),
    )


def _until(solution: exact.ExactSolution, part: float) -> exact.ExactSolution:
    return replace(solution, until=part * solution.until)


def run() -> dict[str, pd.DataFrame]:
    """Every estimate beside its true error, and how many cover it."""
    numbers = range(len(cases()))
    rows = [row for found in each(_of_case, numbers, "error_estimate") for row in found]
    estimates = pd.DataFrame(rows)
    above = estimates[estimates["true_error"] > ROUNDING]
    return {"comparison": coverage(above), "estimates": above}


def _of_case(number: int) -> list[dict[str, Any]]:
    case = cases()[number]
    rows = _in_space(case)
    if case.in_time:
        rows += [row for tolerance in TOLERANCES for row in _in_time(case, tolerance)]
    return rows


def _in_space(case: Case) -> list[dict[str, Any]]:
    """What is said of R and h on three grids and more, and what is true."""
    known = {cells: _solved(case, cells) for cells in GRIDS}
    rows = []
    for count in range(3, len(GRIDS) + 1):
        grids = GRIDS[:count]
        found = bcre_pde.measure_refined(known.__getitem__, grids)
        steps = _of_steps(known[grids[-1]][0])
        history = [known[cells][1] for cells in grids[-3:]]
        for (name, true), stated, *values in zip(_exact(case), found, *history, strict=True):
            index = bcre_pde.grid_convergence_index(*values[::-1]).error
            row = _row(case, name, grids[-1], values[-1] - true, stated.error + steps, index)
            order = significant(stated.order, 2)
            rows.append(row | {"triples": count - 2, "order": order, "jump": stated.jump})
    return rows


def _in_time(case: Case, tolerance: float) -> list[dict[str, Any]]:
    """What is said of the steps in time at one tolerance, and what they change on one grid."""
    solution, taken = _solved(case, TIME_CELLS, tolerance)
    _, exactly = _solved(case, TIME_CELLS, NO_TIME_ERROR)
    stated = _of_steps(solution)
    return [
        _row(case, STEPS, TIME_CELLS, value - true, stated)
        for value, true in zip(taken, exactly, strict=True)
    ]


def _solved(
    case: Case, cells: int, tolerance: float = TOLERANCE
) -> tuple[bcre_pde.Solution, list[Array]]:
    """A solution, with its profiles."""
    end = [case.solution.until]
    solved = bcre_pde.solve(case.solution.problem, end, cells, tolerance=tolerance)
    return solved, _profiles(case, solved)


def _of_steps(solved: bcre_pde.Solution) -> float:
    return solved.step_error * float(np.abs(solved.R[-1]).max())


def _profiles(case: Case, solved: bcre_pde.Solution) -> list[Array]:
    """R and u at the end."""
    x = places(case.solution)
    period = case.solution.length if case.solution.ends == "periodic" else None
    return [between(solved.x, rows[-1], x, period) for rows in (solved.R, solved.u)]


def _exact(case: Case) -> list[tuple[str, Array]]:
    """R and u at the end, named R and h: the errors of h are those of u."""
    x, Sc = places(case.solution), case.solution.material.Sc
    h, R = case.solution.layers(x, case.solution.until)
    return [("R", R), ("h", h + Sc * x)]


def places(solution: exact.ExactSolution) -> Array:
    """Where the solution holds, away from open ends."""
    margin = MARGIN * solution.length if solution.ends == "open" else 0.0
    low, high = solution.window
    return np.linspace(max(low, margin), min(high, solution.length - margin), PLACES)


def _row(
    case: Case, quantity: str, cells: int, gap: Array, estimate: float, index: float = np.nan
) -> dict[str, Any]:
    """Errors relative to the range of the exact R, those of h to that of R and u together."""
    (_, R), (_, u) = _exact(case)
    scale = float(np.ptp(R) + (np.ptp(u) if quantity == "h" else 0.0))
    return {
        "regime": case.regime,
        "solution": case.solution.name,
        "quantity": quantity,
        "cells": cells,
        "true_error": significant(float(np.mean(np.abs(gap))) / scale, 3),
        "estimate": significant(estimate / scale, 3),
        "index": significant(index / scale, 3),
    }


def coverage(estimates: pd.DataFrame) -> pd.DataFrame:
    """How many estimates are at least the true error, for every regime, quantity and rule."""
    confirmed = estimates["triples"] >= 2
    steps = estimates["quantity"] == STEPS
    rules = {
        TWO_TRIPLES: (confirmed, "estimate"),
        ONE_TRIPLE: (estimates["triples"] == 1, "estimate"),
        INDEX: (confirmed, "index"),
        ADDED_UP: (steps, "estimate"),
    }
    rows = []
    for rule, (chosen, column) in rules.items():
        for key, group in estimates[chosen].groupby(["regime", "quantity"], sort=False):
            ratio = group[column] / group["true_error"]
            rows.append(
                {
                    "regime": key[0],
                    "quantity": key[1],
                    "rule": rule,
                    "estimates": len(group),
                    "covered": significant(float((ratio >= 1).mean()), 3),
                    "least": significant(float(ratio.min()), 2),
                    "median": significant(float(ratio.median()), 2),
                    "nine_in_ten_below": significant(float(ratio.quantile(0.9)), 2),
                }
            )
    return pd.DataFrame(rows)


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """Whether the estimate covers, in space before and past t*, and in time."""
    table = tables["comparison"]
    space = table[table["rule"] == TWO_TRIPLES]
    claims = [
        _claim(f"coverage {regime}", f"The error stated of R and of h {regime}", rows, table)
        for regime, rows in space.groupby("regime", sort=False)
    ]
    return [
        *claims,
        _claim(
            "coverage of the steps",
            "The error stated of the steps in time",
            table[table["rule"] == ADDED_UP],
            table,
        ),
    ]


def _claim(name: str, subject: str, rows: pd.DataFrame, table: pd.DataFrame) -> Claim:
    good = bool((rows["covered"] >= COVERED).all())
    evidence = "; ".join(
        f"{row.quantity}: {row.covered:.1%} of {row.estimates}; the estimate is at least "
        f"{row.least:g} times the true error, and {row.median:g} times in the median"
        for row in rows.itertuples()
    )
    alone = table[(table["rule"] == INDEX) & table["regime"].isin(rows["regime"])]
    if not (rows["quantity"] == STEPS).any():
        shares = ", ".join(f"{row.quantity} {row.covered:.1%}" for row in alone.itertuples())
        evidence += f". The index of the last three grids alone covers {shares}"
    return quality_check(
        name=name,
        statement=f"{subject} is at least the true one in {COVERED:.0%} of the cases.",
        verdict=Verdict.AGREE if good else Verdict.DISAGREE,
        evidence=evidence,
        tolerance=WHY,
    )


def draw(tables: dict[str, pd.DataFrame]) -> Figure:
    """Estimate over true error against the true error, before and past t*."""
    figure, axes = style.panels(1, 2)
    estimates = tables["estimates"]
    confirmed = estimates[estimates["triples"] >= 2]
    for axis, regime in zip(axes, (BEFORE, PAST), strict=True):
        rows = confirmed[confirmed["regime"] == regime]
        for column, label, color, marker in (
            ("index", INDEX, "0.6", "x"),
            ("estimate", TWO_TRIPLES, BCRE.color, BCRE.marker),
        ):
            ratio = rows[column] / rows["true_error"]
            axis.loglog(rows["true_error"], ratio, marker, color=color, label=label, alpha=0.6)
        axis.axhline(1.0, color="k", linewidth=1.0)
        axis.set(xlabel="true error over the range of the layers", title=f"R and h {regime}")
    axes[0].set_ylabel("estimate/true error")
    axes[0].legend(loc="upper right")
    return figure
