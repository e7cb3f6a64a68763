r"""Exact solutions of BCRE on a tilted plane, for verification.

Each is an :class:`ExactSolution`: a problem with the layers that it has at every time. In
u = h + Sc x the equations are

    u_t = -E        R_t + v R_x = D_x R_xx + D_y R_yy + E
    E = -R (gamma u_x + kappa_x u_xx + kappa_y u_yy)
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from bcre_pde import exact as line
from bcre_pde import simple_wave
from bcre_pde.plane import theory
from bcre_pde.plane.material import Material
from bcre_pde.plane.problem import Problem, Sides
from bcre_pde.problem import Array, Ends


@dataclass(frozen=True)
class ExactSolution:
    """Layers known at every time.

    Parameters
    ----------
    name: what it is called.
    material, length, width, ends, sides: the problem it solves.
    until: a time up to which it is smooth and holds in the window.
    layers: function of positions x and y, of one shape, and a time, returning h and R there.
    window: the stretch of x in which it holds until then.
    floor: absolute error below which rounding, or what the solution leaves out, counts.
    """

    name: str
    material: Material
    length: float
    width: float
    ends: Ends
    sides: Sides
    until: float
    layers: Callable[[Array, Array, float], tuple[Array, Array]]
    window: tuple[float, float]
    floor: float = 1e-12

    @property
    def problem(self) -> Problem:
        """The initial value problem."""
        return Problem(self._start, self.material, self.length, self.width, self.ends, self.sides)

    def _start(self, x: Array, y: Array) -> tuple[Array, Array]:
        return self.layers(x, y, 0.0)


def frozen_slope_release(
    excess: float, material: Material, sides: Sides = "periodic"
) -> ExactSolution:
    r"""The Gaussian of :func:`bcre_pde.plane.theory.frozen_slope_release` on 40 x 24 lengths.

    A layer of 1e-100 leaves the slope as it is. It starts at the age at which it is two lengths
    wide along, in the middle of a plane; its images beyond the sides, which make the closed form
    obey joined and closed sides alike, are added.
    """
    length, width, M = 40.0, 24.0, 1e-100
    age, S = 2.0 / material.D_x, material.Sc + excess

    def layers(x: Array, y: Array, t: float) -> tuple[Array, Array]:
        beyond = (y - width / 2 + image * width for image in range(-2, 3))
        downhill = x - 12.0 + material.v * age
        R = sum(
            theory.frozen_slope_release(downhill, across, t + age, M, material, S)
            for across in beyond
        )
        return S * (length - x), np.asarray(R)

    until = 12.0 / material.v
    window = (4.0, length - 4.0)
    return ExactSolution(
        "frozen slope", material, length, width, "open", sides, until, layers, window, 1e-112
    )


def extruded(solution: line.ExactSolution, width: float, D_y: float = 0.0) -> ExactSolution:
    """A solution of the line, the same for every y: whatever spreads across has nothing to do."""

    def layers(x: Array, y: Array, t: float) -> tuple[Array, Array]:
        h, R = solution.layers(x[:, 0], t)
        return np.broadcast_to(h[:, None], x.shape), np.broadcast_to(R[:, None], x.shape)

    return ExactSolution(
        solution.name + ", extruded across",
        replace(Material.isotropic(solution.material), D_y=D_y),
        solution.length,
        width,
        solution.ends,
        "periodic",
        solution.until,
        layers,
        solution.window,
        solution.floor,
    )


def oblique_climbing_wave(
    v: float, gamma: float, height: float, swing: float, length: float, width: float, until: float
) -> ExactSolution:
    r"""R = R0(x - a sin(2 pi y/width) + gamma R t), D_x = D_y = kappa = 0.

    Where nothing spreads across, every column is a line of its own, and the climbing wave of
    :mod:`bcre_pde.simple_wave` an exact nonlinear solution there, wherever it stands: here
    its crest swings along x by ``swing`` (a) across the plane.
    """
    width_of_hump, Sc = 1.5, 0.5
    hump = line.climbing_hump(v, gamma, height, width_of_hump, length, until, Sc)

    def layers(x: Array, y: Array, t: float) -> tuple[Array, Array]:
        moved = (x - swing * np.sin(2 * math.pi * y / width)) % length
        _, R = hump.layers(moved.ravel(), t)
        R = R.reshape(x.shape)
        return simple_wave.surface(hump.material, x, R), R

    return ExactSolution(
        "oblique climbing wave",
        Material(v, 0.0, 0.0, gamma, Sc),
        length,
        width,
        "periodic",
        "periodic",
        until,
        layers,
        (0.0, length),
    )


def oblique_rolling_mode(k_x: float, k_y: float, material: Material, until: float) -> ExactSolution:
    """R = 1 + e^(-(D_x k_x^2 + D_y k_y^2) t) sin(k_x (x - v t) + k_y y)/2 on the repose plane.

    u is constant, so E = 0. The plane is one wave long and wide.
    """
    rate = theory.rolling_mode_rate(material, k_x, k_y)

    def layers(x: Array, y: Array, t: float) -> tuple[Array, Array]:
        wave = np.exp(rate * t + 1j * (k_x * x + k_y * y)).imag
        return -material.Sc * x, 1 + wave / 2

    return _one_wave("oblique rolling mode", material, k_x, k_y, until, layers)


def oblique_surface_mode(k_x: float, k_y: float, material: Material, until: float) -> ExactSolution:
    r"""u = a Im e^(lambda t + j k.x) under R = 1, for a small a; D_x = D_y = 0.

    lambda is :func:`bcre_pde.plane.theory.surface_mode_rate`, and R_t + v R_x = -u_t gives
    R = 1 + a Im [lambda/(lambda + j k_x v) (e^(-j k_x v t) - e^(lambda t)) e^(j k.x)]. The second
    order, a^2 = 1e-14, is left out.
    """
    rate = theory.surface_mode_rate(material, 1.0, k_x, k_y)
    carried_at = -1j * k_x * material.v
    share, amplitude = rate / (rate - carried_at), 1e-7

    def layers(x: Array, y: Array, t: float) -> tuple[Array, Array]:
        wave = amplitude * np.exp(1j * (k_x * x + k_y * y))
        carried = np.exp(carried_at * t) - np.exp(rate * t)
        return (wave * np.exp(rate * t)).imag - material.Sc * x, 1 + (wave * share * carried).imag

    solution = _one_wave("oblique surface mode", material, k_x, k_y, until, layers)
    return replace(solution, floor=2e-13)


def _one_wave(
    name: str,
    material: Material,
    k_x: float,
    k_y: float,
    until: float,
    layers: Callable[[Array, Array, float], tuple[Array, Array]],
) -> ExactSolution:
    length, width = 2 * math.pi / k_x, 2 * math.pi / k_y
    return ExactSolution(
        name, material, length, width, "periodic", "periodic", until, layers, (0.0, length)
    )
