r"""A scarp that climbs at constant speed: an exact solution past the time at which a wave breaks.

    u = H above x_s(t) = x_0 - c t, 0 below it      c = gamma X(R*)      R* (v + c) = c H
    R = R* exp((x - x_s)(v + c)/D) above it, R* below

with kappa = Gamma = 0, D > 0 and the exchange X(R) of :mod:`bcre_pde.exchange`. In the frame of the
scarp c u' = gamma X(R) u', so that u may change only where gamma X(R) = c. What the scarp erodes,
c H, is what the layer below grows by, c R*, and carries away, v R*. Where u is even,
(v + c) R' = D R''. So R is continuous, and u jumps. R* and c do not depend on D: they are those of
:func:`bcre_pde.simple_wave.scarp_layer`.
"""

from __future__ import annotations

import numpy as np

from bcre_pde import simple_wave
from bcre_pde.exact import ExactSolution
from bcre_pde.material import Material
from bcre_pde.problem import Array


def travelling_scarp(
    material: Material, H: float, start: float, length: float, climb: float
) -> ExactSolution:
    """The scarp of height H from x = ``start`` until it has climbed ``climb``.

    Above it R has fallen to exp(-(start - climb)(v + c)/D) at the top, which the closed end there
    asks to be small.

    Parameters
    ----------
    material: its D > 0, kappa = Gamma = 0.
    H: jump of u, a length; gamma H > v, else no scarp climbs.

    Raises
    ------
    ValueError
        where the material has no such solution.
    """
    v, D, gamma = material.v, material.D, material.gamma
    if not (D > 0 and material.kappa == material.Gamma == 0 and gamma * H > v):
        raise ValueError(f"H = {H!r}, {material}: needs D > 0, kappa = Gamma = 0 and gamma H > v")
    R_below = simple_wave.scarp_layer(material, H)
    c = simple_wave.scarp_speed(material, H)

    def layers(x: Array, t: float) -> tuple[Array, Array]:
        above = np.minimum(x - start + c * t, 0.0)
        u = np.where(above < 0, H, 0.0)
        return u - material.Sc * x, R_below * np.exp(above * (v + c) / D)

    return ExactSolution(
        "travelling scarp", material, length, "open", climb / c, layers, (0.0, length)
    )
