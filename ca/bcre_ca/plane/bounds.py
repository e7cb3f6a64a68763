"""What a refused step is told: which bound it passes, and in which cell (i, j)."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bcre_ca.plane import facets, split4, theory, tilted
from bcre_ca.plane.setting import Plane
from bcre_ca.rule import ROUNDING
from bcre_ca.unstable import UnstableStep

Array = NDArray[np.float64]

EXCESS: dict[str, Any] = {
    "tilted": tilted.excess,
    "split4": split4.excess,
    "facet8": facets.excess,
    "d8": facets.excess,
}


def excess_of(h: Array, plane: Plane) -> Array:
    """By how much the surface of each cell drops beyond repose, (S - Sc) d; 0 at a wall."""
    free = plane.free(h.shape).astype(h.dtype)
    found: Array = EXCESS[plane.flow](h, free, plane, plane.coefficients(h.dtype)) * free
    return found


def largest_step_of(plane: Plane, largest_R: float, missing_drop: float) -> float:
    """The largest stable step for these extremes; NaN where they are not finite."""
    if not (math.isfinite(largest_R) and math.isfinite(missing_drop)):
        return math.nan
    return theory.max_stable_step(plane, largest_R, missing_drop / plane.rule.d)


def refusal(
    dt: float, largest: float, h: Array, R: Array, read: NDArray[np.bool_], plane: Plane
) -> UnstableStep:
    """Of a step dt above the largest stable one, found in the cells ``read``."""
    finite = np.isfinite(h) & np.isfinite(R)
    if not finite.all():
        return UnstableStep(dt, 0.0, f"the layers are not finite in cell {_cell(~finite)}")
    w = "2 " if plane.flow == "split4" else ""
    highest = float(R.max())
    if (
        theory.max_stable_step(plane, highest)
        <= largest * (1 + ROUNDING)
        < (theory.max_stable_step(plane))
    ):
        return UnstableStep(
            dt,
            largest,
            f"{w}gamma R dt/d must not exceed 1 where R = {highest:.6g} in cell {_cell(R)}",
        )
    beyond = np.where(read, excess_of(h, plane), np.inf)
    slope = float(beyond.min()) / plane.rule.d + plane.rule.exchange_slope()
    place = f" where S = {slope:.6g} in cell {_cell(-beyond)}" if read.any() else ""
    return UnstableStep(
        dt,
        largest,
        f"{w}v dt/d + 2 (D + D_across) dt/d^2 + gamma dt max(Sc - S, 0) must not exceed 1{place}",
    )


def _cell(layer: Any) -> str:
    i, j = np.unravel_index(int(np.argmax(layer)), layer.shape)
    return f"({i}, {j})"
