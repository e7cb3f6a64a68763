"""A run on a line as a figure: both layers at the recorded times, and what the models differ by."""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from bcre_studies.models.registry import MODELS
from bcre_studies.models.run import Run
from bcre_studies.on_line.frames import (
    ROLLING,
    SURFACE,
    Layer,
    axis_label,
    layers_of,
    spread,
    thinned,
    time_unit,
    title_of,
)
from bcre_studies.reporting import style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST = 11
"""Times that are drawn; of more frames an even choice."""

PALEST = 0.3
"""Share of its model's colour that the earliest line keeps."""

ERRORS = {"u": "error_estimate_h", "R": "error_estimate"}


def content(runs: Sequence[Run]) -> bytes:
    """:func:`picture` as SVG, whose bytes depend on the runs alone."""
    with warnings.catch_warnings(action="ignore", category=UserWarning):  # of missing glyphs
        return style.svg_of(picture(runs)).encode()


def picture(runs: Sequence[Run]) -> Figure:
    """Static and rolling layer of one run or two; of two, their difference below."""
    from matplotlib.figure import Figure

    style.use()
    compared = len(runs) == 2
    heights = (2, 1.1) if compared else (1,)
    figure = Figure(figsize=(9.6, 3.4 * sum(heights) / heights[0] + 0.9), layout="constrained")
    axes: Any = figure.subplots(len(heights), 2, squeeze=False, sharex=True, height_ratios=heights)
    frames = spread(runs[0].t.size, MOST)
    for column, layer in zip(axes.T, layers_of(runs), strict=True):
        _draw_layer(column[0], layer, runs, frames)
        if compared:
            _draw_difference(column[1], layer, runs, frames)
        column[-1].set_xlabel(axis_label("$x$, downhill", runs[0], "x"))
    _explain(figure, runs, frames)
    return figure


def _draw_layer(axes: Axes, layer: Layer, runs: Sequence[Run], frames: list[int]) -> None:
    axes.plot(*thinned(runs[0].x, layer.of(runs[0], 0)), **style.START)
    for run in runs:
        for frame in frames[1:]:
            look = MODELS[run.model].line | {"color": _shade(run.model, frame, frames)}
            axes.plot(*thinned(run.x, layer.of(run, frame)), **look)
    axes.set_title(layer.name, loc="left")
    axes.set_ylabel(axis_label(layer.symbol, runs[0]))
    axes.margins(x=0)
    if layer is ROLLING and not any(run.R.any() for run in runs):
        axes.text(0.5, 0.6, "none in this run", transform=axes.transAxes, ha="center", color="0.4")


def _draw_difference(axes: Axes, layer: Layer, runs: Sequence[Run], frames: list[int]) -> None:
    one, other = runs
    axes.axhline(0.0, color="0.6", linewidth=0.8)
    for frame in frames[1:]:
        gap = layer.difference(one, other, frame)
        axes.plot(*thinned(one.x, gap), color=_shade(one.model, frame, frames), linewidth=1.1)
    error = own_error(other, layer)
    if math.isfinite(error):
        axes.axhspan(-error, error, color=MODELS[other.model].color, alpha=0.18, linewidth=0)
    axes.set_title(f"{MODELS[one.model].label} less {MODELS[other.model].label}", loc="left")
    axes.set_ylabel(axis_label("difference", runs[0]))


def own_error(run: Run, layer: Layer) -> float:
    """Mean error of the layer by the run's own estimate, a length; infinite where unknown."""
    error = run.facts.get(ERRORS[layer.field])
    return math.inf if error is None else error * (float(np.abs(run.R).mean()) or 1.0)


def _shade(model: str, frame: int, frames: list[int]) -> Any:
    """The model's colour, the paler the earlier."""
    from matplotlib.colors import to_rgb

    share = PALEST + (1 - PALEST) * frame / frames[-1]
    return tuple(share * part + 1 - share for part in to_rgb(MODELS[model].color))


def _explain(figure: Figure, runs: Sequence[Run], frames: list[int]) -> None:
    """Title, legend, and the times that are drawn."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    t = runs[0].t
    times = ", ".join(f"{t[frame]:.4g}" for frame in frames[1:])
    text = f"{title_of(runs[0])}\nt = {times}{time_unit(runs[0])}: the later, the darker"
    figure.suptitle(text, fontsize=9, x=0.01, ha="left", parse_math=False)
    handles: list[Any] = [Line2D([], [], label=f"t = {t[0]:g}", **style.START)]
    for run in runs:
        label = f"{MODELS[run.model].label}, {run.x.size} cells"
        handles.append(Line2D([], [], label=label, **MODELS[run.model].line))
    if len(runs) == 2 and any(
        math.isfinite(own_error(runs[1], layer)) for layer in (SURFACE, ROLLING)
    ):
        label = f"mean error of {MODELS[runs[1].model].label}"
        handles.append(Patch(color=MODELS[runs[1].model].color, alpha=0.18, label=label))
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles), handlelength=3.2)
