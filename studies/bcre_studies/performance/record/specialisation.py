"""What it gains to leave an absent term out of the compiled code, rather than to multiply by zero.

A rule without diffusion, curvature, saturation or cut-off hands the compiler None for it
(``bcre_ca.coefficients``). Each is timed against the same rule with the term present but so small
that it changes nothing, D = 1e-300, kappa = 1e-300, v_up = 1e300, dry = 1e-300; single precision
against double.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

import bcre_ca
from bcre_studies.comparison.rounding import significant
from bcre_studies.system.records import record
from bcre_studies.timing.clock import Call, interleaved

CELLS = (1000, 100_000)
CELL_STEPS = 20_000_000
ROUNDS = 7
READS = "speed/specialisation.csv"

SINGLE = "double precision"
TERMS: dict[str, float] = {"D": 1e-300, "kappa": 1e-300, "v_up": 1e300, "dry": 1e-300}
"""What the automaton's kernels leave out where it is absent, and the value that changes nothing."""


def specialisation_gains() -> pd.DataFrame:
    """Time with the term over time without it, on this machine, all taking turns.

    Returns
    -------
    One row per term and number of cells: term, cells, ratio (above 1: leaving it out gains).
    """
    calls: dict[tuple[str, str, int], Call] = {}
    for cells in CELLS:
        for term in (*TERMS, SINGLE):
            with_term, without = _pair(term, cells)
            calls |= {(term, "with", cells): with_term, (term, "without", cells): without}
    times = interleaved({" ".join(map(str, key)): call for key, call in calls.items()}, ROUNDS)
    seconds = dict(zip(calls, times["median_s"], strict=True))
    rows = [
        {
            "term": term,
            "cells": cells,
            "ratio": significant(seconds[term, "with", cells] / seconds[term, "without", cells], 2),
        }
        for term in (*TERMS, SINGLE)
        for cells in CELLS
    ]
    return pd.DataFrame(rows)


def recorded() -> pd.DataFrame:
    """The gains of the committed record: columns term, cells, ratio.

    Raises
    ------
    FileNotFoundError
        where there is no record.
    """
    return pd.read_csv(record(READS))


def _pair(term: str, cells: int) -> tuple[Call, Call]:
    """The same march with the term and without it."""
    h, R = _layers(cells)
    steps = CELL_STEPS // cells
    rule = bcre_ca.Rule(v=0.1, D=0.1, gamma=0.01, Sc=0.5, d=1.0, dt=0.5)
    if term == SINGLE:
        single = h.astype(np.float32), R.astype(np.float32)
        return _march(h, R, rule, steps), _march(*single, rule, steps)
    absent: dict[str, Any] = {"D": {"D": 0.0}}
    without = replace(rule, **absent.get(term, {}))
    with_term: dict[str, Any] = {term: TERMS[term]}
    return _march(h, R, replace(rule, **with_term), steps), _march(h, R, without, steps)


def _march(h: Any, R: Any, rule: bcre_ca.Rule, steps: int) -> Call:
    return partial(bcre_ca.evolve, h, R, rule, steps)


def _layers(cells: int) -> tuple[Any, Any]:
    """A slope at repose under a layer everywhere, so that every cell is wet and stays so."""
    x = np.arange(cells) + 0.5
    return 0.5 * (cells - x), 1.0 + 0.1 * np.sin(2 * np.pi * x / 100)
