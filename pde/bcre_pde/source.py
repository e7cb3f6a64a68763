"""Sand that is poured onto a line; needs neither py-pde nor compiled code."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bcre_pde.gate import is_finite, is_number, require_kind, require_not_negative, require_positive

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Source:
    """w(x, t) = rate/width over a stretch of the line and of time: it falls into R.

    Parameters
    ----------
    rate: area poured per unit of time, >= 0.
    place: the middle of the stretch.
    width: its length, > 0; all of it must lie on the line.
    start, until: when it begins and ends, 0 <= start <= until; until may be infinite.

    Raises
    ------
    ValueError
        naming the parameter, its value and what is allowed.
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
        if not (is_number(self.until) and self.until >= self.start):
            raise ValueError(f"source until = {self.until!r}: must be at least {self.start!r}")

    def poured(self, t: float) -> float:
        """Area that has been poured by the time t."""
        return self.rate * max(min(t, self.until) - self.start, 0.0)

    def over(self, edges: Array) -> Array:
        """w averaged over the cells between the ascending ``edges`` (N + 1,), length/time, (N,)."""
        inside = np.clip(edges, self.place - self.width / 2, self.place + self.width / 2)
        return np.asarray(self.rate / self.width * np.diff(inside) / np.diff(edges))


def require_on_line(sources: Iterable[Source], length: float) -> None:
    """Raise ValueError for a source of which a part lies beyond 0 <= x <= length."""
    if not isinstance(sources, Iterable):
        raise ValueError(f"sources = {sources!r}: must be a sequence of sources")
    for source in sources:
        require_kind("source", source, Source)
        if not (source.width / 2 <= source.place <= length - source.width / 2):
            raise ValueError(
                f"source place = {source.place!r}, width = {source.width!r}: must lie on "
                f"0 <= x <= {length!r}"
            )
