r"""Closed forms of BCRE: frozen slopes, small waves and the scarp.

On a frozen slope S the rolling layer obeys R_t + v R_x = D R_xx + sigma R, sigma = gamma (S - Sc),
and a point release of area M is

    R = M (4 pi D t)^(-1/2) exp(sigma t - (x - v t)^2/(4 D t))

(Bouchaud et al. 1994). Growth at a fixed place, the speed of its edges, and Sd follow from it.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def second_critical_slope(v: float, D: float, gamma: float, Sc: float) -> float:
    """Sd = Sc + v^2/(4 D gamma): above it a frozen slope grows R at every fixed place.

    Infinite where D or gamma is zero (but v is not): everything is then carried away first.
    """
    if v == 0:
        return Sc
    return Sc + v**2 / (4 * D * gamma) if D * gamma > 0 else math.inf


def growth_rate_at_a_fixed_place(v: float, D: float, sigma: float) -> float:
    """sigma - v^2/(4 D), D > 0: the rate at which R grows where the observer stands."""
    return sigma - v**2 / (4 * D)


def uphill_front_speed(v: float, D: float, sigma: float) -> float:
    """2 sqrt(D sigma) - v, sigma > 0: how fast the uphill edge of R climbs; negative below Sd."""
    if not sigma > 0:
        raise ValueError(f"sigma = {sigma!r}: a front needs growth, gamma (S - Sc) > 0")
    return 2 * math.sqrt(D * sigma) - v


def frozen_slope_release(
    x: ArrayLike, t: float, M: float, v: float, D: float, sigma: float
) -> Array:
    """R(x, t) of an area M released at x = 0, t = 0 on a frozen slope; t > 0, D > 0."""
    x = np.asarray(x, dtype=float)
    spread = 4 * D * t
    return np.asarray(M / np.sqrt(np.pi * spread) * np.exp(sigma * t - (x - v * t) ** 2 / spread))


def rolling_mode_rate(v: float, D: float, wavenumber: float) -> complex:
    """-j v k - D k^2: rate of a Fourier mode of R on the repose slope."""
    return complex(-D * wavenumber**2, -v * wavenumber)


def surface_mode_rate(gamma: float, kappa: float, R0: float, wavenumber: float) -> complex:
    """j gamma R0 k - kappa R0 k^2: rate of a Fourier mode of h under a uniform rolling layer R0.

    The mode climbs at gamma R0; only kappa makes it decay.
    """
    return complex(-kappa * R0 * wavenumber**2, gamma * R0 * wavenumber)


def scarp_speed(v: float, gamma: float, H: float) -> float:
    """c = gamma H - v: climb of a sharp scarp, H the jump of u across it.

    Ahead of the scarp R = 0, behind it R* and u lower by H. Mass: the eroded c H equals the growth
    c R* of the rolling layer plus what it carries away, v R*; the climb is c = gamma R*. So
    R* = H - v/gamma.
    """
    return gamma * H - v
