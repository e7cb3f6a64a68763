"""Sand that is poured onto a line: at a rate, over a stretch of it, between two times."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bcre_ca.gate import is_finite, is_number, require_not_negative, require_positive

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Source:
    """A stretch of the line over which sand is poured evenly into R.

    Parameters
    ----------
    rate: area poured per unit of time, length^2/time, >= 0.
    place: the middle of the stretch; cell i reaches from i d to (i + 1) d.
    width: its length, > 0.
    start, until: when it begins and ends, 0 <= start <= until; until may be infinite.
    """

    rate: float
    place: float
    width: float
    start: float = 0.0
    until: float = math.inf

    def __post_init__(self) -> None:
        for name in ("rate", "start"):
            require_not_negative(f"source {name}", getattr(self, name))
        require_positive("source width", self.width)
        if not is_finite(self.place):
            raise ValueError(f"source place = {self.place!r}: must be a finite number")
        if not (is_number(self.until) and self.start <= self.until):
            raise ValueError(
                f"source until = {self.until!r}: must be at least start = {self.start!r}"
            )


def supply_of(sources: Sequence[Source], t: float, cells: int, d: float) -> Array | None:
    """What each cell gets at time t, length/time, shape (N,); None where there are no sources.

    Raises
    ------
    ValueError
        for a source of which a part lies beyond the line.
    """
    if not sources:
        return None
    faces, supply = np.arange(cells + 1) * d, np.zeros(cells)
    for source in sources:
        low, high = source.place - source.width / 2, source.place + source.width / 2
        near = 1e-9 * d
        if not (low >= -near and high <= faces[-1] + near):
            raise ValueError(
                f"source place = {source.place!r}, width = {source.width!r}: must lie on "
                f"0 <= x <= {float(faces[-1])!r}"
            )
        if source.start <= t < source.until:
            covered = np.diff(np.clip(faces, max(low, 0.0), min(high, faces[-1])))
            supply += source.rate / d * (covered / covered.sum())
    return supply


def stretches(sources: Sequence[Source], t: float, last: float) -> Iterator[tuple[float, float]]:
    """The stretches of time from t to ``last`` in which no source begins or ends."""
    ends = (end for source in sources for end in (source.start, source.until))
    return itertools.pairwise([t, *sorted({end for end in ends if t < end < last}), last])
