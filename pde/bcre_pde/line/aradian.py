r"""Thick surface flows (Aradian, Raphaël and de Gennes, Phys. Rev. E 60 (1999) 2009).

    dR/dt + d/dx (v R + Gamma R^2/2 - D dR/dx) = E        dh/dt = -E
    E = c(R) (S - Sc),   c = gamma R/(1 + gamma R/v_up)

In a thick layer the velocity grows evenly with the height above the static grains, v + Gamma z, so
that the layer as a whole carries v R + Gamma R^2/2. Only its lowest grains exchange, and the
surface climbs at no more than v_up (Boutreux, Raphaël and de Gennes, Phys. Rev. E 58 (1998) 4692).
A thin layer, for which gamma R << v_up and Gamma R << v, follows BCRE: so the neutral waves of the
surface, the growth on a frozen slope and Sd are those of BCRE.

The right-hand side is that of :mod:`bcre_pde.line.fluxes`, whose terms with Gamma and v_up these
are. A scarp climbs at the law of :mod:`bcre_pde.simple_wave`.
"""

from __future__ import annotations

import math
from dataclasses import replace

from bcre_pde.material import Material


def thick(material: Material) -> Material:
    """The material with the natural Gamma = gamma and v_up = v where it names none of its own.

    Both follow from one length, v/gamma: a layer of that thickness climbs at v/2 and moves at
    twice v at its surface.
    """
    return replace(
        material,
        Gamma=material.Gamma or material.gamma,
        v_up=material.v if math.isinf(material.v_up) else material.v_up,
    )
