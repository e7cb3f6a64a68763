"""BCRE with the automaton's own diffusion and curvature counted in.

The automaton is a first-order scheme. To that order it solves BCRE with more diffusion and more
curvature than the scene names (``bcre_ca.theory``):

    D_eff = D + (v d/2)(1 - v dt/d)        kappa_eff = (gamma d/2)(1 - gamma R0 dt/d)

dt is the step that the run takes. The one exception is the second critical slope: see
:func:`effective_at_critical_slope`.
"""

from __future__ import annotations

from dataclasses import replace

import bcre_pde
from bcre_studies.models.automaton import rule_of
from bcre_studies.scenes.scene import Scene


def effective(scene: Scene, with_curvature: bool = True) -> Scene:
    """The scene with D_eff for D and, unless left out, kappa_eff for kappa.

    R0 is the layer that lies everywhere at the start. A scene whose step is "auto" has the dt of
    its first step here, which the run keeps until a thick layer shortens it. A study that compares
    with the result gives its scene a fixed step.
    """
    rule = rule_of(scene)
    R0 = float(scene.initial(scene.centres())[1].min())
    added = rule.effective_curvature(R0) - rule.kappa if with_curvature else 0.0
    return scene.with_changes(D=rule.effective_diffusion(), kappa=scene.material.kappa + added)


def effective_at_critical_slope(material: bcre_pde.Material, d: float) -> bcre_pde.Material:
    """The exception: at Sd the automaton diffuses with D + v d/2, whatever its step.

    The part -v^2 dt/2 of D_eff stands for the term (dt/2) R_tt of the Euler step, with
    R_tt = v^2 R_xx for a layer that is carried and does not grow. At Sd nothing changes in time at
    the fixed place, so R_tt = 0.
    """
    return replace(material, D=material.D + material.v * d / 2)
