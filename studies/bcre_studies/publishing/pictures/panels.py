"""Panels of a size of their own, in the look of all figures."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bcre_studies.reporting import style


def panels(rows: int, columns: int, *, width: float, height: float) -> tuple[Figure, list[Axes]]:
    """A figure of so many panels, each ``width`` by ``height`` inches, and its axes row by row."""
    style.use()
    figure = Figure(figsize=(width * columns, height * rows), layout="constrained")
    axes = np.atleast_1d(figure.subplots(rows, columns))
    return figure, list(axes.ravel())
