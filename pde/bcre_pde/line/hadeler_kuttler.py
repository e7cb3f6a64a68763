r"""Sand that rolls as fast as it is steep (Hadeler and Kuttler, Granular Matter 2 (1999) 9).

    dR/dt + d/dx (beta R S - D dR/dx) = E + w        dh/dt = -E
    E = gamma R (abs(S) - Sc),   S = -dh/dx

The authors have no D; w is what sources pour. Grains follow the slope either way, so that heaps
and containers are the home of this model; between 0 and Sc the layer comes to rest. For D = 0 it
is hyperbolic everywhere: small waves on a slope S > 0 under a layer R move at

    (1/2) (beta S - gamma R +- sqrt((gamma R - beta S)^2 + 4 beta gamma R Sc)),

one downhill, one uphill at no more than gamma R + beta Sc.

* **Open ends** are a closed top, above which the surface goes on evenly, and a foot beyond which it
  goes on at repose, as in BCRE.
* **Walls** are mirrors at both ends: nothing passes, and the surface is level against them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from pde import CartesianGrid

from bcre_pde.gate import require_not_negative
from bcre_pde.line import heap_fluxes
from bcre_pde.line.marched import MarchedOnLine
from bcre_pde.problem import Array
from bcre_pde.stencils import GHOSTS


@dataclass(frozen=True)
class SlopeDriven:
    """The coefficients.

    Parameters
    ----------
    beta: speed of the rolling layer per unit of slope, length/time, >= 0.
    gamma: exchange rate, 1/time, >= 0.
    Sc: repose slope, tangent of the angle of repose, >= 0.
    D: diffusion of the rolling layer, length^2/time, >= 0.

    Raises
    ------
    ValueError
        naming the parameter, its value and what is allowed.
    """

    beta: float
    gamma: float
    Sc: float
    D: float = 0.0

    def __post_init__(self) -> None:
        for name in ("beta", "gamma", "Sc", "D"):
            require_not_negative(name, getattr(self, name))


class HadelerKuttler(MarchedOnLine):
    """The model on a line, for py-pde's solvers; the material is a :class:`SlopeDriven`."""

    material: SlopeDriven

    def __init__(
        self,
        material: SlopeDriven,
        grid: CartesianGrid,
        most_evaluations: float = math.inf,
        walled: bool = False,
    ) -> None:
        super().__init__(material, grid, most_evaluations, walled)
        padded = np.empty((3, self.cells + 2 * GHOSTS))
        self._scratch = padded, np.empty((2, self.cells + 1))
        self.supply = np.zeros(self.cells)

    def rate(self, layers: Array, out: Array) -> None:
        """Write the time derivative of the rows u, R and ends, shape (3, N), into ``out``."""
        m = self.material
        ends = 0 if self.periodic else 2 if self.walled else 1
        heap_fluxes.rate(
            layers, out, *self._scratch, self.supply, m.beta, m.gamma, m.Sc, m.D, self.dx, ends
        )

    def largest_explicit_step(self, largest_R: float) -> float:
        """Step at which an explicit method of order 4 is still stable, on the slopes of the moment.

        No wave is faster than gamma R + beta max(abs(S), Sc); for the rest see
        :func:`bcre_pde.theory.largest_explicit_step`.
        """
        m = self.material
        slopes = np.abs(m.Sc - np.diff(self.last_layers[0]) / self.dx)
        fastest = m.gamma * max(largest_R, 0.0) + m.beta * max(float(slopes.max()), m.Sc)
        rate = 32 / 15 * fastest / self.dx + 272 / 45 * m.D / self.dx**2
        return 2.78 / rate if rate > 0 else math.inf


def critical_slopes(material: SlopeDriven) -> tuple[float, float] | None:
    """The slopes between which a layer on a frozen slope grows at every fixed place, or None.

    There gamma (S - Sc) > (beta S)^2/(4 D): the drift grows with the slope too, and overtakes the
    growth again. With q = 2 D gamma/beta^2 the ends are S = q -+ sqrt(q^2 - 2 q Sc), which are real
    where D gamma >= beta^2 Sc.
    """
    if material.beta == 0:
        return material.Sc, math.inf
    q = 2 * material.D * material.gamma / material.beta**2
    spread = q * (q - 2 * material.Sc)
    if not (q > 0 and spread >= 0):
        return None
    upper = q + math.sqrt(spread)
    return 2 * q * material.Sc / upper, upper  # their product, without cancellation


def silo_slope(x: Array, material: SlopeDriven, length: float) -> Array:
    """S of a silo filled at its top x = 0 that rises evenly, D = 0: it is level at the wall x = L.

    What passes x is w (L - x) = beta R S, and gamma R (Sc - S) = w comes to rest everywhere, so
    that S = Sc (L - x)/(L - x + beta/gamma), whatever the rate.
    """
    left = length - np.asarray(x, dtype=float)
    return np.asarray(material.Sc * left / (left + material.beta / material.gamma))


def silo_layer(x: Array, material: SlopeDriven, length: float, w: float) -> Array:
    """R of the silo that rises at w: w (L - x + beta/gamma)/(beta Sc)."""
    left = length - np.asarray(x, dtype=float)
    return np.asarray(w * (left + material.beta / material.gamma) / (material.beta * material.Sc))
