"""The four mechanisms, each in a scene of its own: measured in all models, and closed forms.

* The rolling front starts from R = 1e-150, so that the full equations stay linear, and follows the
  level R = const t^(-1/2). Differences are relative to V + v, the speed against the drift: V itself
  vanishes at Sd.
* The surface wave's speed is the phase of a Fourier mode after a quarter of a turn.
* The scarp is compared at equal height: at equal time the climb multiplies every early difference.
  The pulse is so thick that gamma R far exceeds V and raises a scarp at once; with D = 1 that scarp
  is resolved without kappa.
* The reach ends where R, or the change of h, first exceeds 1 % of its largest value. It is measured
  uphill from the pulse's own edge at the start; negative where that edge is swept downhill.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

import bcre_ca
import bcre_pde
from bcre_pde import simple_wave
from bcre_studies.comparison.compare import compare_each
from bcre_studies.comparison.rounding import significant
from bcre_studies.models.automaton import rule_of
from bcre_studies.models.bcre import problem_of
from bcre_studies.models.run import Run
from bcre_studies.observables import fronts
from bcre_studies.scenes.domain import Domain
from bcre_studies.scenes.scene import Scene, Time, load
from bcre_studies.scenes.terms import Incline, Sine, Uniform

TOLERANCE = 0.05
WHY = (
    "of the speed: over the 100 lengths of the paper's figures an arrival 5 lengths apart; "
    "of the initial pulse's half-width for the reach, under half of the automaton's cell"
)
FRONT, WAVE, SCARP = "front speed V", "surface wave speed", "scarp speed c"
REACH_R, REACH_H = "reach of R", "reach of the change of h"
QUANTITIES = (FRONT, WAVE, SCARP, REACH_R, REACH_H)

CELLS = (1.0, 0.25)
Row = dict[str, Any]
EXCESSES = (1.2, 2.1, 3.2, 5.0)
LAYERS = (1.0, 2.0, 5.0, 10.0, 20.0)
HEIGHTS = (30.0, 40.0, 50.0)
WAVELENGTH = 20.0
EDGE = 0.01
FIGURE3_EXCESS, PULSE_WIDTH = -0.02, 4.0
HALF_WIDTH = PULSE_WIDTH * math.sqrt(-math.log(EDGE))
"""From the centre of figure 3's pulse to its edge at the start."""


def front(d: float, excess: float) -> list[Row]:
    """(a) on the slope Sc + excess, from 2.4 to 9.6 or more growth times after the release."""
    scene = load("figure1").with_changes(
        **{"length": 160.0, "cells": round(160 / d), "until": 800.0, "step": 0.4 * d},
        **{
            "surface.0.slope": 0.5 + excess,
            "rolling.0.amplitude": 1e-150,
            "rolling.0.centre": 120.0,
        },
    )
    times = [200.0, 400.0, 800.0]
    v, D, sigma = scene.material.v, scene.material.D, scene.material.gamma * excess
    width = 3.0
    release = 1e-150 * width / (2 * np.sqrt(D * times[0]))
    theory = bcre_pde.theory.uphill_front_speed(v, D, sigma)
    (result,) = compare_each(
        scene,
        times,
        lambda run: [fronts.front_speed(run, release)],
        [v + theory],
        TOLERANCE,
        coarsest=80,
        finest=640,
    )
    own_theory = bcre_ca.theory.uphill_front_speed(v, D, sigma, d, 0.4 * d)
    return [_row(FRONT, d, "S - Sc", excess, result.row(own_theory, theory))]


def wave(d: float, R0: float) -> list[Row]:
    """(b) for one wave of 20 lengths, 1e-6 high, under R0."""
    material = load("rough_slope").material
    theory = material.gamma * R0
    k = 2 * np.pi / WAVELENGTH
    span = WAVELENGTH / theory / 4
    scene = Scene(
        title="One wave of the surface under a uniform rolling layer",
        material=material,
        domain=Domain(length=WAVELENGTH, cells=round(WAVELENGTH / d), ends="periodic"),
        time=Time(until=span, step=0.4 * d),
        surface=(
            Incline(kind="incline", slope=material.Sc),
            Sine(kind="sine", amplitude=1e-6, wavelength=WAVELENGTH),
        ),
        rolling=(Uniform(kind="uniform", amplitude=R0),),
    )
    rule = rule_of(scene)

    def speed(run: Run) -> list[float]:
        return [fronts.mode_rate(run.x, run.u[0], run.u[1], span, k).imag / k]

    (result,) = compare_each(
        scene,
        [0.0, span],
        speed,
        [theory],
        TOLERANCE,
        coarsest=10,
        finest=160,
    )
    own_theory = bcre_ca.theory.surface_mode_rate(rule.gamma, R0, d, rule.dt, k).imag / k
    return [_row(WAVE, d, "gamma R0", theory, result.row(own_theory, theory))]


def scarp(d: float) -> list[Row]:
    """(c) above a pulse 100 high at the foot of a slope Sc + 1, at several heights."""
    scene = load("figure1").with_changes(
        **{"D": 1.0, "length": 80.0, "cells": round(80 / d), "until": 280.0},
        **{"step": 0.4 if d == 1 else 0.4 * d**2, "surface.0.slope": 1.5},
        **{"rolling.0.amplitude": 100.0, "rolling.0.centre": 70.0},
    )
    times = [float(t) for t in np.arange(0.0, 281.0, 2.0)]
    material = problem_of(scene).material
    laws = [simple_wave.scarp_speed(material, H) for H in HEIGHTS]
    results = compare_each(
        scene,
        times,
        lambda run: [fronts.scarp_speed(run, H) for H in HEIGHTS],
        laws,
        TOLERANCE,
        coarsest=40,
        finest=640,
    )
    return [
        _row(SCARP, d, "H", H, result.row(np.nan, law))
        for H, law, result in zip(HEIGHTS, laws, results, strict=True)
    ]


def reach(d: float) -> list[Row]:
    """(d) in figure 3."""
    scene = load("figure3").with_changes(cells=round(100 / d), step=0.2 * d)

    def reaches(run: Run) -> list[float]:
        change = np.abs(run.u[1] - run.u[0])
        start, *ends = (
            fronts.exponential_edge(run.x, values, EDGE * values.max())
            for values in (run.R[0], run.R[1], change)
        )
        return [start - end for end in ends]

    results = compare_each(
        scene, [0.0, scene.time.until], reaches, [HALF_WIDTH] * 2, TOLERANCE, finest=800
    )
    theory = closed_reaches(scene, scene.material.D)
    rule = rule_of(scene)
    own_theory = closed_reaches(scene, rule.effective_diffusion(), rule.dt)
    return [
        _row(quantity, d, "", np.nan, result.row(own, nominal))
        for quantity, result, own, nominal in zip(
            (REACH_R, REACH_H), results, own_theory, theory, strict=True
        )
    ]


def closed_reaches(scene: Scene, D: float, dt: float = 0.0) -> tuple[float, float]:
    """Reach of R and of the change of h on a frozen slope, where the pulse stays Gaussian.

    Its squared width is w^2 + 4 D t, its centre v t downhill; h changes as the integral of R over
    time, which explicit steps of dt take at their beginnings.
    """
    material, until = scene.material, scene.time.until
    x, t = np.linspace(-50, 50, 4001), np.linspace(0, until, 501)[:, None]
    square = PULSE_WIDTH**2 + 4 * D * t
    sigma = material.gamma * FIGURE3_EXCESS
    R = np.exp(sigma * t - (x - material.v * t) ** 2 / square) / np.sqrt(square)
    change = np.trapezoid(R, t, axis=0) + dt / 2 * (R[0] - R[-1])
    start, end, changed = (
        fronts.edge(x, values, EDGE * values.max()) for values in (R[0], R[-1], change)
    )
    return start - end, start - changed


def _row(quantity: str, d: float, argument: str, value: float, row: Row) -> Row:
    value = significant(value, 5)
    return {"quantity": quantity, "d": d, "argument": argument, "value": value, **row}
