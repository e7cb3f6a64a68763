"""Pictures of sand on a plane: the rolling layer in colour over the hillshade of the surface."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LightSource, LogNorm
from matplotlib.figure import Figure

from bcre_studies.models.plane.run import PlaneRun
from bcre_studies.models.registry import MODELS
from bcre_studies.scenes.domain import Array

DECADES = 3
"""Of R that colours tell apart, down from its largest value."""

SHOWN = (1 / 3, 2 / 3, 1.0)
"""Parts of the time that a picture shows."""

LIGHT = LightSource(azdeg=315, altdeg=40)


def write(runs: Sequence[PlaneRun], path: Path) -> None:
    """Write :func:`picture` as PNG."""
    picture(runs).savefig(path, format="png", dpi=130, metadata={"Software": None})


def picture(runs: Sequence[PlaneRun]) -> Figure:
    """A row of three frames for each model, downhill towards the reader.

    The colour bar of R has a logarithmic scale; the one of the change of h is beside the last.
    """
    domain = runs[0].scene.domain
    tall = domain.length / domain.width
    figure = Figure(figsize=(11.5, (2.4 * min(max(tall, 0.5), 2.0) + 1.0) * len(runs)))
    figure.set_layout_engine("constrained")
    grid: Any = figure.subplots(len(runs), len(SHOWN) + 1, squeeze=False, sharex=True, sharey=True)
    for row, run in zip(grid, runs, strict=True):
        frames = [round(part * (run.t.size - 1)) for part in SHOWN]
        norm = norm_of(run)
        for axes, frame in zip(row, frames, strict=False):
            image = draw(axes, run, frame, norm)
        length = run.scene.units.length
        figure.colorbar(image, ax=list(row[:-1]), label=f"R ({length})", shrink=0.8, pad=0.01)
        changed = draw_change(row[-1], run)
        figure.colorbar(changed, ax=row[-1], label=f"change of h ({length})", shrink=0.8)
        row[0].set_ylabel(f"{MODELS[run.model].label}\nx, downhill ({length})")
    for axes in grid[-1]:
        axes.set_xlabel(f"y, across ({length})")
    figure.suptitle(runs[0].scene.title, fontsize=11)
    return figure


def norm_of(run: PlaneRun) -> LogNorm:
    """The scale of R in all frames of a run."""
    highest = float(run.R.max()) or 1.0
    return LogNorm(highest / 10**DECADES, highest)


def hillshade(run: PlaneRun, frame: int) -> Array:
    """Of the surface, on a tilted plane above the repose plane: shape (N, M), 0 to 1."""
    scene = run.scene
    surface = run.h[frame]
    if scene.automaton.flow == "tilted":
        surface = surface + np.polyval(-_tilt(run), scene.domain.centres().x)
    return shaded(surface, scene.domain.d)


def shaded(surface: Array, d: float) -> Array:
    """Hillshade of heights in cells of side d; the steepest of them counts as a slope of 1."""
    steepness = float(np.abs(np.gradient(surface, d)).max())
    exaggeration = 1 / steepness if steepness > 0 else 1.0
    return np.asarray(LIGHT.hillshade(surface, exaggeration, d, d))


def _tilt(run: PlaneRun) -> Array:
    """The plane of the surface at the start along x: slope and height."""
    x = run.scene.domain.centres().x.ravel()
    return np.polyfit(x, run.h[0].mean(axis=1), 1)


def draw(axes: Axes, run: PlaneRun, frame: int, norm: LogNorm) -> Any:
    """One frame: hillshade, R over it, walls in black."""
    extent = (0, run.scene.domain.width, run.scene.domain.length, 0)
    shade: Any = {"extent": extent, "interpolation": "nearest", "aspect": "equal"}
    axes.imshow(hillshade(run, frame), cmap="gray", vmin=-0.2, vmax=1.1, **shade)
    R = np.ma.masked_less(run.R[frame], float(norm.vmin or 0.0))
    image = axes.imshow(R, cmap=mpl.colormaps["YlOrRd"], norm=norm, alpha=0.75, **shade)
    _draw_walls(axes, run, shade)
    axes.set_title(f"t = {run.t[frame]:.4g} {run.scene.units.time}", fontsize=9)
    return image


def draw_change(axes: Axes, run: PlaneRun) -> Any:
    """h at the end less h at the start, walls in black."""
    extent = (0, run.scene.domain.width, run.scene.domain.length, 0)
    shade: Any = {"extent": extent, "interpolation": "nearest", "aspect": "equal"}
    change = run.h[-1] - run.h[0]
    largest = float(np.abs(change).max()) or 1.0
    image = axes.imshow(change, cmap="RdBu_r", vmin=-largest, vmax=largest, **shade)
    _draw_walls(axes, run, shade)
    axes.set_title(f"change by t = {run.t[-1]:.4g} {run.scene.units.time}", fontsize=9)
    return image


def _draw_walls(axes: Axes, run: PlaneRun, shade: dict[str, Any]) -> None:
    walls = run.scene.walls()
    if walls.any():
        axes.imshow(np.ma.masked_equal(walls, False), cmap="gray", vmin=1, vmax=2, **shade)
