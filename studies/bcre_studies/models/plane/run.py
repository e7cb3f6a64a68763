"""The record of a run on a plane, the same for both models."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.plane.scene import PlaneScene


@dataclass(frozen=True, eq=False)
class PlaneRun:
    """Layers in the scene's cells at the times ``t`` (T,): ``h`` and ``R``, shape (T, N, M).

    Parameters
    ----------
    model: ``"ca"`` or ``"pde"``.
    inflow, outflow: volumes that were poured and that have left through the foot, shape (T,).
    wall_s: seconds it took, compilation excluded.
    facts: what only this model can say of its run, as the summary shows it.
    """

    model: str
    scene: PlaneScene
    t: Array
    h: Array
    R: Array
    inflow: Array
    outflow: Array
    steps: int
    wall_s: float
    facts: dict[str, Any] = field(default_factory=dict)

    def mass(self) -> Array:
        """Volume of sand at every time, walls left out."""
        free = ~self.scene.walls()
        area = self.scene.domain.d**2
        frames = zip(self.h, self.R, strict=True)
        return np.array([area * (math.fsum(h[free]) + math.fsum(R[free])) for h, R in frames])

    def mass_error(self) -> float:
        """|mass + outflow - inflow - initial mass| at the end, over all sand there ever was.

        That is the volume of |h| + R at the start, and what was poured.
        """
        mass, free = self.mass(), ~self.scene.walls()
        start = float(np.abs(self.h[0][free]).sum() + self.R[0][free].sum())
        scale = self.scene.domain.d**2 * start + float(self.inflow[-1])
        balance = abs(mass[-1] + self.outflow[-1] - self.inflow[-1] - mass[0])
        return float(balance / scale) if scale > 0 else float(balance)

    def summary(self) -> dict[str, Any]:
        """What happened, in numbers."""
        mass = self.mass()
        return {
            "cells": list(self.scene.domain.shape),
            "steps": self.steps,
            "wall_s": self.wall_s,
            "mass_initial": float(mass[0]),
            "mass_final": float(mass[-1]),
            "inflow": float(self.inflow[-1]),
            "outflow": float(self.outflow[-1]),
            "mass_error": self.mass_error(),
            "R_min": float(self.R.min()),
            "R_max": float(self.R.max()),
            **self.facts,
        }
