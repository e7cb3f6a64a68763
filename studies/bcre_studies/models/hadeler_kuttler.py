"""Hadeler and Kuttler's model (``bcre_pde.line.hadeler_kuttler``) and its automaton.

A scene's v is the speed at repose: beta = v/Sc. It has no diffusion and no curvature term.
"""

from __future__ import annotations

from dataclasses import replace

import bcre_ca
import bcre_pde
from bcre_pde.line.hadeler_kuttler import HadelerKuttler as Equation
from bcre_pde.line.hadeler_kuttler import SlopeDriven
from bcre_studies.models.automaton import Automaton, stepped
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
        return _left_out(scene)


class SlopeDrivenAutomaton(Automaton):
    """The automaton whose layer is driven by the slope; as its model it leaves ``D`` out."""

    admits = ("source",)

    def rule(self, scene: Scene) -> bcre_ca.Rule:
        m = scene.material
        if m.v == 0:
            raise SceneError(f"material.v = {m.v!r}: must be > 0 in this automaton, beta = v/Sc")
        rule = bcre_ca.Rule(
            v=0.0, D=0.0, gamma=m.gamma, Sc=m.Sc, d=scene.d, dt=1.0, beta=beta_of(scene)
        )
        return stepped(rule, scene)

    def note(self, scene: Scene) -> str:
        return _left_out(scene)


def _left_out(scene: Scene) -> str:
    m = scene.material
    left = [f"{name} = {getattr(m, name)!r}" for name in ("D", "kappa") if getattr(m, name)]
    return f"Hadeler-Kuttler runs without {' and '.join(left)}" if left else ""


def beta_of(scene: Scene) -> float:
    """v/Sc, the speed per unit of slope at which the layer moves at v on a slope at repose."""
    m = scene.material
    if m.Sc == 0:
        raise SceneError(f"material.Sc = {m.Sc!r}: must be > 0, beta = v/Sc")
    return m.v / m.Sc
