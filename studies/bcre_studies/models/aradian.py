"""Thick flows after Aradian, Raphaël and de Gennes (``bcre_pde.line.aradian``).

A scene that names no Gamma or v_up gets the natural ones: Gamma = gamma, v_up = v.
"""

from __future__ import annotations

import math

from bcre_pde.line.aradian import thick
from bcre_studies.models.bcre import problem_of
from bcre_studies.scenes.scene import Scene


def thick_flow(scene: Scene) -> Scene:
    """The scene with the Gamma and v_up of a thick flow."""
    material = thick(problem_of(scene).material)
    v_up = None if math.isinf(material.v_up) else material.v_up
    return scene.with_changes(Gamma=material.Gamma, v_up=v_up)
