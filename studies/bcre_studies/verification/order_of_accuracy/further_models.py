"""The other models on exact solutions of their own: observed orders, errors and their bounds.

* Thick flow (Aradian et al.): the simple wave R = R0(x + c(R) t), in PDE and automaton.
* Hadeler-Kuttler: R = R0 on S - Sc = A exp((gamma/beta)(x + gamma R0 t)), in PDE and automaton; and
  the silo that rises evenly, S = Sc (L - x)/(L - x + beta/gamma) at 0.95 L.
* Hwa-Kardar: the Cole-Hopf wave, in PDE and in the one-layer rule.
* Prigozhin-Zaltzman: half heap A - Sc x, A = sqrt(2 Sc Q t), and undermining by
  sqrt(2 M/(Sc - S0)), on the isotonic step.

The parameters are those of no other file. An error is a mean distance on the finest grid.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

import bcre_ca
import bcre_pde
from bcre_ca import upwind_height
from bcre_pde import exact
from bcre_pde.line import hadeler_kuttler as hk
from bcre_pde.line import hwa_kardar, prigozhin_zaltzman
from bcre_pde.source import Source
from bcre_studies.comparison.rounding import significant
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.models.registry import QUASI_STATIC
from bcre_studies.verification.order_of_accuracy.expected import CA, PDE

Row = dict[str, object]

FIRST, HIGH = (0.9, 1.1), (4.0, math.inf)
EXACT = (-math.inf, math.inf)
"""An error of rounding has no order, nor has one that is measured on a single grid."""

THICK = bcre_pde.Material(v=0.8, D=0.0, gamma=0.45, Sc=0.35, v_up=1.1, Gamma=0.55)
DRIVEN = hk.SlopeDriven(beta=1.1, gamma=0.3, Sc=0.55)
SURFACE = hwa_kardar.Surface(nu=0.25, lam=0.9, Sc=0.3)
LENGTH, LAYER, AMPLITUDE = 16.0, 0.7, 2e-3


class Case(NamedTuple):
    """A solution in one model: its grids, its error on one, and what it must keep to."""

    solution: str
    model: str
    grids: tuple[int, ...]
    error: Callable[[int], float]
    order: tuple[float, float]
    bound: float


def thick_wave(model: str, cells: int) -> float:
    """Mean error of R."""
    wave = exact.simple_wave_of_hump(THICK, 0.35, 1.8, 24.0, 1.5)
    if model == PDE:
        end = bcre_pde.solve(wave.problem, [wave.until], cells, tolerance=1e-12)
        return float(np.abs(end.R[-1] - wave.layers(end.x, wave.until)[1]).mean())
    d = wave.length / cells
    x = np.asarray((np.arange(cells) + 0.5) * d)
    m = THICK
    rule = bcre_ca.Rule(m.v, m.D, m.gamma, m.Sc, d, wave.until / cells, v_up=m.v_up, Gamma=m.Gamma)
    _, R = bcre_ca.evolve(*wave.layers(x, 0.0), rule, cells, "periodic")
    return float(np.abs(R - wave.layers(x, wave.until)[1]).mean())


def _steepening(x: np.ndarray, t: float) -> np.ndarray:
    rate = DRIVEN.gamma / DRIVEN.beta
    return np.asarray(-AMPLITUDE / rate * np.exp(rate * (x + DRIVEN.gamma * LAYER * t)))


def exponential_slope(model: str, cells: int) -> float:
    """Mean error of u, less its mean, where nothing from the ends has come."""
    until, m = 2.0, DRIVEN
    d = LENGTH / cells
    x = np.asarray((np.arange(cells) + 0.5) * d)
    if model == PDE:

        def initial(at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            return _steepening(at, 0.0) - m.Sc * at, np.full_like(at, LAYER)

        problem = bcre_pde.Problem(initial, m, LENGTH, "open")
        end = bcre_pde.solve(problem, [until], cells, tolerance=1e-10, equation=hk.HadelerKuttler)
        u = end.u[-1]
    else:
        rule = bcre_ca.Rule(0.0, 0.0, m.gamma, m.Sc, d, until / (6 * cells), beta=m.beta)
        start = _steepening(x, 0.0) - m.Sc * x
        u = bcre_ca.evolve(start, np.full(cells, LAYER), rule, 6 * cells)[0] + m.Sc * x
    inside = (x > 6) & (x < 10)
    gap = (u - _steepening(x, until))[inside]
    return float(np.abs(gap - (gap.mean() if model == PDE else 0.0)).mean())


def silo(model: str, cells: int) -> float:
    """Relative error of S at 0.95 L once the silo rises evenly."""
    length, w, m = 8.0, 0.1, DRIVEN
    d, until = length / cells, 250.0
    x = np.asarray((np.arange(cells) + 0.5) * d)
    place, width = 0.2, 0.4
    if model == PDE:
        problem = bcre_pde.Problem(
            lambda at: (0 * at, 0 * at), m, length, "wall", (Source(w * length, place, width),)
        )
        h = bcre_pde.solve(problem, [until], cells, equation=hk.HadelerKuttler).h[-1]
    else:
        rule = bcre_ca.Rule(0.0, 0.0, m.gamma, m.Sc, d, dt=1.0, beta=m.beta)
        source = bcre_ca.Source(w * length, place, width)
        empty = bcre_ca.Pile(np.zeros(cells), np.zeros(cells))
        (pile,) = bcre_ca.frames(empty, rule, [until], "wall", sources=[source])
        h = pile.h
    S = float(np.interp(0.95 * length, x[:-1] + d / 2, -np.diff(h) / d))
    return abs(S / float(hk.silo_slope(np.array(0.95 * length), m, length)) - 1)


def cole_hopf(model: str, cells: int) -> float:
    """Mean error of the decaying wave."""
    length, until, a = 9.0, 1.5, 0.5
    k, m = 2 * math.pi / length, SURFACE

    def wave(x: np.ndarray, t: float) -> np.ndarray:
        return hwa_kardar.decaying_wave(x, t, m, a, k)

    if model == PDE:
        problem = bcre_pde.Problem(
            lambda x: (wave(x, 0.0) - m.Sc * x, 0 * x), m, length, "periodic"
        )
        end = bcre_pde.solve(
            problem, [until], cells, tolerance=1e-12, equation=hwa_kardar.HwaKardar
        )
        return float(np.abs(end.u[-1] - wave(end.x, until)).mean())
    d = length / cells
    x = np.asarray((np.arange(cells) + 0.5) * d)
    start = wave(x, 0.0)
    bound = upwind_height.largest_stable_step(start, m.lam, m.nu, d)
    steps = math.ceil(until / (0.5 * bound))
    w = upwind_height.march(start, m.lam, m.nu, d, until / steps, steps)
    return float(np.abs(w - wave(x, until)).mean())


def half_heap(cells: int) -> float:
    """Mean error of h; the foot is an edge of cells."""
    length, Sc, rate = 12.0, 0.4, 0.2
    until = Sc * 6.0**2 / (2 * rate)
    dx = length / cells
    x = np.asarray((np.arange(cells) + 0.5) * dx)
    source = Source(rate, dx / 2, dx)
    h, _ = prigozhin_zaltzman.evolve(np.zeros(cells), Sc, dx, [0.0, until], "wall", [source])
    return float(np.abs(h[-1] - prigozhin_zaltzman.half_heap(x, until, Sc, rate)).mean())


def undermining(cells: int) -> float:
    """Mean error of h of a slope from whose foot sand is taken, over eight amounts of it.

    The wedge that slides begins somewhere within a cell, which decides how large one error is.
    """
    length, S0, Sc = 18.0, 0.3, 0.75
    dx = length / cells
    x = np.asarray((np.arange(cells) + 0.5) * dx)
    errors = []
    for M in np.linspace(2.3, 3.5, 8):
        g = S0 * (length - x)
        g[-1] -= M / dx
        h, _ = prigozhin_zaltzman.settle(g, Sc, dx, "wall")
        top = length - prigozhin_zaltzman.undermined_length(M, S0, Sc)
        exact = S0 * (length - x) - (Sc - S0) * np.maximum(x - top, 0.0)
        errors.append(np.abs(h - exact).mean())
    return float(np.mean(errors))


def _of(function: Callable[[str, int], float], model: str) -> Callable[[int], float]:
    return lambda cells: function(model, cells)


CASES = (
    Case("thick climbing wave", PDE, (100, 200, 400), _of(thick_wave, PDE), HIGH, 1e-7),
    Case("thick climbing wave", CA, (400, 800, 1600), _of(thick_wave, CA), FIRST, 2e-3),
    Case("exponential slope", PDE, (50, 70, 100), _of(exponential_slope, PDE), HIGH, 1e-8),
    Case("exponential slope", CA, (100, 200, 400), _of(exponential_slope, CA), FIRST, 1e-4),
    Case("silo at 0.95 L", PDE, (100,), _of(silo, PDE), EXACT, 0.01),
    Case("silo at 0.95 L", CA, (160,), _of(silo, CA), EXACT, 0.01),
    Case("Cole-Hopf wave", PDE, (16, 32, 64), _of(cole_hopf, PDE), HIGH, 1e-5),
    Case("Cole-Hopf wave", CA, (64, 128, 256), _of(cole_hopf, CA), FIRST, 2e-3),
    Case("half heap", QUASI_STATIC.name, (120,), half_heap, EXACT, 1e-12),
    Case("undermining", QUASI_STATIC.name, (200, 400, 800), undermining, (1.0, math.inf), 1e-4),
)


def observed(number: int) -> Row:
    """The row of one of :data:`CASES`."""
    case = CASES[number]
    errors = [case.error(cells) for cells in case.grids]
    fitted = len(errors) > 1
    order = -float(np.polyfit(np.log(case.grids), np.log(errors), 1)[0]) if fitted else math.nan
    low, high = case.order
    good = (not fitted or low <= order <= high) and errors[-1] <= case.bound
    return {
        "solution": case.solution,
        "model": case.model,
        "cells": case.grids[-1],
        "order": significant(order, 3),
        "least order": low if fitted else math.nan,
        "error": significant(errors[-1], 2) if errors[-1] > 1e-13 else 0.0,
        "bound": case.bound,
        "verdict": str(Verdict.AGREE if good else Verdict.DISAGREE),
    }
