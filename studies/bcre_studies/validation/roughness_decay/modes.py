"""Rates and phase speeds of single modes of u and of R: measured in all models, and closed forms.

All modes of u are read off one run of 32 waves of 1e-6, all modes of R off one spreading pulse.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import bcre_ca
import bcre_pde
from bcre_studies.comparison.compare import compare_each
from bcre_studies.comparison.rounding import significant
from bcre_studies.models.automaton import rule_of
from bcre_studies.models.registry import AUTOMATON, BCRE, COMPARED, Model
from bcre_studies.models.run import Run
from bcre_studies.observables import fronts
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.scene import Scene, load

TOLERANCE = 0.05
WHY = "of a rate: after one decay time the amplitudes differ by less than 2 % of the initial one"
CELLS = (1.0, 0.5)
WAVES = (1, 2, 4, 8, 11, 16, 32)
"""Wavelengths in the length of the domain, 100."""
SPAN = 10.0
R0 = 5.0
U_DECAY, U_SPEED = "decay rate of u", "uphill speed of u"
R_DECAY, R_SPEED = "decay rate of R", "downhill speed of R"
Row = dict[str, Any]


def surface_scene(d: float) -> Scene:
    """32 waves of the surface, 1e-6 high, under R0, with dt = d."""
    return load("rough_slope").with_changes(
        **{"cells": round(100 / d), "until": SPAN, "step": d},
        **{"surface.1.amplitude": 1e-6, "rolling.0.amplitude": R0},
    )


def rolling_scene(d: float) -> Scene:
    """A pulse on the smooth repose slope, where nothing is exchanged: every mode of R at once."""
    return load("rough_slope").with_changes(
        **{"cells": round(100 / d), "until": SPAN, "step": d, "surface.1.amplitude": 0.0},
        **{"rolling.0.kind": "gaussian", "rolling.0.amplitude": 1.0},
        **{"rolling.0.centre": 50.0, "rolling.0.width": 1.5},
    )


def wavenumbers(scene: Scene) -> Array:
    """k of the modes that are measured, shape (K,)."""
    return 2 * np.pi * np.array(WAVES) / scene.domain.length


def mode_rates(field: str, d: float, k: float) -> dict[Model, complex]:
    """Closed forms s of one mode in every model."""
    scene = surface_scene(d) if field == "u" else rolling_scene(d)
    rule = rule_of(scene)
    if field == "u":
        rates = (
            bcre_ca.theory.surface_mode_rate(rule.gamma, R0, d, rule.dt, k),
            bcre_pde.theory.surface_mode_rate(rule.gamma, 0.0, R0, k),
            bcre_pde.theory.surface_mode_rate(rule.gamma, rule.effective_curvature(R0), R0, k),
        )
    else:
        rates = (
            bcre_ca.theory.rolling_mode_rate(rule.v, rule.D, d, rule.dt, k),
            bcre_pde.theory.rolling_mode_rate(rule.v, rule.D, k),
            bcre_pde.theory.rolling_mode_rate(rule.v, rule.effective_diffusion(), k),
        )
    return dict(zip(COMPARED, rates, strict=True))


def mode_rows(case: tuple[str, float]) -> list[Row]:
    field, d = case
    scene = surface_scene(d) if field == "u" else rolling_scene(d)
    waves = wavenumbers(scene)
    names = (U_DECAY, U_SPEED) if field == "u" else (R_DECAY, R_SPEED)
    uphill = 1 if field == "u" else -1

    def split(rate: complex, k: float) -> tuple[float, float]:
        return -rate.real, uphill * rate.imag / k

    def measured(run: Run) -> list[float]:
        before, after = getattr(run, field)
        return [
            part
            for k in waves
            for part in split(fronts.mode_rate(run.x, before, after, SPAN, k), k)
        ]

    rates = [mode_rates(field, d, k) for k in waves]
    own, nominal = (
        [part for rate, k in zip(rates, waves, strict=True) for part in split(rate[model], k)]
        for model in (AUTOMATON, BCRE)
    )
    # BCRE's decay rate may be zero, its phase speed may not.
    scales = [value for pair in zip(own[::2], nominal[1::2], strict=True) for value in pair]
    results = compare_each(scene, [0.0, SPAN], measured, scales, TOLERANCE, finest=800)
    rows = [
        {
            "quantity": names[index % 2],
            "d": d,
            "k": significant(waves[index // 2], 5),
            "k d": significant(waves[index // 2] * d, 5),
            "t": np.nan,
            **result.row(own[index], nominal[index]),
        }
        for index, result in enumerate(results)
    ]
    return rows[::2] + rows[1::2]
