"""The record of a run on a plane, the same for both models."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.plane.scene import PlaneScene

if TYPE_CHECKING:
    import xarray as xr

LAYERS = {"h": "static layer", "R": "rolling layer"}
VOLUMES = {
    "inflow": "volume poured by the sources",
    "outflow": "volume that has left through the foot",
}


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

    def to_xarray(self) -> xr.Dataset:
        """h and R over (t, y, x), inflow and outflow over t, each with a long name and a unit.

        ``wall`` (y, x) is 1 where no sand can be. The attributes hold the scene's title and
        coefficients.

        >>> from bcre_studies.models.plane import automaton
        >>> from bcre_studies.scenes.plane.scene import load
        >>> scene = load("obstacle", ["until=0.1"])
        >>> data = automaton.run(scene, [0.0, 0.1]).to_xarray()
        >>> data.R.dims, data.R.attrs["units"], data.attrs["v"] == scene.material.v
        (('t', 'y', 'x'), 'm', True)
        """
        import xarray as xr

        at, units = self.scene.domain.centres(), self.scene.units
        t = {"long_name": "time", "units": units.time}
        places = {"y": ("across", at.y), "x": ("downhill", at.x)}
        data = xr.Dataset(
            coords={"t": ("t", self.t, t)}
            | {
                axis: (axis, values.ravel(), {"long_name": name, "units": units.length})
                for axis, (name, values) in places.items()
            },
            attrs={"title": self.scene.title, "model": self.model}
            | {
                name: value
                for name, value in self.scene.material.model_dump().items()
                if value is not None
            },
        )
        for layer, name in LAYERS.items():
            values = np.swapaxes(getattr(self, layer), 1, 2)
            about = {"long_name": name, "units": units.length}
            data[layer] = (("t", "y", "x"), values, about)
        for name, what in VOLUMES.items():
            about = {"long_name": what, "units": f"{units.length}^3"}
            data[name] = ("t", getattr(self, name), about)
        data["wall"] = (
            ("y", "x"),
            self.scene.walls().T.astype(np.int8),
            {"long_name": "wall, 1 where no sand can be"},
        )
        return data

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
