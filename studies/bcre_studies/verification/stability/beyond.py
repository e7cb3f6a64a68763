"""What small waves under explicit steps do not show: R >= 0, and implicit methods."""

from __future__ import annotations

from typing import Any

import numpy as np

import bcre_ca
import bcre_pde
from bcre_pde import Method
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.verification.stability.amplification import Numbers, Variant, rule_with
from bcre_studies.verification.stability.boundaries import FINEST, RAYS, Row, last
from bcre_studies.verification.stability.diagram import AUTOMATON_LIMITS, DRIFT_AND_SPREAD
from bcre_studies.verification.stability.growth import SIZE, noise

LAYER_CELLS = 50_000


def _rough_layer() -> Any:
    """A layer of random thickness over eight decades, half of its cells dry; (N,)."""
    random = np.random.default_rng(7)
    thickness = 10 ** random.uniform(-8, 0, LAYER_CELLS)
    return np.where(random.uniform(size=LAYER_CELLS) < 0.5, thickness, 0.0)


def positivity(variant: Variant) -> Row:
    """The longest step, in parts of the bound, that leaves a rough layer >= 0, over the rays."""
    start, (width, height) = _rough_layer(), AUTOMATON_LIMITS[DRIFT_AND_SPREAD]
    ratios = []
    for angle in (np.arange(RAYS) + 0.5) / RAYS * np.pi / 2:
        ray = Numbers(width * np.cos(angle), height * np.sin(angle), 0.0)
        bound = rule_with(ray, variant).max_stable_step()

        def stays(numbers: Numbers) -> bool:
            h, R = np.zeros_like(start), start.copy()
            bcre_ca.march(h, R, rule_with(numbers, variant), 1, "periodic")
            return bool(R.min() >= 0)

        ratios.append(last(stays, ray.times(bound), 0.5, 4.0))
    least = min(ratios)
    return {
        "variant": str(variant),
        "cells": LAYER_CELLS,
        "least_percent_of_bound": round(100 * least, 1),
        "most_percent_of_bound": round(100 * max(ratios), 1),
        "verdict": str(Verdict.AGREE if least >= 1 - FINEST else Verdict.DISAGREE),
    }


EXPLICIT_STEPS = 100_000
TEN = 10


def implicit_steps(method: Method) -> Row:
    """Noise of 1e-2 over so many explicit steps: how long are the method's, and does it grow?"""
    material, cells = bcre_pde.Material(0.05, 1.0, 0.01, 0.5), 32
    u, R = 1e-2 / SIZE * np.array(noise(cells))
    explicit = bcre_pde.largest_explicit_step(material, 1.0, 1.0)

    def initial(x: Any) -> tuple[Any, Any]:
        at = np.minimum(x, cells - 1).astype(int)
        return u[at] - material.Sc * x, 1 + R[at]

    problem = bcre_pde.Problem(initial, material, float(cells), "periodic")
    until = EXPLICIT_STEPS * explicit
    end = bcre_pde.solve(problem, [until], cells, method, tolerance=1e-3)
    deviation = max(np.abs(end.u[-1]).max(), np.abs(end.R[-1] - 1).max())
    bounded = bool(deviation <= max(np.abs(u).max(), np.abs(R).max()))
    long = bool(until / end.evaluations >= TEN * explicit)
    return {
        "method": method,
        "until_in_explicit_steps": EXPLICIT_STEPS,
        "mean_step_at_least_ten": long,
        "bounded": bounded,
        "verdict": str(Verdict.AGREE if bounded and long else Verdict.DISAGREE),
    }
