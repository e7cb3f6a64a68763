"""A run on a line as an animated GIF."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from matplotlib.animation import FuncAnimation, PillowWriter
from matplotlib.figure import Figure

from bcre_studies.models.registry import MODELS
from bcre_studies.models.run import Run
from bcre_studies.on_line.frames import (
    Layer,
    axis_label,
    layers_of,
    spread,
    thinned,
    time_unit,
    title_of,
)
from bcre_studies.reporting import style

MOST = 200
"""Frames of an animation; of more, an even choice."""

SECONDS = 6.0
"""How long it plays, but no frame longer than half a second."""


def content(runs: Sequence[Run]) -> bytes:
    """A GIF of both layers in every model, the start in grey, over and over."""
    frames = spread(runs[0].t.size, MOST)
    writer = PillowWriter(fps=max(round(len(frames) / SECONDS), 2))
    with (
        TemporaryDirectory() as folder,  # matplotlib knows the format by the name of the file
        warnings.catch_warnings(action="ignore", category=UserWarning),  # of missing glyphs
    ):
        path = Path(folder) / "animation.gif"
        animation(runs, frames).save(path, writer=writer, dpi=90)
        return path.read_bytes()


def animation(runs: Sequence[Run], frames: Sequence[int]) -> FuncAnimation:
    """Both layers in these frames; the axes hold all of them."""
    style.use()
    figure = Figure(figsize=(9.6, 3.9), layout="constrained")
    panels: Any = figure.subplots(1, 2)
    lines = []
    for axes, layer in zip(panels, layers_of(runs), strict=True):
        axes.plot(*thinned(runs[0].x, layer.of(runs[0], 0)), **style.START)
        for run in runs:
            label = MODELS[run.model].label
            (line,) = axes.plot([], [], label=label, **MODELS[run.model].line)
            lines.append((line, layer, run))
        axes.set(xlim=(0, runs[0].scene.domain.length), ylim=_limits(layer, runs, frames))
        axes.set_title(layer.name, loc="left")
        axes.set_ylabel(axis_label(layer.symbol, runs[0]), parse_math=False)
        axes.set_xlabel(axis_label("x, downhill", runs[0], "x"), parse_math=False)
    title = figure.suptitle("", fontsize=10, x=0.01, ha="left", parse_math=False)
    style.legend(figure, [MODELS[run.model] for run in runs], start=True)

    def show(frame: int) -> list[Any]:
        for line, layer, run in lines:
            line.set_data(*thinned(run.x, layer.of(run, frame)))
        title.set_text(f"{title_of(runs[0])}\nt = {runs[0].t[frame]:.4g}{time_unit(runs[0])}")
        return [line for line, _, _ in lines]

    return FuncAnimation(figure, show, frames=frames, init_func=lambda: [], blit=False)


def _limits(layer: Layer, runs: Sequence[Run], frames: Sequence[int]) -> tuple[float, float]:
    """What holds the layer in all frames of all runs, with some room."""
    shown = [layer.of(run, frame) for run in runs for frame in frames]
    low, high = min(float(row.min()) for row in shown), max(float(row.max()) for row in shown)
    room = 0.05 * (high - low) or 1.0
    return low - room, high + room
