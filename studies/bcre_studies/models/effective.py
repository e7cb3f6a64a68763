"""BCRE with the automaton's own diffusion and curvature counted in.

The automaton is a first-order scheme: to that order it solves BCRE with more diffusion and more
curvature than a scene asks for, D_eff and kappa_eff (``bcre_ca.theory``).
"""

from __future__ import annotations

from bcre_studies.models.automaton import rule_of
from bcre_studies.scenes.scene import Scene


def effective(scene: Scene, with_curvature: bool = True) -> Scene:
    """The scene with D_eff for D and, unless left out, kappa_eff for kappa.

    kappa_eff is that under the layer which lies everywhere at the start.
    """
    rule = rule_of(scene)
    R0 = float(scene.initial(scene.centres())[1].min())
    added = rule.effective_curvature(R0) - rule.kappa if with_curvature else 0.0
    return scene.with_changes(D=rule.effective_diffusion(), kappa=scene.material.kappa + added)
