"""What follows from the scenes and the thresholds: shares, rules that are right or not, slopes."""

from __future__ import annotations

from typing import Any

import pandas as pd

from bcre_studies.comparison.rounding import significant
from bcre_studies.models.registry import AUTOMATON, BCRE
from bcre_studies.validation.agreement_map.measured import TOLERANCE
from bcre_studies.validation.agreement_map.rules import (
    accuracies,
    judged,
    rules,
    shares,
    three_words,
)
from bcre_studies.validation.agreement_map.thresholds import (
    HALF_WIDTH,
    LENGTH,
    OTHER_PLACES,
    THICKNESSES,
    TO_FOOT,
)

TEST_SEED, FIT_SEED = 2, 3
"""Of the scenes that rules are tested on, and of those that one is fitted to."""

Row = dict[str, Any]


def compared(scenes: pd.DataFrame, thresholds: pd.DataFrame) -> pd.DataFrame:
    """Shares, how often the rules are right on scenes not used to find them, and thresholds."""
    tested = judged(scenes[scenes["seed"] == TEST_SEED])
    rows = shares(scenes[scenes["seed"] == TEST_SEED], TOLERANCE)
    for rule in rules(judged(scenes[scenes["seed"] == FIT_SEED])):
        rows += accuracies(rule, tested)
    rows.append(three_words(tested))
    rows += [
        _slope_row(thresholds, thickness, peclet)
        for thickness in THICKNESSES
        for peclet in sorted(thresholds[thresholds["model"] == AUTOMATON.name]["peclet"].unique())
    ]
    rows += [
        _place_row(thresholds, thickness, length, to_foot)
        for thickness in THICKNESSES[1:]
        for length, to_foot in OTHER_PLACES
    ]
    return pd.DataFrame(rows)


def _slope_row(thresholds: pd.DataFrame, thickness: float, peclet: float) -> Row:
    usual = _at(thresholds, thickness)
    own = usual[(usual["model"] == AUTOMATON.name) & (usual["peclet"] == peclet)]["s"].item()
    coarse, fine = bcre_thresholds(usual)
    error = abs(fine - coarse) + HALF_WIDTH
    return _row(f"a = {thickness:g}, Pe = {peclet:g}", own, fine, error)


def _place_row(thresholds: pd.DataFrame, thickness: float, length: float, to_foot: float) -> Row:
    """On one grid; the error is the larger one of the usual place, of both its grids."""
    there = _at(thresholds, thickness, length, to_foot).set_index("model")["s"]
    coarse, fine = bcre_thresholds(_at(thresholds, thickness))
    error = 2 * abs(fine - coarse) + HALF_WIDTH
    case = f"a = {thickness:g}, Pe = 1, L = {length:g}, {to_foot:g} from the foot"
    return _row(case, float(there[AUTOMATON.name]), float(there[BCRE.name]), error)


def _at(
    thresholds: pd.DataFrame, thickness: float, length: float = LENGTH, to_foot: float = TO_FOOT
) -> pd.DataFrame:
    return thresholds[
        (thresholds["thickness"] == thickness)
        & (thresholds["length"] == length)
        & (thresholds["to_foot"] == to_foot)
    ]


def _row(case: str, own: float, bcre: float, error: float) -> Row:
    return {
        "quantity": "s at which it runs to the top",
        "case": case,
        AUTOMATON.column: own,
        "low": round(own - HALF_WIDTH, 4),
        "high": round(own + HALF_WIDTH, 4),
        BCRE.column: bcre,
        f"{BCRE.column}_error": significant(error, 1),
        "difference": significant(abs(own - bcre) / bcre, 3),
    }


def bcre_thresholds(usual: pd.DataFrame) -> tuple[float, float]:
    """On both grids; of the thinnest pulse the closed form, s = 1."""
    found = usual[usual["model"] == BCRE.name].sort_values("peclet")["s"].tolist()
    return (found[1], found[0]) if found else (1.0, 1.0)
