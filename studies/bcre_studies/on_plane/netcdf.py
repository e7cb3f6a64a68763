"""Frames as one compressed NetCDF-4 file that xarray, QGIS, ParaView and Panoply read."""

from __future__ import annotations

from collections.abc import Sequence
from io import BytesIO

import numpy as np
import xarray as xr

from bcre_studies.models.plane.run import PlaneRun
from bcre_studies.models.registry import AUTOMATON

LAYERS = {"h": "static layer", "R": "rolling layer"}
ENCODING = {"zlib": True, "complevel": 4, "shuffle": True}


def content(runs: Sequence[PlaneRun]) -> bytes:
    """:func:`dataset` as a file."""
    frames, file = dataset(runs), BytesIO()
    encoding = {name: ENCODING for name in frames.data_vars if frames[name].ndim == 3}
    frames.to_netcdf(file, engine="h5netcdf", encoding=encoding)
    return file.getvalue()


def dataset(runs: Sequence[PlaneRun]) -> xr.Dataset:
    """The frames of one scene, dimensions (t, y, x).

    ``h`` and ``R`` are the automaton's, ``h_pde`` and ``R_pde`` those of BCRE; ``wall`` (y, x) is
    1 where no sand can be.
    """
    scene = runs[0].scene
    at, units = scene.domain.centres(), scene.units
    frames = xr.Dataset(
        coords={
            "t": ("t", runs[0].t, {"long_name": "time", "units": units.time}),
            "y": ("y", at.y.ravel(), {"long_name": "across", "units": units.length}),
            "x": ("x", at.x.ravel(), {"long_name": "downhill", "units": units.length}),
        },
        attrs={
            "title": scene.title,
            "source": "bcre run",
            "Conventions": "CF-1.11",
        },
    )
    for run in runs:
        suffix, whose = ("", "automaton") if run.model == AUTOMATON.name else ("_pde", "BCRE")
        for name, layer in LAYERS.items():
            values = np.swapaxes(getattr(run, name), 1, 2)
            about = {"long_name": f"{layer}, {whose}", "units": units.length}
            frames[name + suffix] = (("t", "y", "x"), values, about)
    frames["wall"] = (
        ("y", "x"),
        scene.walls().T.astype(np.int8),
        {"long_name": "wall, 1 where no sand can be"},
    )
    return frames
