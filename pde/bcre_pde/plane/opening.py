r"""The opening angle of an avalanche, measured on a solution.

N(x, y) is all of R that ever passed a place. Far from where it started N falls along a ray as

    ln N + (1/2) ln r = a(phi) r + b(phi) + c(phi)/r + e(phi)/r^2 + ...

and the edge of the wedge is the ray on which a = 0. On each ray these four terms are fitted to N at
seven distances from r to 4 r; the ray with a = 0 then tends to the edge as 1/r^4. The error is what
the last of them or a further one moves it by. An edge drawn where R passes some
threshold is off by 5 to 10 degrees at any size that one can afford.
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

DISTANCES = np.linspace(1, 4, 7)
"""Where N is read on a ray, in units of the nearest."""

RAYS = 60
"""Rays on which the sign of a is looked at, from the axis to the widest one on the plane."""


class OpeningAngle(NamedTuple):
    """Half-angle in degrees; ``error`` is what one term more or less moves it by."""

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
    """Measured on the side y > source[1], from N at distances from r to 4 r.

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
    surface = RectBivariateSpline(x, y, np.log(np.maximum(N, np.finfo(float).tiny)), kx=5, ky=5)
    distances = r * DISTANCES
    widest = math.degrees(math.asin(min(1.0, (y[-1] - source[1]) / distances[-1])))

    def edge(terms: int) -> float:
        basis = DISTANCES[:, None] ** (1 - np.arange(terms))
        weights = np.linalg.pinv(basis)[0] / r

        def growth(degrees: float) -> float:
            along, across = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
            logs = surface.ev(source[0] + distances * along, source[1] + distances * across)
            return float(weights @ (logs + np.log(distances) / 2))

        rays = np.linspace(0.0, widest, RAYS)
        signs = np.array([growth(degrees) > 0 for degrees in rays])
        last = np.flatnonzero(signs[:-1] & ~signs[1:])
        if not last.size:
            raise ValueError(f"r = {r!r}: no edge of N lies on the plane there")
        return float(brentq(growth, rays[last[-1]], rays[last[-1] + 1], xtol=1e-9))

    less, theta, more = (edge(terms) for terms in (3, 4, 5))
    return OpeningAngle(theta, max(abs(theta - less), abs(theta - more)))
