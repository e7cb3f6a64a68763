r"""Rills: a sheet of R that erodes an even slope S > Sc breaks up across the flow.

Sand that runs together digs, and the hollow draws more sand. A ripple of wavenumber k grows at the
rate l of l^2 + l (D K - sigma) - sigma v R0 K/S = 0 (:func:`bcre_ca.plane.theory.rill_growth`).
R0 is the sheet half way between the two times at which the ripple is measured.
"""

from __future__ import annotations

import math

import numpy as np

import bcre_ca
from bcre_ca.plane import Plane, Run, Sand
from bcre_ca.plane.setting import Flows
from bcre_ca.plane.theory import rill_growth
from bcre_studies.scenes.domain import Array

v, GAMMA, SC, S, R0, d, DT = 1.0, 0.1, 0.5, 0.51, 0.1, 0.5, 0.1
ROWS, COLUMNS = 8, 64
RIPPLE = 1e-9
FOLDS = 2.0
"""Each of the two times is so many times 1/l: a ripple that grows outruns the one that decays."""


def growth(flow: Flows, D: float, waves: int) -> tuple[float, float, float]:
    """Wavenumber, predicted rate and measured rate of so many ripples across the plane."""
    k = 2 * math.pi * waves / (COLUMNS * d)
    ripple = np.cos(k * d * np.arange(COLUMNS))
    h = -S * d * np.arange(ROWS)[:, None] + RIPPLE * ripple
    rule = bcre_ca.Rule(v, D, GAMMA, SC, d, DT)
    fall = S * d * ROWS
    plane = Plane(rule, flow, ends="periodic", sides="periodic", fall=fall)
    run = Run(Sand(h, np.full_like(h, R0)), plane, threads=1)
    steps = round(FOLDS / rill_growth(v, D, GAMMA, S, SC, R0, d, k) / DT)

    def amplitude() -> float:
        heights: Array = run.h.mean(axis=0)
        return float(abs(heights @ ripple))

    run.take(steps)
    before, sheet = amplitude(), float(run.R.mean())
    run.take(steps)
    half_way = math.sqrt(sheet * float(run.R.mean()))
    expected = rill_growth(v, D, GAMMA, S, SC, half_way, d, k)
    return k, expected, math.log(amplitude() / before) / (steps * DT)
