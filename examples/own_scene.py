"""A scene of one's own: a surveyed transect, sixty uneven rows of x and h, in both models.

The scene is ``own_scene.toml``, the survey ``own_scene.csv``. Run it with
``.venv/bin/python examples/own_scene.py``. The command ``bcre run examples/own_scene.toml`` runs it
too, and refines BCRE until its error is small.
"""

from pathlib import Path

import numpy as np
import xarray as xr

from bcre_studies.models.registry import AUTOMATON, BCRE
from bcre_studies.scenes.scene import load

scene = load(Path(__file__).with_name("own_scene.toml"))
times = np.linspace(0, scene.time.until, 7)

cells = scene.domain.cells
runs = {
    "ca": AUTOMATON.run(scene, times).to_xarray(),
    "pde": BCRE.run(scene, times, 2 * cells).to_xarray(),
}
for name, run in runs.items():
    eroded = (run.h - run.h[0]).min("x")
    print(name)
    table = xr.Dataset({"deepest erosion, m": -eroded, "R at most, m": run.R.max("x")})
    print(table.to_dataframe().round(3), end="\n\n")

on_cells = runs["pde"].interp(x=runs["ca"].x)
change = (runs["ca"].h - runs["ca"].h[0]).isel(t=-1)
gap = np.abs(runs["ca"].h - on_cells.h).isel(t=-1).mean() / np.abs(change).mean()
print(f"the final surfaces differ by {float(gap):.0%} of what the slide changed")
