"""The record of a run, the same for every model."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.scene import Scene

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, eq=False)
class Run:
    """Layers at the cell centres ``x`` (N,) and times ``t`` (T,): ``h`` and ``R``, shape (T, N).

    Parameters
    ----------
    R: zero everywhere in a model without a rolling layer.
    outflow: area that has left through the foot, shape (T,).
    evaluations: how often the model's rule or right-hand side was evaluated on the whole grid.
    wall_s: seconds it took, compilation excluded.
    facts: what only this model can say of its run, as the summary shows it.
    model: the model's name in the registry, which fills it in.
    """

    scene: Scene
    x: Array
    t: Array
    h: Array
    R: Array
    outflow: Array
    steps: int
    evaluations: int
    wall_s: float = 0.0
    facts: dict[str, Any] = field(default_factory=dict)
    model: str = ""

    @property
    def d(self) -> float:
        """Cell length of this run's own grid."""
        return self.scene.domain.length / self.x.size

    @property
    def u(self) -> Array:
        """Height above the repose line, h + Sc x."""
        return self.h + self.scene.material.Sc * self.x

    def mass(self) -> Array:
        """Area of sand in the domain at every time."""
        rows = zip(self.h, self.R, strict=True)
        return np.array([self.d * (math.fsum(h) + math.fsum(R)) for h, R in rows])

    def mass_error(self) -> float:
        """|mass + outflow - initial mass| at the end, over the area of |h| + R at the start."""
        mass = self.mass()
        scale = self.d * float(np.sum(np.abs(self.h[0]) + self.R[0]))
        balance = abs(mass[-1] + self.outflow[-1] - mass[0])
        return float(balance / scale) if scale > 0 else float(balance)

    def sample(self, x: Array, field: str = "R", frame: int = -1) -> Array:
        """``R`` or ``u`` of one frame at positions x, by a quintic spline between the cells."""
        values = getattr(self, field)[frame]
        if values.size == x.size and np.allclose(self.x, x, rtol=0, atol=1e-9 * self.d):
            return np.asarray(values)
        from scipy.interpolate import make_interp_spline

        positions = self.x
        if self.scene.domain.ends == "periodic":
            length, wrap = self.scene.domain.length, 4
            positions = np.concatenate(
                [positions[-wrap:] - length, positions, positions[:wrap] + length]
            )
            values = np.concatenate([values[-wrap:], values, values[:wrap]])
        return np.asarray(make_interp_spline(positions, values, k=5)(x))


def frame_times(scene: Scene, frames: int) -> list[float]:
    """``frames`` equally spaced times from 0 to the end of the scene."""
    return [float(t) for t in np.linspace(0.0, scene.time.until, frames)]


def profiles(run: Run, **labels: str) -> pd.DataFrame:
    """The layers as rows of x, h and R at every time, with constant label columns before them."""
    import pandas as pd

    frames, cells = run.h.shape
    columns = {
        "t": np.repeat(run.t, cells),
        "x": np.tile(run.x, frames),
        "h": run.h.ravel(),
        "R": run.R.ravel(),
    }
    return pd.DataFrame({**labels, **columns})
