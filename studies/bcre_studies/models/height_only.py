"""The automaton of the height alone (``bcre_ca.height_only``), which has no rolling layer.

What rolls at the start is laid on the surface, which settles at once: at t = 0 the record shows it
as laid, at every later time as settled. Its steps are no steps of time.
"""

from __future__ import annotations

import time
from collections.abc import Sequence

import numpy as np

from bcre_ca.height_only import settled
from bcre_studies.models.adapter import Adapter, Stop
from bcre_studies.models.run import Run
from bcre_studies.scenes.scene import Scene


class HeightOnly(Adapter):
    """The one-variable control; it needs no more than :meth:`run`.

    Parameters
    ----------
    start: slope at which it begins to move; left out, Sc, at which it stops.
    """

    ends = ("open", "periodic")
    admits = ()

    def __init__(self, start: float = 0.0) -> None:
        self._start = start

    def run(
        self,
        scene: Scene,
        times: Sequence[float],
        cells: int | None = None,
        stop: Stop | None = None,
    ) -> Run:
        x, start = self.laid(scene, cells)
        d = scene.domain.length / x.size
        began = time.perf_counter()
        end, shed, steps = settled(
            start, scene.material.Sc * d, scene.domain.ends == "periodic", self._start * d
        )
        t = np.array(times)
        return Run(
            scene=scene,
            x=x,
            t=t,
            h=np.where(t[:, None] > 0, end, start),
            R=np.zeros((t.size, x.size)),
            outflow=np.where(t > 0, d * shed, 0.0),
            steps=steps,
            evaluations=steps,
            wall_s=time.perf_counter() - began,
        )
