"""A run as an animated GIF."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from matplotlib.animation import FuncAnimation, PillowWriter
from matplotlib.figure import Figure

from bcre_studies.models.plane.run import PlaneRun
from bcre_studies.models.registry import MODELS
from bcre_studies.on_plane.picture import draw, norm_of

SECONDS = 5.0
"""How long it plays, but no frame longer than half a second."""


def content(runs: Sequence[PlaneRun]) -> bytes:
    """A GIF of every frame of the runs, side by side, over and over."""
    domain = runs[0].scene.domain
    tall = min(max(domain.length / domain.width, 0.5), 1.6)
    figure = Figure(figsize=(4.2 * len(runs), 3.2 * tall + 0.7), layout="constrained")
    axes: Any = figure.subplots(1, len(runs), squeeze=False, sharey=True)[0]
    norms = [norm_of(run) for run in runs]
    length = runs[0].scene.units.length

    def show(frame: int) -> list[Any]:
        images = []
        for place, run, norm in zip(axes, runs, norms, strict=True):
            place.clear()
            images.append(draw(place, run, frame, norm))
            place.set_title(f"{MODELS[run.model].label}, {place.get_title()}", fontsize=9)
            place.set_xlabel(f"y, across ({length})")
        axes[0].set_ylabel(f"x, downhill ({length})")
        return images

    figure.colorbar(show(0)[0], ax=list(axes), label=f"R ({length})", shrink=0.8)
    count = runs[0].t.size
    writer = PillowWriter(fps=max(round(count / SECONDS), 2))
    with TemporaryDirectory() as folder:  # matplotlib knows the format by the name of the file
        path = Path(folder) / "animation.gif"
        FuncAnimation(figure, show, frames=count, blit=False).save(path, writer=writer, dpi=80)
        return path.read_bytes()
