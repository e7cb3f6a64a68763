"""Frames as one compressed NetCDF-4 file that xarray, QGIS, ParaView and Panoply read."""

from __future__ import annotations

from collections.abc import Sequence
from io import BytesIO

import xarray as xr

from bcre_studies.models.plane.run import LAYERS, PlaneRun
from bcre_studies.models.registry import AUTOMATON

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
    first = runs[0].to_xarray()
    frames = first[["t", "y", "x"]]
    frames.attrs = {
        "title": first.attrs["title"],
        "source": "bcre run",
        "Conventions": "CF-1.11",
    }
    for run in runs:
        suffix, whose = ("", "automaton") if run.model == AUTOMATON.name else ("_pde", "BCRE")
        layers = run.to_xarray()
        for name in LAYERS:
            frames[name + suffix] = layers[name]
            frames[name + suffix].attrs["long_name"] += f", {whose}"
    frames["wall"] = first["wall"]
    return frames
