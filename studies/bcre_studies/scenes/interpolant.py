r"""A function through the rows of a table: smooth where they are, and nowhere beyond them.

Between two rows the cubic spline is kept where it stays between their values. It is also kept at a
smooth extremum: the second difference has one sign at the four rows around, and the spline rises
above both values by no more than twice what a parabola of that curvature would, f'' g^2/8 over rows
g apart. Elsewhere both slopes become those of the monotone interpolant (PCHIP; Fritsch and Butland
1984), so that a step of a table stays a step. Smooth tables keep the spline's fourth order.

Heights are interpolated as u = h + Sc x, which is even where h is at repose; neither may leave its
rows. A cubic is monotone where its slopes at both ends lie between 0 and three times the secant s
(Fritsch and Carlson 1980). Slopes are taken into that range of u and that of h, in which s always
lies, on each side of a row for itself.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bcre_studies.scenes.domain import Array

if TYPE_CHECKING:
    from scipy.interpolate import PPoly

ROUNDING = 1e-9
"""Part of the range of the values by which the spline may leave it."""

AROUND = 3
"""Rows repeated beyond joined ends, so that each has its neighbours."""


def through(x: Array, values: Array, reach: tuple[float, float], tilt: float = 0.0) -> PPoly:
    """The function through rows with open ends.

    It is continued to ``reach`` by the spline where that goes on like the rows, else in a straight
    line.

    Parameters
    ----------
    x, values: the rows, x ascending, shape (N,), N >= 4.
    reach: first and last position that will be asked for.
    tilt: values - tilt x stays between its rows too.
    """
    from scipy.interpolate import CubicSpline  # a third of a second that most scenes do not need

    spline = CubicSpline(x, values)
    left, right, limited = _limited(x, values, np.asarray(spline(x, 1)), tilt)
    function = _hermite(x, values, left, right) if limited.any() else spline
    for side, end in zip((0, -1), reach, strict=True):
        function = _continued(function, x, values, side, end, straight=bool(limited[side]))
    return function


def through_period(x: Array, values: Array, period: float, tilt: float = 0.0) -> PPoly:
    """The function through rows that repeat; those given span less than the period.

    ``tilt`` is that of :func:`through`.
    """
    from scipy.interpolate import CubicSpline

    around, closed = np.append(x, x[0] + period), np.append(values, values[0])
    spline = CubicSpline(around, closed, bc_type="periodic", extrapolate="periodic")
    count = min(AROUND, x.size)
    wide = np.concatenate([x[-count:] - period, x, x[:count] + period])
    repeated = np.concatenate([values[-count:], values, values[:count]])
    left, right, limited = _limited(wide, repeated, np.asarray(spline(wide, 1)), tilt)
    own = slice(count, count + x.size)
    if not limited[own].any():
        return spline
    function = _hermite(around, closed, left[own], right[own])
    function.extrapolate = "periodic"
    return function


def _hermite(x: Array, values: Array, left: Array, right: Array) -> PPoly:
    """The cubics with these slopes at the left and the right end of every interval."""
    from scipy.interpolate import PPoly

    gap = np.diff(x)
    secant = np.diff(values) / gap
    bend = (left + right - 2 * secant) / gap
    return PPoly(np.array([bend / gap, (secant - left) / gap - bend, left, values[:-1]]), x)


def _limited(
    x: Array, values: Array, slopes: Array, tilt: float
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Slopes at both ends of the intervals, and which are those of the monotone interpolant.

    A slope that changes may let the interval beside leave its range, so that it is asked again.
    """
    # Bends, and with them what a smooth extremum may rise, are those of the tilted values too.
    allowed = _smooth_rise(x, values) + ROUNDING * float(np.ptp(values))
    limited = np.zeros(x.size - 1, dtype=bool)
    left, right = slopes[:-1], slopes[1:]
    while True:
        rises = [
            _rise_beyond_rows(x, values - taken * x, left - taken, right - taken)
            for taken in {0.0, tilt}
        ]
        beyond = ~limited & (np.max(rises, axis=0) > allowed)
        if not beyond.any():
            return left, right, limited
        limited |= beyond
        at = np.append(limited, False) | np.append(False, limited)
        slopes = np.where(at, _monotone_slopes(x, values), slopes)
        low, high = _monotone_range(np.diff(values) / np.diff(x), tilt)
        left, right = (
            np.where(limited, np.clip(side, low, high), side) for side in (slopes[:-1], slopes[1:])
        )


def _monotone_range(secant: Array, tilt: float) -> tuple[Array, Array]:
    """Least and largest slope at the ends with which values and tilted values are monotone."""
    tilted = secant - tilt
    low = np.maximum(np.minimum(0.0, 3 * secant), tilt + np.minimum(0.0, 3 * tilted))
    high = np.minimum(np.maximum(0.0, 3 * secant), tilt + np.maximum(0.0, 3 * tilted))
    return low, high


def _monotone_slopes(x: Array, values: Array) -> Array:
    from scipy.interpolate import PchipInterpolator

    with np.errstate(all="ignore"):  # the harmonic mean of slopes that may be very small
        return np.asarray(PchipInterpolator(x, values).derivative()(x))


def _rise_beyond_rows(x: Array, values: Array, left: Array, right: Array) -> Array:
    """How far the cubic of every interval rises above, or falls below, both its rows."""
    gap, change = np.diff(x), np.diff(values)
    left, right = left * gap, right * gap
    cubic, square = left + right - 2 * change, 3 * change - 2 * left - right
    # Where c/q and q/(3 a) are the roots of 3 a s^2 + 2 b s + c = 0, s = 0 .. 1.
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        q = -(square + np.copysign(np.sqrt(square**2 - 3 * cubic * left), square))
        turns = np.array([left / q, q / (3 * cubic)])
    turns = np.where((turns > 0) & (turns < 1), turns, 0.0)  # not a number: no turn at all
    reached = ((cubic * turns + square) * turns + left) * turns
    above = reached.max(axis=0) - np.maximum(change, 0.0)
    below = np.minimum(change, 0.0) - reached.min(axis=0)
    return np.asarray(np.maximum(above, below))


def _smooth_rise(x: Array, values: Array) -> Array:
    """How far a smooth extremum may rise above both rows of every interval."""
    bend = np.pad(_bends(x, values), 2)  # of a row that is not there nothing is known
    four = np.array([bend[:-3], bend[1:-2], bend[2:-1], bend[3:]])
    one_sign = (four > 0).all(axis=0) | (four < 0).all(axis=0)
    inner = np.minimum(np.abs(four[1]), np.abs(four[2]))
    return np.asarray(np.where(one_sign, inner * np.diff(x) ** 2 / 2, 0.0))


def _bends(x: Array, values: Array) -> Array:
    """f''/2 by divided differences, at all rows but the first and the last."""
    return np.asarray(np.diff(np.diff(values) / np.diff(x)) / (x[2:] - x[:-2]))


def _continued(
    function: PPoly, x: Array, values: Array, side: int, end: float, *, straight: bool
) -> PPoly:
    """The function up to a position beyond its first (side 0) or last (side -1) row."""
    last, before = (0, 1) if side == 0 else (-1, -2)
    length, gap = abs(end - x[last]), abs(x[before] - x[last])
    if (end >= x[0]) if side == 0 else (end <= x[-1]):
        return function
    slope = (values[last] - values[before]) / (x[last] - x[before])
    on = values[last] + slope * (end - x[last])
    bends = _bends(x, values)
    near = bends[:2] if side == 0 else bends[-2:]
    smooth = float(np.abs(near).min()) if (near > 0).all() or (near < 0).all() else 0.0
    allowed = abs(slope) * length + 2 * smooth * length * (length + gap)
    if not straight and abs(float(function(end)) - on) <= allowed + ROUNDING * np.ptp(values):
        return function
    slope = float(function(x[last], 1))
    start = values[last] + slope * (end - x[last]) if side == 0 else values[last]
    function = _copy(function)
    function.extend(np.array([[0.0], [0.0], [slope], [start]]), np.array([end]))
    return function


def _copy(function: PPoly) -> PPoly:
    from scipy.interpolate import PPoly

    return PPoly(function.c.copy(), function.x.copy())
