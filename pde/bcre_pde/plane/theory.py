r"""Closed forms of BCRE on a tilted plane: frozen slopes, opening angles, small waves.

On a frozen slope S the rolling layer obeys R_t + v R_x = D_x R_xx + D_y R_yy + sigma R with
sigma = gamma (S - Sc). A volume M released at a point becomes

    R = M/(4 pi t sqrt(D_x D_y)) exp(sigma t - (x - v t)^2/(4 D_x t) - y^2/(4 D_y t))

and all that ever passes a place, as long as sigma < v^2/(4 D_x), that is S < Sd, is

    N = int R dt = M/(2 pi sqrt(D_x D_y)) e^(v x/(2 D_x)) K0(sqrt(v^2/(4 D_x) - sigma) rho)
    rho^2 = x^2/D_x + y^2/D_y

(Gradshteyn and Ryzhik, 3.471.9). K0 falls as e^-(its argument), so that N grows downhill within the
wedge where v x/(2 D_x) exceeds that, and vanishes outside: tan^2 theta as :func:`opening_angle`.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from bcre_pde.plane.material import Material
from bcre_pde.problem import Array
from bcre_pde.theory import second_critical_slope


def opening_angle(material: Material, S: float) -> float:
    """theta in degrees, the half-angle of an avalanche on a frozen slope S > Sc.

    tan^2 theta = (D_y/D_x) (S - Sc)/(Sd - S) below the second critical slope Sd; 90 from there on,
    where R grows at every fixed place (Bouchaud and Cates 1998).
    """
    m = material
    excess = S - m.Sc
    if not excess > 0:
        raise ValueError(f"S = {S!r}: an avalanche needs a slope above Sc = {m.Sc!r}")
    short = second_critical_slope(m.v, m.D_x, m.gamma, m.Sc) - S
    if short <= 0:
        return 90.0
    if m.D_x == 0:
        return math.degrees(math.atan(2 * math.sqrt(m.D_y * m.gamma * excess) / m.v))
    return math.degrees(math.atan(math.sqrt(m.D_y / m.D_x * excess / short)))


def frozen_slope_release(
    x: ArrayLike, y: ArrayLike, t: float, M: float, material: Material, S: float
) -> Array:
    """R(x, y, t) of a volume M released at x = y = 0, t = 0; t, D_x, D_y > 0."""
    m, x, y = material, np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    growth = m.gamma * (S - m.Sc) * t
    along, across = (x - m.v * t) ** 2 / (4 * m.D_x * t), y**2 / (4 * m.D_y * t)
    scale = M / (4 * math.pi * t * math.sqrt(m.D_x * m.D_y))
    return np.asarray(scale * np.exp(growth - along - across))


def passed_in_all(x: ArrayLike, y: ArrayLike, M: float, material: Material, S: float) -> Array:
    """N(x, y), the time integral of that release, S below Sd; lengths times times."""
    from scipy.special import k0e  # late: slow to import

    m, x, y = material, np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    decay = m.v**2 / (4 * m.D_x) - m.gamma * (S - m.Sc)
    if not decay > 0:
        raise ValueError(f"S = {S!r}: from the second critical slope on N is infinite")
    reach = np.sqrt(decay * (x**2 / m.D_x + y**2 / m.D_y))
    scale = M / (2 * math.pi * math.sqrt(m.D_x * m.D_y))
    return np.asarray(scale * np.exp(m.v * x / (2 * m.D_x) - reach) * k0e(reach))


def rolling_mode_rate(material: Material, k_x: float, k_y: float) -> complex:
    """-j v k_x - D_x k_x^2 - D_y k_y^2: rate of a Fourier mode of R on the repose plane."""
    m = material
    return complex(-m.D_x * k_x**2 - m.D_y * k_y**2, -m.v * k_x)


def surface_mode_rate(material: Material, R0: float, k_x: float, k_y: float) -> complex:
    """R0 (j gamma k_x - kappa_x k_x^2 - kappa_y k_y^2): rate of a mode of h under a uniform R0.

    Across, a mode of the surface neither travels nor, but for kappa_y, decays.
    """
    m = material
    return R0 * complex(-m.kappa_x * k_x**2 - m.kappa_y * k_y**2, m.gamma * k_x)


def largest_explicit_step(material: Material, dx: float, dy: float, largest_R: float) -> float:
    """Step at which an explicit Runge-Kutta method of order 4 is still stable on a plane.

    As :func:`bcre_pde.theory.largest_explicit_step` on a line, with what spreads along and across
    added up.
    """
    from bcre_pde.exchange import exchanging  # late: slow to import

    def spread(along: float, across: float) -> float:
        return 272 / 45 * (along / dx**2 + across / dy**2)

    m, wet = material, exchanging(largest_R, material.along.saturation)
    rolling = 32 / 15 * m.v / dx + spread(m.D_x, m.D_y)
    climbing = 32 / 15 * m.gamma * wet / dx + spread(m.kappa_x, m.kappa_y) * wet
    rate = max(rolling, climbing)
    return 2.78 / rate if rate > 0 else math.inf
