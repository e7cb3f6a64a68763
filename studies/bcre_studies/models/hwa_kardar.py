"""Hwa and Kardar's surface (``bcre_pde.line.hwa_kardar``), without noise.

A scene's D is nu and its v is lambda. What rolls at the start is laid on the surface. The level at
rest is that of the foot, and the mean one where ends are joined.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import bcre_pde
from bcre_pde.line.hwa_kardar import HwaKardar as Equation
from bcre_pde.line.hwa_kardar import Surface
from bcre_studies.models.bcre import Bcre, problem_of
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.scene import Scene


class HwaKardar(Bcre):
    """One variable, the height."""

    admits = ("source",)
    equation = Equation

    def problem(self, scene: Scene) -> bcre_pde.Problem:
        def initial(x: Array) -> tuple[Array, Array]:
            h, R = scene.initial(x)
            return h + R, np.zeros_like(R)

        m = scene.material
        surface = Surface(m.D, m.v, m.Sc, level_of(scene))
        return replace(problem_of(scene), initial=initial, material=surface)


def level_of(scene: Scene) -> float:
    """h + Sc x of the surface at rest."""
    if scene.domain.ends == "periodic":
        x = scene.centres()
        return float(np.mean(np.sum(scene.initial(x), axis=0) + scene.material.Sc * x))
    foot = np.array([scene.domain.length])
    return float(scene.initial(foot)[0][0] + scene.material.Sc * scene.domain.length)
