r"""Exact solutions of the full, nonlinear equations, for verification.

Each is an :class:`ExactSolution`: a problem with the layers that it has at every time. Where a
solution does not obey the ends of the domain, it holds in a ``window`` that their influence,
travelling downhill at v and uphill at gamma R, has not reached.

Written in u = h + Sc x the equations are, with D and kappa only where they are named,

    u_t = -E        R_t + v R_x = D R_xx + E        E = -R (gamma u_x + kappa u_xx).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from bcre_pde import simple_wave
from bcre_pde.material import Material
from bcre_pde.problem import Array, Ends, Problem

MARGIN = 12.0
"""Distance kept from where the influence of an end would stand without any numerical diffusion."""


@dataclass(frozen=True)
class ExactSolution:
    """Layers known at every time.

    Parameters
    ----------
    name: what it is called.
    material, length, ends: the problem it solves.
    until: a time up to which it is smooth and holds in the window.
    layers: function of positions (N,) and a time, returning h and R there.
    window: the part of the domain in which it holds until then.
    floor: absolute error below which rounding, or what the solution leaves out, counts.
    """

    name: str
    material: Material
    length: float
    ends: Ends
    until: float
    layers: Callable[[Array, float], tuple[Array, Array]]
    window: tuple[float, float]
    floor: float = 1e-12

    @property
    def problem(self) -> Problem:
        """The initial value problem."""
        return Problem(self._start, self.material, self.length, self.ends)

    def _start(self, x: Array) -> tuple[Array, Array]:
        return self.layers(x, 0.0)


def rolling_mode(wavenumber: float, v: float, D: float, Sc: float = 0.5) -> ExactSolution:
    """R = 1 + e^(-D k^2 t) sin(k (x - v t))/2 on the repose slope.

    u is constant, so E = 0 and R obeys R_t + v R_x = D R_xx.
    """

    def layers(x: Array, t: float) -> tuple[Array, Array]:
        decay = math.exp(-D * wavenumber**2 * t)
        return -Sc * x, 1 + decay / 2 * np.sin(wavenumber * (x - v * t))

    length = 2 * math.pi / wavenumber
    until = 0.5 * length / v
    material = Material(v, D, 0.5, Sc)
    return ExactSolution("rolling mode", material, length, "periodic", until, layers, (0.0, length))


def surface_mode(
    wavenumber: float, gamma: float, kappa: float, v: float, Sc: float = 0.5
) -> ExactSolution:
    r"""u = a Im e^(lambda t + j k x), lambda = j gamma k - kappa k^2, under R = 1, for a small a.

    To first order in a, u_t = gamma u_x + kappa u_xx, which lambda solves, and R_t + v R_x = -u_t,
    hence R = 1 + a Im [lambda/(lambda + j k v) (e^(-j k v t) - e^(lambda t)) e^(j k x)]. The second
    order, a^2 = 1e-14, is left out.
    """
    amplitude = 1e-7
    rate = complex(-kappa * wavenumber**2, gamma * wavenumber)
    share = rate / (rate + 1j * wavenumber * v)

    def layers(x: Array, t: float) -> tuple[Array, Array]:
        wave = amplitude * np.exp(1j * wavenumber * x)
        carried = np.exp(-1j * wavenumber * v * t) - np.exp(rate * t)
        return (wave * np.exp(rate * t)).imag - Sc * x, 1 + (wave * share * carried).imag

    length = 2 * math.pi / wavenumber
    material = Material(v, 0.0, gamma, Sc, kappa)
    until = 0.5 * length / gamma
    return ExactSolution(
        "surface mode", material, length, "periodic", until, layers, (0.0, length), floor=2e-13
    )


def frozen_slope_release(
    excess: float, v: float, D: float, gamma: float, Sc: float = 0.5
) -> ExactSolution:
    r"""R = M (4 pi D t)^(-1/2) exp(sigma t - (x - v t)^2/(4 D t)), sigma = gamma (S - Sc).

    A layer of 1e-100 leaves the slope as it is: E = sigma R, and with R = e^(sigma t) r the
    equation is the advection and diffusion of r from a point (Bouchaud et al. 1994). It starts here
    at the age at which it is two lengths wide.
    """
    age, centre, length = 1.0 / D, 15.0, 60.0
    sigma, M = gamma * excess, 1e-100

    def layers(x: Array, t: float) -> tuple[Array, Array]:
        spread = 4 * D * (t + age)
        distance = x - centre - v * t
        R = M / math.sqrt(math.pi * spread) * np.exp(sigma * t - distance**2 / spread)
        return (Sc + excess) * (length - x), R

    material = Material(v, D, gamma, Sc)
    until = 15.0 / v
    return ExactSolution(
        "frozen slope", material, length, "open", until, layers, (8.0, 52.0), 1e-112
    )


def simple_wave_of_hump(
    material: Material, height: float, width: float, length: float, until: float
) -> ExactSolution:
    """The simple wave of R0 = 1 + height exp(-((x - length/2)/width)^2), periodic.

    See :mod:`bcre_pde.simple_wave`; D and kappa of the material are 0.
    """
    R0 = partial(_hump, height=height, width=width, length=length)
    speed = partial(simple_wave.climb, material)

    def layers(x: Array, t: float) -> tuple[Array, Array]:
        R = simple_wave.layer(x, t, R0, speed, 1 + height)
        return simple_wave.surface(material, x, R), R

    name = "thick climbing wave" if material.Gamma else "climbing wave"
    return ExactSolution(name, material, length, "periodic", until, layers, (0.0, length))


def climbing_hump(
    v: float,
    gamma: float,
    height: float,
    width: float,
    length: float,
    until: float,
    Sc: float = 0.5,
) -> ExactSolution:
    """:func:`simple_wave_of_hump` in BCRE: R(x, t) = R0(x + gamma R t)."""
    return simple_wave_of_hump(Material(v, 0.0, gamma, Sc), height, width, length, until)


def tilted_climbing_wave(
    excess: float, v: float, gamma: float, height: float, width: float, Sc: float = 0.5
) -> ExactSolution:
    r"""x = x0 - R0(x0)(e^(gamma c t) - 1)/c, R = R0(x0) e^(gamma c t), c the excess slope.

    Let w = R + u + (v/gamma) ln R = -c x at the start; carried at v it is -c (x - v t) later. With
    u = -c (x - v t) - R - (v/gamma) ln R the first equation becomes R_t = gamma R (R_x + c): along
    dx/dt = -gamma R the layer grows as dR/dt = gamma c R, which integrates to the above.
    """
    length = 80.0
    R0 = partial(_hump, height=height, width=width, length=length)
    until = 0.5 / (gamma * excess)

    def layers(x: Array, t: float) -> tuple[Array, Array]:
        growth = math.exp(gamma * excess * t)
        climb = (growth - 1) / excess

        def gap(start: Array, place: Array) -> Array:
            return start - R0(start) * climb - place

        start = simple_wave.root(gap, x, x + (1 + height) * climb + 1e-9, x)
        R = R0(start) * growth
        u = -excess * (x - v * t) - R - v / gamma * np.log(R)
        return u - Sc * x, R

    reached = gamma * (1 + height) * math.exp(0.5) * until
    material = Material(v, 0.0, gamma, Sc)
    window = (v * until + MARGIN, length - reached - MARGIN)
    return ExactSolution("tilted climbing wave", material, length, "open", until, layers, window)


def steady_filling(w: float, v: float, gamma: float, Sc: float = 0.5) -> ExactSolution:
    """R = w (L - x)/v, S - Sc = -v/(gamma (L - x)), rising at w behind a wall at L.

    E = gamma R (S - Sc) = -w everywhere, so h rises at w; v R_x = -w balances it. The domain ends
    short of the wall, where R is so thin that the influence of the foot hardly climbs.
    """
    wall, length, until = 30.0, 28.0, 6.0

    def layers(x: Array, t: float) -> tuple[Array, Array]:
        u = w * t - v / gamma * np.log(wall - x)
        return u - Sc * x, w * (wall - x) / v

    material = Material(v, 0.0, gamma, Sc)
    window = (v * until + MARGIN, length - 2.0)
    return ExactSolution("steady filling", material, length, "open", until, layers, window)


def saturated_flow(
    amplitude: float, wavenumber: float, v: float, v_up: float, Sc: float = 0.5
) -> ExactSolution:
    r"""s = s0(x + v_up t), R = R0 + v_up/(v + v_up) (H(x + v_up t) - H(x - v t)), H' = s0.

    s = S - Sc. In the thick limit gamma R >> v_up the saturated law is E = v_up s, so that
    s_t = v_up s_x and R_t + v R_x = v_up s, which is linear: the forcing travels uphill and with it
    the response, less a part carried downhill that makes it start from R0. Here s0 = a sin(k x)
    and gamma = 1e14, so that the limit is reached to rounding.
    """

    def H(x: Array) -> Array:
        return -amplitude / wavenumber * np.cos(wavenumber * x)

    def layers(x: Array, t: float) -> tuple[Array, Array]:
        climbed, carried = H(x + v_up * t), H(x - v * t)
        return -climbed - Sc * x, 1 + v_up / (v + v_up) * (climbed - carried)

    length = 2 * math.pi / wavenumber
    material = Material(v, 0.0, 1e14, Sc, v_up=v_up)
    until = 0.5 * length / (v + v_up)
    return ExactSolution(
        "saturated flow", material, length, "periodic", until, layers, (0.0, length)
    )


def _hump(x: Array, height: float, width: float, length: float) -> Array:
    distance = (x - length / 2 + length / 2) % length - length / 2
    return 1 + height * np.exp(-((distance / width) ** 2))
