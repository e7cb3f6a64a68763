r"""Exact solutions of the full, nonlinear equations.

With D = kappa = 0 the system is u_t = gamma R u_x, R_t + v R_x = -gamma R u_x: the first equation
carries u uphill at gamma R, and from both together

    w = R + u + (v/gamma) ln R        obeys        w_t + v w_x = 0,

since w_t + v w_x = (R_t + v R_x) + u_t + v u_x + (v/(gamma R)) (R_t + v R_x)
= -gamma R u_x + gamma R u_x + v u_x - v u_x = 0. Where w is the same everywhere it stays so, u is a
function of R, and R_t = gamma R R_x follows: a wave that climbs and steepens.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import elementwise

Array = NDArray[np.float64]


def climbing_wave_surface(x: Array, R: Array, v: float, gamma: float, Sc: float) -> Array:
    """h = -Sc x - R - (v/gamma) ln R, the surface under a climbing wave R > 0 (w = 0)."""
    return -Sc * x - R - v / gamma * np.log(R)


def climbing_wave(
    x: Array,
    t: float,
    R0: Callable[[Array], Array],
    gamma: float,
    reach: float,
) -> Array:
    """R(x, t) = R0(x + gamma R t), solved for R at every x; D = kappa = 0.

    Parameters
    ----------
    x: positions, shape (N,).
    t: a time before the wave breaks at t* = 1/(gamma max R0').
    R0: the initial rolling layer as a function of position, > 0, on all positions reached.
    reach: an upper bound of R0, a length.
    """
    if t == 0:
        return R0(x)

    def excess(R: Array, place: Array) -> Array:
        return R - R0(place + gamma * R * t)

    found = elementwise.find_root(
        excess,
        (np.zeros_like(x), np.full_like(x, reach * (1 + 1e-9))),
        args=(x,),
        tolerances={"xatol": 0.0, "xrtol": 4e-16},
    )
    return np.asarray(found.x)


def breaking_time(steepest_rise: float, gamma: float) -> float:
    """t* = 1/(gamma max R0'): when the climbing wave becomes vertical."""
    return 1 / (gamma * steepest_rise) if steepest_rise > 0 else math.inf
