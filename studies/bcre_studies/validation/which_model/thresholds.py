"""The slope from which on a pulse brings the top of figure 1 down: how it goes with the cells.

A slope comes down whole or not at all, so that its threshold is found by halving. It is followed to
finer cells in the automaton and in BCRE, over what counts as down, and over the time allowed.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from bcre_studies.observables.outcome import FALLEN
from bcre_studies.validation.which_model.properties import LONGEST, PULSES, SUBJECTS, Row, climbs

LOW, HIGH = 0.5, 3.2
"""No pulse brings the first of these slopes S0 - Sc down, and the thinnest brings the second."""

KNOWN = 0.01
"""To this a threshold is known."""

NEAR = 0.02
"""How far from the threshold on the grid before one is looked for first."""

SPARSE = (0.5, 0.8, 1.0, 1.2, 1.5, 1.8, 2.2, 2.7, 3.2)
"""The slopes of ``second_critical_angle``."""

RULE, EQUATION, THICK = "automaton", "BCRE", "automaton of Aradian et al."
GRIDS = {RULE: (100, 200, 400, 800), THICK: (100, 200, 400, 800), EQUATION: (100, 200, 400)}
CASES = [(model, pulse) for model in GRIDS for pulse in PULSES]
DEFINITIONS = ((LONGEST, 0.1), (LONGEST, 0.9), (LONGEST / 2, FALLEN), (2 * LONGEST, FALLEN))
"""Other times, and other parts of its excess height that the top must lose; for the automaton."""


def thresholds(case: tuple[str, float]) -> list[Row]:
    """The thresholds of one pulse in one model: on finer and finer cells, by other definitions."""
    model, pulse = case
    subject = next(one for one in SUBJECTS if one.name == model)
    falls = partial(climbs, subject, pulse=pulse)
    rows, near = [], (LOW + HIGH) / 2
    for cells in GRIDS[model]:
        near = _between(partial(falls, cells=cells), near)
        rows.append(_row(model, pulse, cells, LONGEST, FALLEN, near))
    if model == RULE:
        cells = GRIDS[RULE][0]
        for until, fallen in DEFINITIONS:
            asked = partial(falls, cells=cells, until=until, fallen=fallen)
            found = _between(asked, rows[0]["threshold"])
            rows.append(_row(model, pulse, cells, until, fallen, found))
    return rows


def _row(model: str, pulse: float, cells: int, until: float, fallen: float, found: float) -> Row:
    return {
        "model": model,
        "pulse": pulse,
        "cells": cells,
        "t": until,
        "top loses": fallen,
        "threshold": round(found, 2),
        "first of sparse slopes": next(excess for excess in SPARSE if excess > found),
    }


def _between(falls: Callable[[float], bool], near: float) -> float:
    """The middle of the last :data:`KNOWN` between a slope that stands and one that falls."""
    low, high = near - NEAR, near + NEAR
    if falls(low) or not falls(high):
        low, high = LOW, HIGH
    while high - low > KNOWN:
        middle = (low + high) / 2
        low, high = (low, middle) if falls(middle) else (middle, high)
    return (low + high) / 2
