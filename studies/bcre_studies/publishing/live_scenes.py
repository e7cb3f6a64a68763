"""The page's live automaton: its sliders, and the scenes of the paper as their values."""

from __future__ import annotations

import math
from typing import Any

from bcre_studies.scenes.scene import Scene, load
from bcre_studies.scenes.terms import Gaussian, Incline


def slope_and_pulse(scene: Scene) -> tuple[float, Gaussian]:
    """S0 and the pulse of a scene that is a pulse on an incline."""
    surface, pulse = scene.surface[0], scene.rolling[0]
    if not (isinstance(surface, Incline) and isinstance(pulse, Gaussian)):
        raise ValueError(f"{scene.title}: must be one pulse on an incline")
    return surface.slope, pulse


def _slider(
    name: str, label: str, low: float, high: float, value: float, *, step: float, log: bool = False
) -> dict[str, Any]:
    ends = [math.log10(end) for end in (low, high, value)] if log else [low, high, value]
    low, high, value = (float(f"{end:.6g}") for end in ends)
    return {
        "name": name,
        "label": label,
        "low": low,
        "high": high,
        "value": value,
        "step": step,
        "log": log,
    }


SLIDERS = [
    _slider("S0", "slope S0 − Sc", -0.5, 4.0, 3.2, step=0.05),
    _slider("pulse", "pulse", 1e-6, 10.0, 1.0, step=0.1, log=True),
    _slider("place", "place of the pulse", 10.0, 90.0, 85.0, step=5.0),
    _slider("v", "drift speed <i>v</i>", 0.01, 3.0, 0.1, step=0.01, log=True),
    _slider("D", "diffusion <i>D</i>", 0.01, 1.0, 0.1, step=0.01, log=True),
    _slider("gamma", "exchange <i>γ</i>", 0.001, 0.1, 0.01, step=0.01, log=True),
    _slider("d", "cell length <i>d</i>", 0.25, 2.0, 1.0, step=0.01, log=True),
]


def _preset(label: str, name: str, **changes: float) -> dict[str, Any]:
    """A scene of the paper as values of the sliders."""
    scene = load(name)
    material, (slope, pulse) = scene.material, slope_and_pulse(scene)
    values = {
        "S0": slope - material.Sc,
        "pulse": pulse.amplitude,
        "place": pulse.centre,
        "v": material.v,
        "D": material.D,
        "gamma": material.gamma,
        "d": scene.d,
    }
    return {
        "label": label,
        "values": {key: float(f"{value:.6g}") for key, value in (values | changes).items()},
    }


PRESETS = [
    _preset("figure 1", "figure1"),
    _preset("figure 2", "figure2"),
    _preset("between the two Sd", "figure1_between", pulse=1e-6),
]
