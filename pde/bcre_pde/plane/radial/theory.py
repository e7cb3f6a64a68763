r"""Closed forms about an axis: filling a round silo, growing a cone, rills.

A silo of radius a that fills at the rate w, E = -w everywhere, has D = 0

    (1/r) (r v R)_r = -w        R = w (a^2 - r^2)/(2 v r)        S - Sc = -w/(gamma R)

where its source is not. As S >= 0 the surface is flat beyond the radius r* at which S would pass
zero, and R = w/(gamma Sc) there; grains reach the wall ever more slowly. A cone that grows obeys
the same with a its foot and w = Q/(pi a^2), Q what is poured.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from bcre_pde.material import Material
from bcre_pde.problem import Array


def flat_from(a: float, material: Material) -> float:
    """r* = -v/(gamma Sc) + sqrt((v/(gamma Sc))^2 + a^2), beyond which a filling silo is flat."""
    reach = material.v / (material.gamma * material.Sc)
    return -reach + math.hypot(reach, a)


def filling_layer(r: ArrayLike, w: float, a: float, material: Material) -> Array:
    """R in a silo of radius a that fills at w, outside its source, 0 < r <= a."""
    r = np.asarray(r, dtype=float)
    rolling = w * (a**2 - r**2) / (2 * material.v * r)
    return np.asarray(np.maximum(rolling, w / (material.gamma * material.Sc)))


def filling_slope(r: ArrayLike, a: float, material: Material) -> Array:
    """S in a filling silo, outside its source; it does not depend on the rate."""
    return np.asarray(material.Sc - 1 / (material.gamma * filling_layer(r, 1.0, a, material)))


def rill_growth_rate(material: Material, R0: float, S: float, wavenumber: float) -> float:
    r"""l, the growth of rills of a wavenumber k across a sheet R0 that erodes a slope S > Sc.

    l^2 + l (D k^2 - sigma) - sigma v R0 k^2/S = 0, sigma = gamma (S - Sc): sand that runs together
    digs, and the hollow draws more sand. Without D it grows the faster the shorter the wave: BCRE
    on a free surface is then ill posed, and the cells of a grid choose the rills.
    """
    m = material
    sigma = m.gamma * (S - m.Sc)
    half = (sigma - m.D * wavenumber**2) / 2
    return half + math.sqrt(half**2 + sigma * m.v * R0 * wavenumber**2 / S)
