r"""A one-layer rule in the manner of Hwa and Kardar (Phys. Rev. Lett. 62 (1989) 1813), plain NumPy.

    w(i) += dt/d (F(i-1) - F(i))        F(i) = (lambda/2) U(w(i), w(i+1)) - nu (w(i+1) - w(i))/d

w is the height above a surface at repose. It moves at lambda w, downhill where it lies above and
uphill where it lies below, and U(a, b) is its square from upwind, the larger of max(a, 0)^2 and
min(b, 0)^2. Both ends are joined.

This is the explicit first-order upwind scheme of w_t = nu w_xx - (lambda/2)(w^2)_x. To first order
it solves that equation with nu_eff = nu + (lambda abs(w) d/2)(1 - lambda abs(w) dt/d). A step is
stable where lambda max(abs(w)) dt/d + 2 nu dt/d^2 <= 1.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def march(
    w: Array,
    lam: float,
    nu: float,
    d: float,
    dt: float,
    steps: int,
) -> Array:
    """The height above repose after so many steps, the ends joined.

    Parameters
    ----------
    w: height above a surface at repose, a length, shape (N,).
    lam: speed per unit of height, 1/time, >= 0.
    nu: diffusion, length^2/time, >= 0.
    d, dt: cell and step.

    Raises
    ------
    ValueError
        where the step is not stable.
    """
    w = np.array(w, dtype=float)
    bound = largest_stable_step(w, lam, nu, d)
    if not 0 < dt <= bound:
        raise ValueError(f"dt = {dt!r}: must be > 0 and at most {bound:.6g}")
    for _ in range(steps):
        beyond = np.roll(w, -1)
        square = np.maximum(np.maximum(w, 0.0) ** 2, np.minimum(beyond, 0.0) ** 2)
        flux = lam / 2 * square - nu * (beyond - w) / d
        w += dt / d * (np.roll(flux, 1) - flux)
    return w


def largest_stable_step(w: Array, lam: float, nu: float, d: float) -> float:
    """The longest stable dt; no height is later larger than the largest of ``w``, (N,)."""
    rate = lam * float(np.abs(w).max()) / d + 2 * nu / d**2
    return 1 / rate if rate > 0 else math.inf
