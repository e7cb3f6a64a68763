"""A plane seen with one more cell all round: what lies beyond its ends and sides."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bcre_ca.plane.setting import Plane

Array = NDArray[np.float64]

HERE = np.s_[1:-1, 1:-1]
ABOVE, BELOW = np.s_[:-2, 1:-1], np.s_[2:, 1:-1]
LEFT, RIGHT = np.s_[1:-1, :-2], np.s_[1:-1, 2:]


def around(layer: Array, plane: Plane, fall: float = 0.0, foot_drop: float = 0.0) -> Array:
    """``layer`` of shape (N, M) as (N + 2, M + 2).

    Closed ends and sides mirror the cells before them; beyond an open foot the layer goes on lower
    by ``foot_drop``; periodic ends are joined, the layer falling by ``fall`` over the period.
    """
    typed = layer.dtype.type
    if plane.ends == "periodic":
        rows = np.vstack([layer[-1:] + typed(fall), layer, layer[:1] - typed(fall)])
    else:
        beyond = typed(foot_drop) if plane.ends == "open" else typed(0)
        rows = np.vstack([layer[:1], layer, layer[-1:] - beyond])
    mode = "wrap" if plane.sides == "periodic" else "edge"
    return np.pad(rows, ((0, 0), (1, 1)), mode=mode)  # type: ignore[call-overload, no-any-return]
