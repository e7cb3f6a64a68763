r"""Closed forms of BCRE: frozen slopes, small waves, and the stability of steps.

On a frozen slope S the rolling layer obeys R_t + v R_x = D R_xx + sigma R, sigma = gamma (S - Sc),
and a point release of area M is

    R = M (4 pi D t)^(-1/2) exp(sigma t - (x - v t)^2/(4 D t))

(Bouchaud et al. 1994). Growth at a fixed place, the speed of the edges, and Sd follow from it.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.polynomial import polynomial
from numpy.typing import ArrayLike, NDArray

from bcre_pde.explicit import ExplicitMethod, tableau
from bcre_pde.gate import (
    is_finite,
    is_number,
    require_kind,
    require_not_negative,
    require_positive,
)
from bcre_pde.material import Material
from bcre_pde.problem import Array


def second_critical_slope(v: float, D: float, gamma: float, Sc: float) -> float:
    """Sd = Sc + v^2/(4 D gamma): above it a frozen slope grows R at every fixed place.

    Infinite where D or gamma is zero (but v is not): everything is then carried away first.

    >>> second_critical_slope(v=1.0, D=1.0, gamma=0.5, Sc=0.5)
    1.0
    """
    for name, value in (("v", v), ("D", D), ("gamma", gamma)):
        require_not_negative(name, value)
    if not is_finite(Sc):
        raise ValueError(f"Sc = {Sc!r}: must be a finite number")
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


def spectrum(
    drift_number: float, spread_number: float, angles: ArrayLike, *, rough: bool = False
) -> NDArray[np.complex128]:
    r"""lambda dt of a Fourier mode e^(j theta i), i the cell, on a periodic grid.

    lambda dt = -c (1 - e^(-j theta)) f + s b
    f = (2 e^(-2 j theta) - 13 e^(-j theta) + 47 + 27 e^(j theta) - 3 e^(2 j theta))/60
    b = (4 cos 3 theta - 54 cos 2 theta + 540 cos theta - 490)/180

    are the stencils of :mod:`bcre_pde.line.fluxes`, exact for a wave of more than six cells. A
    shorter one is rough: the limiter moves the value on a face towards the cell upwind. At that
    cell f = 1, which damps more, and so an explicit step leaves its stable region earlier.

    Parameters
    ----------
    drift_number: c = v dt/dx for R. The mirrored stencil of u under a uniform R gives the conjugate
        of the same with c = gamma R dt/dx.
    spread_number: s = D dt/dx^2 for R, kappa R dt/dx^2 for u.
    angles: theta = k dx, any shape.
    rough: whether the limiter has moved every face value onto the cell upwind.
    """
    theta = np.asarray(angles, dtype=float)
    wave = np.exp(1j * theta)
    smooth = (2 / wave**2 - 13 / wave + 47 + 27 * wave - 3 * wave**2) / 60
    face = np.ones_like(wave) if rough else smooth
    bend = (4 * np.cos(3 * theta) - 54 * np.cos(2 * theta) + 540 * np.cos(theta) - 490) / 180
    return np.asarray(-drift_number * (1 - 1 / wave) * face + spread_number * bend)


def stability_polynomial(method: ExplicitMethod) -> Array:
    """Coefficients of P, constant first: one step of y' = lambda y is y P(lambda dt).

    p_0 = 1 and p_k = b a^(k-1) 1, a and b as in :class:`bcre_pde.explicit.Tableau`; this is 1/k! up
    to the order of the method. LSODA and BDF, adaptive and implicit, have no such polynomial.
    """
    increments, weights, _ = tableau(method)
    stage = np.ones(weights.size)
    coefficients = [1.0]
    for _ in range(weights.size):
        coefficients.append(float(weights @ stage))
        stage = increments @ stage
    return np.array(coefficients)


ANGLES = np.linspace(0.0, math.pi, 4097)
"""Waves that are examined by default; those with theta < 0 have the conjugate spectrum."""

ROUNDING = 1e-12
"""|P| above 1 by no more than this is rounding, as at theta = 0, where P = 1."""


def amplification_bound(
    courant: float,
    diffusion_number: float,
    climb_number: float,
    method: ExplicitMethod,
    angles: ArrayLike = ANGLES,
    *,
    rough: bool = False,
) -> float:
    """Largest |P(lambda dt)| of a small wave of R or of u: growth of its amplitude in one step.

    Parameters
    ----------
    courant, diffusion_number, climb_number: v dt/dx, D dt/dx^2 and gamma R dt/dx, each >= 0; the
        first two are those of the waves of R, the third of those of u (without curvature term).
    method: see :func:`bcre_pde.fixed_step.take_fixed_steps`.
    angles: theta = k dx; 2 pi m/N, m = 0 .. N/2, are all waves of a periodic grid of N cells.
    rough: see :func:`spectrum`.
    """
    P = stability_polynomial(method)
    rows = ((courant, diffusion_number), (climb_number, 0.0))
    waves = [spectrum(*numbers, angles, rough=rough) for numbers in rows]
    return max(float(np.abs(polynomial.polyval(row, P)).max()) for row in waves)


def stable(
    courant: float, diffusion_number: float, climb_number: float, method: ExplicitMethod
) -> bool:
    """Whether |P(lambda dt)| <= 1 for all waves of R and of u, smooth and rough alike.

    Rough waves decide where drift and diffusion act together: for "runge-kutta" and "RK45" rough
    data start to grow within 3 % of the predicted boundary. For "DOP853" the prediction is too
    optimistic where drift or climb dominates. The limiter acts differently in its twelve stages, so
    that the step is no polynomial in lambda: rough data grow from a Courant number of 2.0, not 3.2.
    """
    numbers = courant, diffusion_number, climb_number
    bounds = (amplification_bound(*numbers, method, rough=rough) for rough in (False, True))
    return max(bounds) <= 1 + ROUNDING


def largest_explicit_step(material: Material, dx: float, largest_R: float) -> float:
    """Step at which an explicit Runge-Kutta method of order 4 is still stable on a line.

    On the negative real axis the spectra of the stencils reach 32/15 for the drift v/dx and the
    climb gamma R/dx, 272/45 for the spreads D/dx^2 and kappa R/dx^2, and the method 2.78. A thick
    layer drifts at dJ/dR = v + Gamma R.
    """
    from bcre_pde.exchange import exchanging  # late: slow to import

    require_kind("material", material, Material)
    require_positive("dx", dx)
    if not is_number(largest_R):
        raise ValueError(f"largest_R = {largest_R!r}: must be a number")
    wet = exchanging(largest_R, material.saturation)
    drift = max(material.v + material.Gamma * max(largest_R, 0.0), material.gamma * wet)
    spread = max(material.D, material.kappa * wet)
    rate = 32 / 15 * drift / dx + 272 / 45 * spread / dx**2
    return 2.78 / rate if rate > 0 else math.inf
