"""Which frames of a run are drawn, and the two layers as figures show them."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bcre_studies.models.run import Run
from bcre_studies.scenes.domain import Array
from bcre_studies.system.one_line import one_line

POINTS = 2000
"""A line is drawn by at most so many points, more than a figure can show."""


@dataclass(frozen=True)
class Layer:
    """A layer as a figure shows it.

    Parameters
    ----------
    field: of :meth:`bcre_studies.models.run.Run.sample`.
    name: in the title of its panel; symbol: on its axis.
    since_start: whether what it has changed by is shown.
    """

    field: str
    name: str
    symbol: str
    since_start: bool = False

    def of(self, run: Run, frame: int) -> Array:
        """The layer in one frame at the run's own cells."""
        if self.field == "R":
            return np.asarray(run.R[frame])
        if self.since_start:
            return np.asarray(run.h[frame] - run.h[0])
        repose = run.scene.material.Sc * (run.scene.domain.length - run.x)
        return np.asarray(run.h[frame] - repose)

    def difference(self, one: Run, other: Run, frame: int) -> Array:
        """``one`` less ``other`` in one frame, at the cells of ``one``."""
        return one.sample(one.x, self.field, frame) - other.sample(one.x, self.field, frame)


SURFACE = Layer("u", "static layer above the repose line", "h - Sc (L - x)")
CHANGE = Layer("u", "change of the static layer", "h - h(t = 0)", since_start=True)
ROLLING = Layer("R", "rolling layer", "R")

VISIBLE = 0.02
"""A change of the surface by this part of its range can be seen in a picture of the surface."""


def layers_of(runs: Sequence[Run]) -> tuple[Layer, Layer]:
    """Static and rolling layer; of a surface that hardly changes, its change."""
    surface = SURFACE.of(runs[0], 0)
    changed = max(float(np.abs(CHANGE.of(run, -1)).max()) for run in runs)
    return (SURFACE if changed > VISIBLE * float(np.ptp(surface)) else CHANGE), ROLLING


def spread(count: int, most: int) -> list[int]:
    """At most ``most`` of ``count`` frames, evenly spread, the first and the last among them."""
    return [int(i) for i in np.linspace(0, count - 1, min(count, most)).round()]


def thinned(x: Array, values: Array) -> tuple[Array, Array]:
    """At most :data:`POINTS` points of a line: of each group of cells the least and the largest."""
    groups = POINTS // 2
    if x.size <= POINTS:
        return x, values
    starts = np.linspace(0, x.size, groups + 1).astype(int)[:-1]
    low, high = np.minimum.reduceat(values, starts), np.maximum.reduceat(values, starts)
    return np.repeat(x[starts], 2), np.stack([low, high], axis=1).ravel()


def title_of(run: Run) -> str:
    """The scene's title as one line that fits above a figure."""
    return textwrap.shorten(one_line(run.scene.title), 110, placeholder=" ...")


def time_unit(run: Run) -> str:
    """A blank and the unit of time, where the scene names one."""
    return f" {run.units['t']}" if run.scene.units else ""


def axis_label(symbol: str, run: Run, quantity: str = "h") -> str:
    """The symbol with its unit, where the scene names one; a plain text without mathematics."""
    if run.scene.units is None:
        return symbol
    return f"{symbol} ({run.units[quantity]})"
