"""Hadeler and Kuttler's model (``bcre_pde.line.hadeler_kuttler``).

A scene's v is the speed at repose: beta = v/Sc. It has no diffusion and no curvature term.
"""

from __future__ import annotations

from dataclasses import replace

import bcre_pde
from bcre_pde.line.hadeler_kuttler import HadelerKuttler as Equation
from bcre_pde.line.hadeler_kuttler import SlopeDriven
from bcre_studies.models.bcre import Bcre, problem_of
from bcre_studies.scenes.scene import Scene, SceneError


class HadelerKuttler(Bcre):
    """The speed of the layer goes with the slope; ``D`` of the scene is left out."""

    admits = ("source",)
    equation = Equation

    def problem(self, scene: Scene) -> bcre_pde.Problem:
        m = scene.material
        return replace(problem_of(scene), material=SlopeDriven(beta_of(scene), m.gamma, m.Sc))

    def note(self, scene: Scene) -> str:
        m = scene.material
        left = [f"{name} = {getattr(m, name)!r}" for name in ("D", "kappa") if getattr(m, name)]
        return f"Hadeler-Kuttler runs without {' and '.join(left)}" if left else ""


def beta_of(scene: Scene) -> float:
    """v/Sc, the speed per unit of slope at which the layer moves at v on a slope at repose."""
    m = scene.material
    if m.Sc == 0:
        raise SceneError(f"material.Sc = {m.Sc!r}: must be > 0, beta = v/Sc")
    return m.v / m.Sc
