"""Errors on successive grids, and the order that is fitted to them."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from bcre_ca.rule import Scheme
from bcre_pde import exact, simple_wave
from bcre_pde.solve import TOLERANCE
from bcre_studies.comparison.rounding import significant
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.scenes.domain import Array
from bcre_studies.verification.order_of_accuracy.expected import CA, EXPECTED, PDE, kind
from bcre_studies.verification.order_of_accuracy.layers import (
    EXPLICIT,
    automaton_layer,
    errors,
    pde_layer,
    solutions,
)

GRIDS = {CA: (200, 400, 800, 1600, 3200), PDE: (25, 50, 100, 200, 400)}
SURFACE_MODE_GRIDS = (8, 12, 16, 24, 32)
"""A mode of 1e-7 leaves no more room above rounding."""
LIMITED_GRIDS = (100, 200, 400, 800, 1600)
"""Of the limited scheme; surface modes, on whose 1e-7 rounding counts earlier, on cells twice as
long."""
IMPLICIT_GRIDS = (25, 40, 60, 90, 135)
"""Their Jacobians make finer grids slow, and their tolerance leaves no room for more."""
TIME_ERROR = {"explicit": 1e-11, "implicit": 1e-7}
"""What the tolerances in time leave at the end, relative to R: a hundred to a thousand steps."""
BROKEN_GRIDS = (100, 200, 400, 800, 1600)

NORMS = ("L1", "L2", "max")
Row = dict[str, Any]


def observed_order(cells: Array, error: Array, floor: float) -> float:
    """Slope of -ln(error) over ln(cells), the three finest grids with an error above the floor."""
    usable = error > floor
    x, y = np.log(cells[usable][-3:]), np.log(error[usable][-3:])
    return float(-np.polyfit(x, y, 1)[0]) if x.size >= 2 else float("nan")


def errors_of(case: tuple[str, str, Any]) -> list[Row]:
    """The errors on every grid, relative to the spread of R; a case is solution, model, scheme."""
    label, model, scheme = case
    solution = solutions()[label]
    rows = []
    for cells in _grids(solution, model, scheme):
        if model == CA:
            x, R = automaton_layer(solution, cells, scheme[1], scheme[0])
        else:
            x, R = pde_layer(solution, cells, scheme)
        spread = float(np.ptp(solution.layers(x, solution.until)[1]))
        absolute = errors(solution, x, R)
        rows.append(
            {
                "solution": label,
                "model": model,
                "scheme": named(*scheme) if model == CA else scheme,
                "cells": cells,
                **{norm: significant(error / spread, 2) for norm, error in absolute.items()},
                "floor": _floor(solution, model, scheme) / spread,
            }
        )
    return rows


def named(scheme: Scheme, share: float) -> str:
    """How the tables call the automaton's scheme with this part of its largest stable step."""
    kind = "" if scheme == "upwind" else f"{scheme}, "
    return f"{kind}{share:g} of the stable step"


def _grids(solution: exact.ExactSolution, model: str, scheme: Any) -> tuple[int, ...]:
    if model == CA and scheme[0] != "limited":
        return GRIDS[CA]
    if model == CA:
        coarser = 2 if solution.name == "surface mode" else 1
        return tuple(cells // coarser for cells in LIMITED_GRIDS)
    if solution.name == "surface mode":
        return SURFACE_MODE_GRIDS
    return GRIDS[PDE] if scheme in EXPLICIT else IMPLICIT_GRIDS


def _floor(solution: exact.ExactSolution, model: str, scheme: Any) -> float:
    """Error below which the tolerance in time, or rounding, counts."""
    if model == CA:
        return solution.floor
    left = TIME_ERROR["explicit" if scheme in EXPLICIT else "implicit"]
    largest = float(solution.layers(np.linspace(*solution.window, 200), solution.until)[1].max())
    return max(solution.floor, left * largest)


def fit(key: dict[str, str], group: pd.DataFrame) -> Row:
    """Fitted orders, the error on the finest grid, and whether both are what they must be."""
    cells, floor = group["cells"].to_numpy(dtype=float), float(group["floor"].iloc[0])
    orders = {
        f"order_{norm}": significant(observed_order(cells, group[norm].to_numpy(), floor), 3)
        for norm in NORMS
    }
    error = float(group["L1"].iloc[-1])
    expected = EXPECTED[kind(key["model"], key["scheme"])]
    good = expected.lowest <= orders["order_L1"] <= expected.highest and error <= expected.error
    return {
        **key,
        "formal_order": expected.order,
        **orders,
        "L1_on_finest": error,
        "verdict": str(Verdict.AGREE if good else Verdict.DISAGREE),
    }


def past_breaking(model: str) -> list[Row]:
    """Differences of R between successive grids after the climbing wave has broken."""
    solution = solutions()["climbing wave"]
    x = np.linspace(0.5, 19.5, 400)
    start = solution.layers(np.linspace(0, 20, 20001), 0.0)[1]
    rise = float(np.gradient(start, 0.001).max())
    breaking = simple_wave.breaking_time(solution.material.gamma * rise)
    rows = []
    for part in (1.1, 1.5, 2.0):
        later = replace(solution, until=part * breaking)
        profiles = [np.interp(x, *_layer_past_breaking(later, model, n)) for n in BROKEN_GRIDS]
        gaps = [np.abs(a - b) for a, b in itertools.pairwise(profiles)]
        change = np.array([gap.mean() for gap in gaps])
        finer = np.array(BROKEN_GRIDS[1:], dtype=float)
        rows.append(
            {
                "model": model,
                "t_over_t_star": part,
                "order": significant(observed_order(finer, change, 0.0), 3),
                "change_on_finest": significant(float(change[-1]), 3),
                "largest_at_x": significant(float(x[int(np.argmax(gaps[-1]))]), 3),
            }
        )
    return rows


def _layer_past_breaking(
    solution: exact.ExactSolution, model: str, cells: int
) -> tuple[Array, Array]:
    if model == CA:
        return automaton_layer(solution, cells, 0.5)
    return pde_layer(solution, cells, "runge-kutta", TOLERANCE)
