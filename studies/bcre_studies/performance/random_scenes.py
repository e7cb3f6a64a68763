"""Scenes drawn at random, to test what is predicted of scenes that nobody has seen before.

Every number is drawn for itself from a range that a user might take it from, the dimensionless ones
rather than the others: the Peclet number v L/D, the way v T/L that the layer drifts, the growth
gamma (S0 - Sc) T, the width of the pulse and its place in lengths of the domain. No scene is left
out for what comes of it. Scene ``index`` is the same for ever, on every machine.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from bcre_studies.comparison.rounding import significant
from bcre_studies.scenes.scene import Scene

SEED = 20_261
"""First half of the seed; the second is the index of the scene."""

PULSE, WAVES = "pulse", "waves"

DIGITS = 4
"""Numbers of a scene are drawn to so many digits, so that they can be read and typed."""


def random_scene(index: int) -> Scene:
    """Scene number ``index``: a pulse on a slope, or waves under a layer with joined ends."""
    chance = np.random.default_rng([SEED, index])
    return _waves(index, chance) if chance.random() < 0.2 else _pulse(index, chance)


def kind_of(scene: Scene) -> str:
    """What kind of random scene it is: waves have joined ends, pulses have not."""
    return WAVES if scene.domain.ends == "periodic" else PULSE


def _pulse(index: int, chance: np.random.Generator) -> Scene:
    """One Gaussian pulse on a slope below or above repose, at times rough."""
    material, length, until = _material(chance)
    growth = float(chance.uniform(-2.0, 6.0))
    slope = material["Sc"] + growth / (material["gamma"] * until)
    surface = [{"kind": "incline", "slope": significant(slope, DIGITS)}]
    if chance.random() < 0.25:
        surface.append(_noise(chance, length))
    pulse = {
        "kind": "gaussian",
        "amplitude": _between(chance, 0.01, 3.0),
        "centre": significant(length * float(chance.uniform(0.15, 0.75)), DIGITS),
        "width": significant(length * _between(chance, 0.03, 0.1), DIGITS),
    }
    return _scene(f"Random scene {index}: {PULSE}", material, length, "open", until, surface, pulse)


def _waves(index: int, chance: np.random.Generator) -> Scene:
    """A rough surface at repose under an even layer; the ends are joined."""
    material, length, until = _material(chance)
    surface = [{"kind": "incline", "slope": material["Sc"]}, _noise(chance, length)]
    layer = {"kind": "uniform", "amplitude": _between(chance, 0.1, 3.0)}
    return _scene(
        f"Random scene {index}: {WAVES}", material, length, "periodic", until, surface, layer
    )


def _material(chance: np.random.Generator) -> tuple[dict[str, float], float, float]:
    """``[material]``, the length and the end."""
    length, v = _between(chance, 20.0, 200.0), _between(chance, 0.05, 3.0)
    until = significant(length / v * float(chance.uniform(0.1, 0.8)), DIGITS)
    material = {
        "v": v,
        "D": significant(v * length / _between(chance, 30.0, 3000.0), DIGITS),
        "gamma": _between(chance, 0.003, 0.1),
        "Sc": significant(float(chance.uniform(0.3, 0.8)), DIGITS),
    }
    if chance.random() < 1 / 3:
        material["kappa"] = significant(
            material["gamma"] * length * _between(chance, 0.002, 0.02), DIGITS
        )
    return material, length, until


def _noise(chance: np.random.Generator, length: float) -> dict[str, Any]:
    amplitude = significant(length * _between(chance, 1e-4, 2e-3), DIGITS)
    return {"kind": "noise", "amplitude": amplitude, "seed": int(chance.integers(1000))}


def _between(chance: np.random.Generator, low: float, high: float) -> float:
    """Log-uniform between two positive numbers."""
    return significant(float(np.exp(chance.uniform(np.log(low), np.log(high)))), DIGITS)


def _scene(
    title: str,
    material: dict[str, float],
    length: float,
    ends: str,
    until: float,
    surface: list[dict[str, Any]],
    layer: dict[str, Any],
) -> Scene:
    return Scene.model_validate(
        {
            "title": title,
            "material": material,
            "domain": {"length": length, "cells": 100, "ends": ends},
            "time": {"until": until},
            "surface": surface,
            "rolling": [layer],
        }
    )
