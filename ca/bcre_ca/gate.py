"""What every public entry asks of its arguments before compiled code sees them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from numbers import Real
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

Array = NDArray[np.float64]

DENORMAL = 1e-300
"""Below this the sign of a layer is decided by rounding among denormal numbers."""


def numbers_of(name: str, values: Any) -> NDArray[Any]:
    """The values as an array of real numbers, not copied where they are one.

    Raises
    ------
    ValueError
        naming the argument, where they are none: ragged, masked, complex, text or anything else.
    """
    if np.ma.is_masked(values):
        hidden = int(np.ma.getmaskarray(values).sum())
        raise ValueError(f"{name} is masked in {hidden} cells: must have a number in every cell")
    try:
        array = np.asarray(values)
    except ValueError:
        raise ValueError(f"{name} is ragged: must have as many cells in every row") from None
    if array.dtype.kind not in "fiu":
        raise ValueError(f"{name} has the type {array.dtype}: must hold real numbers")
    return array


def layers_of(h: Any, R: Any, rank: int, shape: str) -> tuple[Array, Array]:
    """New contiguous layers of one shape and rank; single precision where both are, else double.

    Raises
    ------
    ValueError
        naming the layer, what it is and what is allowed.
    """
    both = {name: numbers_of(name, layer) for name, layer in (("h", h), ("R", R))}
    single = all(layer.dtype == np.float32 for layer in both.values())
    dtype: DTypeLike = np.float32 if single else np.float64
    for name, layer in both.items():
        if layer.ndim != rank or not layer.size:
            raise ValueError(f"{name} has shape {layer.shape}: must be {shape}")
    if both["h"].shape != both["R"].shape:
        raise ValueError(f"R has shape {both['R'].shape}: must be that of h, {both['h'].shape}")
    static, rolling = (np.array(layer, dtype, order="C") for layer in both.values())
    return static, rolling


def require_start(h: Array, R: Array) -> None:
    """Raise ValueError, naming the cell, where layers are not finite or R is negative."""
    require_finite(h, R)
    require("R", R, R >= -DENORMAL, "must be >= 0")


def require_finite(h: Array, R: Array) -> None:
    """Raise ValueError, naming the cell, where layers are not finite."""
    require("h", h, np.isfinite(h), "must be finite")
    require("R", R, np.isfinite(R), "must be finite")


def require(name: str, layer: Array, holds: NDArray[np.bool_], what: str) -> None:
    """Raise ValueError for the first cell where something does not hold."""
    if not holds.all():
        at = np.unravel_index(int(np.argmin(holds)), layer.shape)
        cell = f"({', '.join(map(str, at))})" if len(at) > 1 else str(at[0])
        raise ValueError(f"{name} = {float(layer[at])!r} in cell {cell}: {what}")


def require_kind(name: str, value: Any, kind: type) -> None:
    """Raise ValueError for an argument of another type."""
    if not isinstance(value, kind):
        raise ValueError(f"{name} = {value!r}: must be of the kind {kind.__name__}")


def require_all_of_kind(name: str, values: Any, kind: type) -> None:
    """Raise ValueError where the argument is no sequence of that type."""
    if not isinstance(values, Sequence) or not all(isinstance(one, kind) for one in values):
        raise ValueError(f"{name} = {values!r}: must be a sequence of the kind {kind.__name__}")


def is_finite(value: Any) -> bool:
    """Whether it is a finite real number, and one that fits into double precision."""
    return is_number(value) and math.isfinite(value)


def is_number(value: Any) -> bool:
    """Whether it is a real number, infinite or not, that fits into double precision."""
    if isinstance(value, float):  # most are, and the abstract class is slow to ask
        return value == value
    if isinstance(value, bool):
        return False
    try:
        return isinstance(value, Real) and not math.isnan(value)
    except OverflowError:
        return False


def require_not_negative(name: str, value: Any) -> None:
    """Raise ValueError where the argument is no finite number >= 0."""
    if not (is_finite(value) and value >= 0):
        raise ValueError(f"{name} = {value!r}: must be a finite number >= 0")


def require_positive(name: str, value: Any) -> None:
    """Raise ValueError where the argument is no finite number > 0."""
    if not (is_finite(value) and value > 0):
        raise ValueError(f"{name} = {value!r}: must be a finite number > 0")


def whole(name: str, number: Any, least: int = 0) -> int:
    """The whole number; ValueError where it is none, or too small."""
    if not (is_finite(number) and float(number).is_integer() and number >= least):
        raise ValueError(f"{name} = {number!r}: must be a whole number >= {least}")
    return int(number)


def ascending(times: Iterable[Any], start: Any) -> list[float]:
    """The times as numbers, none before the one before it, the first not before ``start``."""
    try:
        wanted = [float(time) for time in times]
    except (TypeError, ValueError, OverflowError):
        raise ValueError(f"times = {times!r}: must be a sequence of numbers") from None
    if not is_finite(start):
        raise ValueError(f"t = {start!r}: must be a finite number")
    start = float(start)
    for before, time in zip([start, *wanted], wanted, strict=False):
        if not before <= time < math.inf:
            raise ValueError(f"times = {wanted!r}: must ascend from t = {start!r}")
    return wanted
