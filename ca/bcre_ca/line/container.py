"""Lines with sources and walls: which parameters they have, and one step in plain NumPy.

A wall at the foot lets nothing pass, and the surface is level against it; what sources pour falls
into R. All else is the upwind rule of :mod:`bcre_ca.line.step`, or that of
:mod:`bcre_ca.line.slope_driven` where the rule has beta.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bcre_ca.coefficients import Coefficients, Parameters, every_term
from bcre_ca.exchange import carried, deposit_thin, eroded, leaving
from bcre_ca.rule import Ends, Rule
from bcre_ca.schemes import JOINED, OPEN, WALLED, InContainer, SlopeDriven

Array = NDArray[np.float64]


def parameters_of(
    rule: Rule, ends: Ends, cells: int, supply: Array | None = None, longest: float = math.inf
) -> Parameters:
    """The rule's parameters between these ends, with no term absent where they make a container.

    Parameters
    ----------
    supply: what sources pour into each cell, length/time, shape (N,).
    longest: a step that is long enough where no other bound is.

    Raises
    ------
    ValueError
        where the rule's scheme or order does not go with sources and walls.
    """
    p = rule.parameters()
    if ends != "wall" and supply is None and rule.beta == 0:
        return p
    if (rule.order, rule.scheme) != ("synchronous", "upwind"):
        raise ValueError(
            f"order = {rule.order!r}, scheme = {rule.scheme!r}: must be 'synchronous' and 'upwind' "
            "with a wall or sources"
        )
    poured = np.zeros(cells) if supply is None else np.array(supply, float)
    kind = {"open": OPEN, "wall": WALLED, "periodic": JOINED}[ends]
    scheme: Any = InContainer(poured, kind, longest)
    if rule.beta > 0:
        scheme = SlopeDriven(poured, kind, longest, float(rule.d))
    every: Parameters = every_term(p)
    return every._replace(scheme=scheme)


def step(h: Array, R: Array, K: Coefficients) -> tuple[Array, Array, float]:
    """The layers after one step of the upwind rule and what left through the foot.

    Parameters
    ----------
    h, R: static and rolling layer, lengths, shape (N,).
    K: coefficients with no term absent, of the scheme :class:`bcre_ca.schemes.InContainer`.
    """
    scheme: Any = K.scheme
    below = (h - np.append(h[1:], h[0] - K.repose_drop * h.size)) - K.repose_drop
    flux = np.zeros(h.size + 1)
    flux[1:] = carried(R, np.append(R[1:], R[0]), K)
    first = below[0]
    if scheme.ends == JOINED:
        flux[0], first = flux[-1], below[-1]
    elif scheme.ends == WALLED:
        flux[-1], below[-1] = 0.0, -K.repose_drop
    else:
        flux[-1], below[-1] = leaving(R[-1], K), 0.0
    above = np.append(first, below[:-1])
    exchange = eroded(R, below, above - below, K)
    new = (R + ((flux[:-1] - flux[1:]) + exchange)) + scheme.supply
    h, R = deposit_thin(h - exchange, new, R, K.dry, K.emptying)
    return h, R, float(flux[-1] - flux[0])
