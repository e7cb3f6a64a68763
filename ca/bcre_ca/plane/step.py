"""One step of the automaton on a plane: the flow's own step, then what is poured."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from bcre_ca.plane import facets, split4, tilted
from bcre_ca.plane.layers import base_of, checked
from bcre_ca.plane.setting import Plane
from bcre_ca.plane.sources import cells_of, clock_of, poured

Array = NDArray[np.float64]

STEPS: dict[str, Any] = {
    "tilted": tilted.step,
    "split4": split4.step,
    "facet8": facets.step,
    "d8": facets.step,
}


def step(h: Array, R: Array, plane: Plane, t: float = 0.0) -> tuple[Array, Array, float]:
    """One step of ``plane.rule.dt`` from the time t; no judgement of its stability.

    Parameters
    ----------
    h, R: static and rolling layer, lengths, shape (N, M), both in double or in single precision.
    plane: what they lie on.
    t: time, which decides what the sources pour.

    Returns
    -------
    h, R: the new layers.
    outflow: what left through the foot, in units of R (times d^2: a volume).
    """
    h, R = checked(h, R, plane)
    free = plane.free(h.shape)
    K = plane.coefficients(h.dtype)
    typed_free, base = free.astype(h.dtype), base_of(plane, h.shape, h.dtype)
    h, R, outflow = STEPS[plane.flow](h, R, typed_free, base, plane, K)
    cells = cells_of(plane.sources, free, plane.rule.d, plane.sides == "periodic")
    heights = poured(plane.sources, cells, clock_of(t, plane.rule.dt, 1))[0].astype(h.dtype)
    row = np.repeat(np.arange(len(h)), np.diff(cells.first))
    np.add.at(R, (row, cells.column), heights[cells.source])
    return h, R, outflow
