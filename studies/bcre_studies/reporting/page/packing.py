"""Recorded layers as text: quantised so that every machine writes the same bytes.

A frame of N cells becomes N numbers of 16 bits, least byte first, that count :data:`LEVELS` steps
between a low and a high value; all frames of a field then stand one after the other in base64.
A picture is a few hundred points high, so that a step of 1/4095 is not seen in it.
"""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

LEVELS = 4095
"""Steps between low and high: fine to the eye, coarse against any difference of rounding."""

DIGITS = 4
"""Significant digits of the ends of the range."""


def pack(frames: ArrayLike, *, each: bool = False) -> dict[str, Any]:
    """Frames (T, N) as ``{"low": [...], "high": [...], "data": base64}``.

    Parameters
    ----------
    each: whether every frame has a range of its own, for layers that grow by orders of magnitude;
        else all frames share one.
    """
    values = np.asarray(frames, dtype=float)
    axis = 1 if each else None
    low = _rounded(np.min(values, axis=axis), down=True)
    high = _rounded(np.max(values, axis=axis), down=False)
    span = np.where(high > low, high - low, 1.0)
    place = (values - _column(low)) / _column(span) * LEVELS
    levels = np.clip(np.rint(place), 0, LEVELS).astype("<u2")
    return {
        "low": np.atleast_1d(low).tolist(),
        "high": np.atleast_1d(high).tolist(),
        "data": base64.b64encode(levels.tobytes()).decode("ascii"),
    }


def unpack(packed: dict[str, Any], cells: int) -> NDArray[np.float64]:
    """What the page's script shows, (T, N): the layers to half a step of their range."""
    raw = np.frombuffer(base64.b64decode(packed["data"]), dtype="<u2").reshape(-1, cells)
    low, high = (np.array(packed[key])[:, None] for key in ("low", "high"))
    return np.asarray(low + raw / LEVELS * (high - low))


def _column(value: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.atleast_1d(value)[:, None]


def _rounded(value: ArrayLike, *, down: bool) -> NDArray[np.float64]:
    """To four digits, outwards, so that every value lies within the range."""
    found = np.asarray(value, dtype=float)
    size = np.abs(found)
    exponent = np.floor(np.log10(np.where(size > 0, size, 1.0)))
    unit = 10.0 ** (exponent - DIGITS + 1)
    # A hair towards the inside: a value that is a round number but for rounding stays that number.
    hair = 1e-9 * unit
    steps = np.floor((found + hair) / unit) if down else np.ceil((found - hair) / unit)
    return np.array(
        [
            float(f"{step * size:.{DIGITS}g}")
            for step, size in zip(np.atleast_1d(steps), np.atleast_1d(unit), strict=True)
        ]
    ).reshape(found.shape)
