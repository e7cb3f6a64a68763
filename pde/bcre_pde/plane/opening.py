r"""The opening angle of an avalanche, measured on a solution.

N(x, y) is all of R that ever passed a place. Far from where it started N falls along a ray as

    ln N = a(phi) r - (1/2) ln r + b(phi) + c(phi)/r + ...

and the edge of the wedge is the ray on which a = 0. So ln N + (1/2) ln r is the same at r and 2 r
on a ray that tends to the edge as 1/r^2; the rays from r, 2 r and from 2 r, 4 r together, (4 second
- first)/3, tend to it faster. An edge drawn where R passes some threshold is off by 5 to 10 degrees
at any size that one can afford.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from scipy.interpolate import RectBivariateSpline
from scipy.optimize import brentq

from bcre_pde.plane.problem import Frame
from bcre_pde.problem import Array


class OpeningAngle(NamedTuple):
    """Half-angle in degrees; ``error`` is what the extrapolation moved it by."""

    theta: float
    error: float


def passed_in_all(frames: Iterable[Frame]) -> Array:
    """N, shape (Nx, Ny), from frames at equal intervals from t = 0 to when all has passed.

    The sum is the trapezium rule. Where what passes rises from nothing and falls to nothing its
    error is less than any power of the interval, which may be a tenth of the time of passing.
    """
    times: list[float] = []
    total: Array | float = 0.0
    for frame in frames:
        total = total + (frame.R if times else frame.R / 2)
        times.append(frame.t)
    intervals = np.diff(times)
    if intervals.size == 0 or np.ptp(intervals) > 1e-9 * intervals[0]:
        raise ValueError("frames: must be at least two, at equal intervals")
    return np.asarray(total * intervals[0])


def opening_angle(
    N: Array, x: Array, y: Array, source: tuple[float, float], r: float
) -> OpeningAngle:
    """Measured on the side y > source[1], from N at the distances r, 2 r and 4 r.

    Parameters
    ----------
    N: all that passed, > 0 where it is looked at, shape (Nx, Ny).
    x, y: cell centres.
    source: where it started, a place.
    r: many times D_x/v and the size of the source; 4 r must lie on the plane.

    Raises
    ------
    ValueError
        where no ray on the plane has the property of an edge.
    """
    surface = RectBivariateSpline(x, y, np.log(np.maximum(N, np.finfo(float).tiny)))

    def edge(distance: float) -> float:
        def gain(degrees: float) -> float:
            across, along = math.sin(math.radians(degrees)), math.cos(math.radians(degrees))
            near, far = (
                float(surface(source[0] + d * along, source[1] + d * across)[0, 0])
                for d in (distance, 2 * distance)
            )
            return far - near + math.log(2) / 2

        widest = math.degrees(math.asin(min(1.0, (y[-1] - source[1]) / (2 * distance))))
        if not gain(0.0) > 0 > gain(widest):
            raise ValueError(f"r = {r!r}: no edge of N lies on the plane there")
        return float(brentq(gain, 0.0, widest, xtol=1e-9))

    first, second = edge(r), edge(2 * r)
    theta = (4 * second - first) / 3
    return OpeningAngle(theta, abs(theta - second))
