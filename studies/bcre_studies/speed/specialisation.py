"""What it gains to leave an absent term out of the compiled code, rather than to multiply by zero.

A rule without curvature, saturation or cut-off hands the compiler None for it
(``bcre_ca.coefficients``). Each is timed against the same rule with the term present but so small
that it changes nothing, kappa = 1e-300, v_up = 1e300, dry = 1e-300; single precision against
double.

Diffusion is not left out of the automaton where D = 0. What that would gain is timed on a sweep of
this module, whose b is None or 0.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numba
import numpy as np
import pandas as pd

import bcre_ca
from bcre_studies.compare import significant
from bcre_studies.report.files import REPORTS
from bcre_studies.speed.clock import Call, interleaved

CELLS = (1000, 100_000)
CELL_STEPS = 20_000_000
ROUNDS = 7
RECORD = REPORTS / "speed" / "specialisation.csv"

KAPPA, V_UP, DRY, D, SINGLE = "kappa", "v_up", "dry", "D", "double precision"
IN_THE_AUTOMATON = (KAPPA, V_UP, DRY)
"""The terms that the automaton's kernels leave out."""


def specialisation_gains() -> pd.DataFrame:
    """Time with the term over time without it, on this machine, all taking turns.

    Returns
    -------
    One row per term and number of cells: term, cells, ratio (above 1: leaving it out gains).
    """
    calls: dict[tuple[str, str, int], Call] = {}
    for cells in CELLS:
        for term in (KAPPA, V_UP, DRY, SINGLE, D):
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
        for term in (KAPPA, V_UP, DRY, SINGLE, D)
        for cells in CELLS
    ]
    return pd.DataFrame(rows)


def recorded(path: Path = RECORD) -> pd.DataFrame:
    """The gains of the committed record: columns term, cells, ratio.

    Raises
    ------
    OSError
        where there is no record.
    """
    return pd.read_csv(path)


def _pair(term: str, cells: int) -> tuple[Call, Call]:
    """The same march with the term and without it."""
    h, R = _layers(cells)
    steps = CELL_STEPS // cells
    rule = bcre_ca.Rule(v=0.1, D=0.1, gamma=0.01, Sc=0.5, d=1.0, dt=0.5)
    if term == SINGLE:
        single = h.astype(np.float32), R.astype(np.float32)
        return _march(h, R, rule, steps), _march(*single, rule, steps)
    if term == D:
        K = replace(rule, D=0.0).coefficients()
        with_b, without_b = (partial(_swept, h, R, K.c, b, K.k, K.s, steps) for b in (0.0, None))
        return with_b, without_b
    tiny: dict[str, Any] = {KAPPA: {"kappa": 1e-300}, V_UP: {"v_up": 1e300}, DRY: {"dry": 1e-300}}
    return _march(h, R, replace(rule, **tiny[term]), steps), _march(h, R, rule, steps)


def _march(h: Any, R: Any, rule: bcre_ca.Rule, steps: int) -> Call:
    return partial(bcre_ca.evolve, h, R, rule, steps)


def _layers(cells: int) -> tuple[Any, Any]:
    """A slope at repose under a layer everywhere, so that every cell is wet and stays so."""
    x = np.arange(cells) + 0.5
    return 0.5 * (cells - x), 1.0 + 0.1 * np.sin(2 * np.pi * x / 100)


def _swept(h: Any, R: Any, c: float, b: float | None, k: float, s: float, steps: int) -> None:
    _sweep(h.copy(), R.copy(), c, b, k, s, steps)


@numba.njit(cache=True, error_model="numpy")
def _sweep(h, R, c, b, k, s, steps):  # type: ignore[no-untyped-def]
    """The upwind rule between closed ends; b = D dt/d^2, or None to leave diffusion out."""
    for _ in range(steps):
        flux_in = c - c
        for i in range(h.size - 1):
            R_i = R[i]
            flux_out = c * R_i if b is None else (c + b) * R_i - b * R[i + 1]
            exchange = R_i * (k * ((h[i] - h[i + 1]) - s))
            h[i] = h[i] - exchange
            R[i] = R_i + ((flux_in - flux_out) + exchange)
            flux_in = flux_out
        R[h.size - 1] += flux_in
