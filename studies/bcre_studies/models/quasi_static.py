"""The quasi-static limit (``bcre_pde.line.prigozhin_zaltzman``), which has no rolling layer.

What rolls at the start is laid on the surface: at t = 0 the record shows it as laid, later as it
stands. Each recorded time is one implicit step.
"""

from __future__ import annotations

import time
from collections.abc import Sequence

import numpy as np

from bcre_pde.line import prigozhin_zaltzman
from bcre_studies.models.adapter import Adapter, Stop
from bcre_studies.models.bcre import sources_of
from bcre_studies.models.run import Run
from bcre_studies.scenes.scene import Scene


class QuasiStatic(Adapter):
    """Isotonic regression; it needs no more than :meth:`run`."""

    admits = ("source",)

    def run(
        self,
        scene: Scene,
        times: Sequence[float],
        cells: int | None = None,
        stop: Stop | None = None,
    ) -> Run:
        x, start = self.laid(scene, cells)
        Sc, length = scene.material.Sc, scene.domain.length
        u_foot = float(scene.initial(np.array([length]))[0][0]) + Sc * length
        began = time.perf_counter()
        every = [0.0, *(t for t in times if t > 0)]
        h, left = prigozhin_zaltzman.evolve(
            start, Sc, length / x.size, every, scene.domain.ends, sources_of(scene), u_foot
        )
        h, left = h[-len(times) :], left[-len(times) :]
        return Run(
            scene=scene,
            x=x,
            t=np.array(times, dtype=float),
            h=h,
            R=np.zeros_like(h),
            outflow=left,
            steps=len(times) - 1,
            evaluations=len(times) - 1,
            wall_s=time.perf_counter() - began,
        )
