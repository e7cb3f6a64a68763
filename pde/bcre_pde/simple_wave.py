r"""Simple waves and scarps, for any closure of the exchange and of the flux.

    dR/dt + dJ(R)/dx = c(R) (S - Sc)        dh/dt = -c(R) (S - Sc)

J is what the rolling layer carries and c the speed at which the surface climbs beneath it; D and
kappa are 0. In u = h + Sc x, where S - Sc = -u_x, the second equation is u_t = c u_x.

* **Simple wave.** Let u = U(R). Then u_t = c u_x says R_t = c R_x, and the first equation
  U' = -1 - J'/c. So, with any constant C,

      R(x, t) = R0(x + c(R) t)        u = C - R - I(R),   I = int (J'/c) dR

  until the wave breaks at t* = 1/max dc(R0)/dx.
* **Scarp.** A jump H of u climbs at c(R*), R* the layer at its foot; above it R = 0. Per unit of
  time the surface loses c H, which lengthens the layer by c R* and is carried away at the rate
  J(R*):

      H = R* + J(R*)/c(R*)

A material has J = v R + Gamma R^2/2 and c = gamma R/(1 + gamma R/v_up), hence

    I = (v/gamma) ln R + (Gamma/gamma + v/v_up) R + (Gamma/v_up) R^2/2.

This is BCRE for Gamma = 0 and v_up infinite, its saturated exchange for Gamma = 0, and the thick
flow of Aradian, Raphaël and de Gennes otherwise.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TypeVar

import numpy as np
from scipy.optimize import elementwise

from bcre_pde.material import Material
from bcre_pde.problem import Array

Profile = Callable[[Array], Array]
Number = TypeVar("Number", float, Array)


def climb(material: Material, R: Number) -> Number:
    """c(R) = gamma R/(1 + gamma R/v_up), a speed; R >= 0."""
    climbing: Number = material.gamma * R
    return climbing if math.isinf(material.v_up) else climbing / (1 + climbing / material.v_up)


def carried(material: Material, R: Number) -> Number:
    """J(R) = v R + Gamma R^2/2, an area per unit of time."""
    return material.v * R + material.Gamma * R * R / 2


def layer(x: Array, t: float, R0: Profile, speed: Profile, thickest: float) -> Array:
    r"""R(x, t) = R0(x + c(R) t), solved for R at every x.

    Parameters
    ----------
    x: positions, shape (N,).
    t: a time before the wave breaks (:func:`breaking_time`).
    R0: the initial rolling layer on all positions reached, > 0.
    speed: c as a function of R.
    thickest: an upper bound of R0, a length.
    """
    if t == 0:
        return R0(x)

    def gap(R: Array, place: Array) -> Array:
        return R - R0(place + speed(R) * t)

    return root(gap, np.zeros_like(x), np.full_like(x, thickest * (1 + 1e-9)), x)


def surface(material: Material, x: Array, R: Array) -> Array:
    """h = -Sc x - R - I(R): the surface beneath the simple wave R > 0, at positions x."""
    h = -material.Sc * x - R - material.v / material.gamma * np.log(R)
    linear = material.Gamma / material.gamma + material.v / material.v_up
    if linear or math.isfinite(material.v_up):
        h -= linear * R + material.Gamma / material.v_up * R**2 / 2
    return h


def breaking_time(steepest_rise: float) -> float:
    """t* = 1/max dc(R0)/dx: when the wave becomes vertical.

    >>> breaking_time(steepest_rise=0.1)
    10.0
    """
    return 1 / steepest_rise if steepest_rise > 0 else math.inf


def scarp_layer(material: Material, H: float) -> float:
    """R* at the foot of a scarp of height H; 0 where H < v/gamma, too low to climb.

    With the material's J and c the law H = R* + J(R*)/c(R*) is a quadratic equation,

        (Gamma/v_up) R*^2/2 + (1 + Gamma/(2 gamma) + v/v_up) R* + v/gamma - H = 0.
    """
    linear = 1 + material.Gamma / (2 * material.gamma) + material.v / material.v_up
    excess = max(H - material.v / material.gamma, 0.0)
    return (
        2 * excess / (linear + math.sqrt(linear**2 + 2 * material.Gamma / material.v_up * excess))
    )


def scarp_speed(material: Material, H: float) -> float:
    """c(R*), the climb of a sharp scarp, H the jump of u across it; for BCRE gamma H - v.

    >>> scarp_speed(Material(v=1.0, D=0.0, gamma=0.5, Sc=0.5), H=10.0)
    4.0
    """
    return climb(material, scarp_layer(material, H))


def root(gap: Callable[[Array, Array], Array], low: Array, high: Array, x: Array) -> Array:
    """Where ``gap(., x)`` changes sign between ``low`` and ``high``, element by element."""
    found = elementwise.find_root(
        gap, (low, high), args=(x,), tolerances={"xatol": 0.0, "xrtol": 4e-16}
    )
    return np.asarray(found.x)
