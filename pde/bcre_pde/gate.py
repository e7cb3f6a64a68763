"""What every public entry asks of its arguments before a solver or compiled code sees them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

UNDERSHOOT = 0.01
"""Part of the thickest layer by which R may lie below 0 at the start, as differences of high order
leave it ahead of a scarp that a cell cannot resolve."""


def require_not_negative(name: str, value: Any) -> None:
    """Raise ValueError where the argument is no finite number >= 0."""
    if not (is_finite(value) and value >= 0):
        raise ValueError(f"{name} = {value!r}: must be a finite number >= 0")


def require_positive(name: str, value: Any) -> None:
    """Raise ValueError where the argument is no finite number > 0."""
    if not (is_finite(value) and value > 0):
        raise ValueError(f"{name} = {value!r}: must be a finite number > 0")


def require_tolerance(tolerance: Any) -> None:
    """Raise ValueError where the local error is no number between 0 and 1."""
    if not (is_finite(tolerance) and 0 < tolerance < 1):
        raise ValueError(f"tolerance = {tolerance!r}: must lie between 0 and 1")


def require_kind(name: str, value: Any, kind: type) -> None:
    """Raise ValueError for an argument of another type."""
    if not isinstance(value, kind):
        raise ValueError(f"{name} = {value!r}: must be of the kind {kind.__name__}")


def require_callable(**functions: Any) -> None:
    """Raise ValueError for an argument that should be a function and is not."""
    for name, function in functions.items():
        if not callable(function):
            raise ValueError(f"{name} = {function!r}: must be a function")


def is_finite(value: Any) -> bool:
    """Whether it is a finite real number, and one that fits into double precision."""
    return is_number(value) and math.isfinite(value)


def is_number(value: Any) -> bool:
    """Whether it is a real number, infinite or not, that fits into double precision."""
    try:  # float first: most are, and the abstract class is slow to ask
        is_real = isinstance(value, (float, Real)) and not isinstance(value, bool)
        return is_real and not math.isnan(value)
    except OverflowError:
        return False


def whole(name: str, value: Any, least: int) -> int:
    """The whole number; ValueError where it is none, or too small."""
    if not (is_finite(value) and float(value).is_integer() and value >= least):
        raise ValueError(f"{name} = {value!r}: must be a whole number, at least {least}")
    return int(value)


def ascending(times: Iterable[Any]) -> list[float]:
    """The times as numbers, refused unless they ascend from 0 or later."""
    try:
        ordered = [float(t) for t in times]
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"times = {times!r}: must be a sequence of numbers") from None
    if not ordered or ordered[0] < 0 or not all(map(math.isfinite, ordered)):
        raise ValueError(f"times = {ordered!r}: must be finite, >= 0 and not empty")
    if any(a >= b for a, b in itertools.pairwise(ordered)):
        raise ValueError(f"times = {ordered!r}: must ascend")
    return ordered


def numbers(name: str, values: Any, shape: tuple[int, ...]) -> Array:
    """A new layer of this shape, finite or not.

    Raises
    ------
    ValueError
        naming the layer, where it is masked, ragged, of another shape or no real numbers.
    """
    if np.ma.is_masked(values):
        raise ValueError(f"{name} is masked in some cells: must have a number in every cell")
    try:
        array = np.asarray(values)
    except ValueError:
        raise ValueError(f"{name} is ragged: must have the shape {shape}") from None
    if array.dtype.kind not in "fiu":
        raise ValueError(f"{name} has the type {array.dtype}: must hold real numbers")
    if array.shape != shape:
        raise ValueError(f"{name} has the shape {array.shape}: must be {shape}")
    return np.array(array, dtype=float)


def layer(name: str, values: Any, shape: tuple[int, ...]) -> Array:
    """:func:`numbers` that are finite."""
    array = numbers(name, values, shape)
    if not np.isfinite(array).all():
        raise ValueError(f"{name} must be finite")
    return array


def initial_layers(pair: Any, shape: tuple[int, ...]) -> tuple[Array, Array]:
    """h and R as a problem's ``initial`` returns them.

    R must be >= 0, but for :data:`UNDERSHOOT`: a solve may go on from where another one ended.
    """
    try:
        h, R = pair
    except (TypeError, ValueError):
        raise ValueError("initial: must return two layers, h and R") from None
    static, rolling = layer("initial h", h, shape), layer("initial R", R, shape)
    if rolling.size and rolling.min() < -UNDERSHOOT * rolling.max(initial=0.0):
        raise ValueError(f"initial R = {float(rolling.min())!r} somewhere: must be >= 0")
    return static, rolling
