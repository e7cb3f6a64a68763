"""The points of a sweep: every combination of its axes, by number.

A point is the values of the axes by their keys. Its number tells it apart from all others: the
listed and counted axes vary fastest, the last of them first, the drawn points slowest.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from bcre_studies.scenes.domain import Array
from bcre_studies.sweeps.spec import MOST_POINTS, Axis, Spec, SpecError, Value

Point = dict[str, Value]


class Points:
    """All points of a sweep; ``points[i]`` makes number i."""

    def __init__(self, spec: Spec) -> None:
        self._listed = [(axis, _values(axis)) for axis in spec.axis if not axis.drawn]
        self._drawn = [axis for axis in spec.axis if axis.drawn]
        self._keys = [axis.key for axis in spec.axis]
        self._combinations = math.prod(len(values) for _, values in self._listed)
        draws = spec.sample.count if spec.sample else 1
        if self._combinations * draws > MOST_POINTS:
            raise SpecError(
                f"axis: the axes make {self._combinations * draws} points; must be at most "
                f"{MOST_POINTS}"
            )
        self._draws = _drawn(spec)

    def __len__(self) -> int:
        return self._combinations * len(self._draws)

    def __getitem__(self, number: int) -> Point:
        if not 0 <= number < len(self):
            raise IndexError(number)
        draw, rest = divmod(number, self._combinations)
        point: Point = {
            axis.key: _scaled(axis, float(part))
            for axis, part in zip(self._drawn, self._draws[draw], strict=True)
        }
        for axis, values in reversed(self._listed):
            rest, place = divmod(rest, len(values))
            point[axis.key] = values[place]
        return {key: point[key] for key in self._keys}


def spread(count: int) -> Iterator[int]:
    """The numbers below ``count``, each once, in an order whose every start is spread over all.

    Steps of the golden section of the count (of the next number without a common divisor), so that
    the points measured so far tell the cost of those that are left.
    """
    stride = max(round(count * (math.sqrt(5) - 1) / 2), 1)
    while math.gcd(stride, count) > 1:
        stride += 1
    return (index * stride % count for index in range(count))


def _values(axis: Axis) -> tuple[Value, ...]:
    if axis.values is not None:
        return axis.values
    return tuple(_scaled(axis, float(part)) for part in np.linspace(0, 1, axis.count or 2))


def _drawn(spec: Spec) -> Array:
    """Drawn points of the unit cube, shape (draws, drawn axes)."""
    dimensions = sum(axis.drawn for axis in spec.axis)
    if spec.sample is None:
        return np.zeros((1, 0))
    from scipy.stats import qmc  # late: slow to import

    chance = np.random.default_rng(spec.sample.seed)
    engine = qmc.Sobol if spec.sample.method == "sobol" else qmc.LatinHypercube
    return np.asarray(engine(dimensions, rng=chance).random(spec.sample.count))


def _scaled(axis: Axis, part: float) -> Value:
    """The value at a part of the range, 0 <= part <= 1; its ends exactly."""
    assert axis.start is not None
    assert axis.end is not None
    if part in (0.0, 1.0):
        value = axis.end if part else axis.start
    elif axis.scale == "log":
        value = axis.start * (axis.end / axis.start) ** part
    else:
        value = axis.start + (axis.end - axis.start) * part
    return round(value) if axis.whole else float(value)
