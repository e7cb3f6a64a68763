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
    import xarray as xr

LONG_NAMES = {
    "t": "time",
    "x": "distance downhill, at cell centres",
    "h": "static layer",
    "R": "rolling layer",
    "outflow": "area that has left through the foot",
}


@dataclass(frozen=True, eq=False)
class Run:
    """Layers at the cell centres ``x`` (N,) and times ``t`` (T,): ``h`` and ``R``, shape (T, N).

    Parameters
    ----------
    R: zero everywhere in a model without a rolling layer.
    outflow: area that has left through the foot, shape (T,).
    evaluations: how often the model's rule or right-hand side was evaluated on the whole grid.
    wall_s: seconds it took, compiling excluded.
    compile_s: seconds that compiling took, or reading what is compiled already; where it is known.
    facts: what only this model can say of its run, as the summary shows it.
    coarser: the run on coarser grids, coarsest first, where the model was refined.
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
    compile_s: float = 0.0
    facts: dict[str, Any] = field(default_factory=dict)
    coarser: tuple[Run, ...] = ()
    model: str = ""

    @property
    def d(self) -> float:
        """Cell length of this run's own grid."""
        return self.scene.domain.length / self.x.size

    @property
    def u(self) -> Array:
        """Height above the repose line, h + Sc x."""
        return self.h + self.scene.material.Sc * self.x

    @property
    def units(self) -> dict[str, str]:
        """Unit of each quantity; a scene that names none has one of length and one of time."""
        named = self.scene.units
        length, time = (named.length, named.time) if named else ("length", "time")
        return {"t": time, "x": length, "h": length, "R": length, "outflow": f"{length}^2"}

    def mass(self) -> Array:
        """Area of sand in the domain at every time."""
        rows = zip(self.h, self.R, strict=True)
        return np.array([self.d * (math.fsum(h) + math.fsum(R)) for h, R in rows])

    def inflow(self) -> Array:
        """Area that sources have poured since the first frame, at every time."""
        return np.array([self.scene.poured(t) for t in self.t]) - self.scene.poured(self.t[0])

    def mass_error(self) -> float:
        """|mass + outflow - inflow - initial mass| at the end, relative.

        To the area of |h| + R at the start and of the inflow.
        """
        mass, poured = self.mass(), float(self.inflow()[-1])
        scale = self.d * float(np.sum(np.abs(self.h[0]) + self.R[0])) + poured
        balance = abs(mass[-1] + self.outflow[-1] - poured - mass[0])
        return float(balance / scale) if scale > 0 else float(balance)

    def sample(self, x: Array, field: str = "R", frame: int = -1) -> Array:
        """``R`` or ``u`` of one frame at positions x, by a quintic spline between the cells."""
        values = getattr(self, field)[frame]
        if values.size == x.size and np.allclose(self.x, x, rtol=0, atol=1e-9 * self.d):
            return np.asarray(values)
        period = self.scene.domain.length if self.scene.domain.ends == "periodic" else None
        return between(self.x, values, x, period)

    def to_dataframe(self, **labels: str) -> pd.DataFrame:
        """One row for each time and place, with the columns model, t, x, h and R.

        ``attrs["units"]`` holds the unit of each.

        Parameters
        ----------
        labels: columns of one value each, put before the others.

        >>> from bcre_studies.models.registry import AUTOMATON
        >>> from bcre_studies.scenes.scene import load
        >>> table = AUTOMATON.run(load("figure3"), times=[0, 10]).to_dataframe()
        >>> table.columns.tolist(), len(table), table.attrs["units"]["R"]
        (['model', 't', 'x', 'h', 'R'], 200, 'length')
        """
        import pandas as pd

        frames, cells = self.h.shape
        columns = {
            "t": np.repeat(self.t, cells),
            "x": np.tile(self.x, frames),
            "h": self.h.ravel(),
            "R": self.R.ravel(),
        }
        table = pd.DataFrame({**labels, "model": self.model, **columns})
        table.attrs["units"] = {name: self.units[name] for name in columns}
        return table

    def to_xarray(self) -> xr.Dataset:
        """h and R over t and x, and the outflow over t, each with a long name and a unit.

        The attributes hold the scene's title and coefficients, and what the run took. Everything
        in it can be written with ``to_netcdf(path, engine="scipy")``.

        >>> from bcre_studies.models.registry import AUTOMATON
        >>> from bcre_studies.scenes.scene import load
        >>> data = AUTOMATON.run(load("figure3"), times=[0, 10]).to_xarray()
        >>> dict(data.sizes), data.R.attrs["units"], data.attrs["v"]
        ({'t': 2, 'x': 100}, 'length', 2.5)
        """
        import xarray as xr

        layers = {"h": (("t", "x"), self.h), "R": (("t", "x"), self.R)}
        known = self.scene.material.model_dump() | {"d": self.d} | self.facts
        took = {"steps": self.steps, "evaluations": self.evaluations, "wall_s": self.wall_s}
        data = xr.Dataset(
            layers | {"outflow": ("t", self.outflow)},
            coords={"t": self.t, "x": self.x},
            attrs={"title": self.scene.title, "model": self.model}
            | {name: value for name, value in known.items() if value is not None}
            | took,
        )
        for name, unit in self.units.items():
            data[name].attrs = {"long_name": LONG_NAMES[name], "units": unit}
        return data


def between(x: Array, values: Array, places: Array, period: float | None) -> Array:
    """Values at cell centres x, as a quintic spline has them at other places."""
    from scipy.interpolate import make_interp_spline

    if period is not None:
        wrap = 4
        x = np.concatenate([x[-wrap:] - period, x, x[:wrap] + period])
        values = np.concatenate([values[-wrap:], values, values[:wrap]])
    return np.asarray(make_interp_spline(x, values, k=5)(places))


def frame_times(scene: Scene, frames: int) -> list[float]:
    """``frames`` equally spaced times from 0 to the end of the scene."""
    return [float(t) for t in np.linspace(0.0, scene.time.until, frames)]
