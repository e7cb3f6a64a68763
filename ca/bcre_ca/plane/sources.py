"""Sand that is poured: at a rate, over a disc, between two times."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bcre_ca.gate import is_finite, is_number, require_not_negative, require_positive

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Source:
    """A disc over which sand is poured evenly into R.

    Parameters
    ----------
    rate: volume poured, length^3/time, >= 0.
    place: (x, y) of its centre; cell (i, j) has its own at ((i + 1/2) d, (j + 1/2) d).
    width: its diameter, a length > 0. A source of one cell makes R grow past every bound: let it
        be some cells wide.
    times: (start, stop), start <= stop; stop may be infinite.
    """

    rate: float
    place: tuple[float, float]
    width: float
    times: tuple[float, float] = (0.0, math.inf)

    def __post_init__(self) -> None:
        require_not_negative("rate", self.rate)
        if not (_are_two(self.place) and all(is_finite(value) for value in self.place)):
            raise ValueError(f"place = {self.place!r}: must be two finite numbers, x and y")
        require_positive("width", self.width)
        if not (_are_two(self.times) and is_finite(self.times[0]) and _in_order(self.times)):
            raise ValueError(f"times = {self.times!r}: must be a start and a stop not before it")


def _are_two(values: object) -> bool:
    return isinstance(values, (tuple, list)) and len(values) == 2


def _in_order(times: tuple[float, float]) -> bool:
    return is_number(times[1]) and times[0] <= times[1]


class Cells(NamedTuple):
    """The cells of some sources row by row: those of row i stand from ``first[i]`` to
    ``first[i + 1]``, in the columns ``column``, each of the source ``source``.

    ``height`` is what a unit of time adds to a cell of each source, length/time.
    """

    first: NDArray[np.int64]
    column: NDArray[np.int64]
    source: NDArray[np.int64]
    height: Array


def cells_of(
    sources: tuple[Source, ...], free: NDArray[np.bool_], d: float, periodic_across: bool
) -> Cells:
    """Where sand falls: cells that can hold it and whose centres lie in a disc.

    Raises
    ------
    ValueError
        for a source with no such cell.
    """
    rows, columns = free.shape
    x, y = (np.arange(rows) + 0.5) * d, (np.arange(columns) + 0.5) * d
    found, height = [], []
    for number, source in enumerate(sources):
        away = np.abs(y - source.place[1])
        if periodic_across:
            away %= columns * d
            away = np.minimum(away, columns * d - away)
        near = np.hypot((x - source.place[0])[:, None], away) <= source.width / 2
        cells = np.argwhere(near & free)
        if not cells.size:
            raise ValueError(
                f"sources[{number}]: no cell that can hold sand has its centre within "
                f"{source.width / 2!r} of {tuple(source.place)!r}"
            )
        found.append(np.column_stack([cells, np.full(len(cells), number)]))
        height.append(source.rate / (len(cells) * d * d))
    row, column, source_of = np.concatenate([np.empty((0, 3), np.int64), *found]).T
    order = np.lexsort((column, source_of, row))
    first = np.searchsorted(row[order], np.arange(rows + 1))
    return Cells(
        first.astype(np.int64),
        np.ascontiguousarray(column[order]),
        np.ascontiguousarray(source_of[order]),
        np.array(height, float),
    )


def poured(sources: tuple[Source, ...], cells: Cells, clock: Array) -> Array:
    """Height that each step adds to a cell of each source, shape (steps, sources).

    ``clock`` holds the times between the steps, one more than there are steps.
    """
    start, stop = np.array([source.times for source in sources]).reshape(-1, 2).T
    overlap = np.minimum(clock[1:, None], stop) - np.maximum(clock[:-1, None], start)
    heights: Array = np.maximum(overlap, 0.0) * cells.height
    return heights


def clock_of(t: float, dt: float, steps: int) -> Array:
    """Times between the steps. Each is the last one plus dt, as if they were taken one by one."""
    clock = np.full(steps + 1, float(dt))
    clock[0] = t
    return np.add.accumulate(clock)
