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
from bcre_ca.schemes import InContainer, SlopeDriven

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
        where a rule or joined ends do not go with sources, walls or beta.
    """
    p = rule.parameters()
    if ends != "wall" and supply is None and rule.beta == 0:
        return p
    if ends == "periodic":
        raise ValueError(f"ends = {ends!r}: must be 'open' or 'wall' with sources or beta")
    if (rule.order, rule.scheme) != ("synchronous", "upwind"):
        raise ValueError(
            f"order = {rule.order!r}, scheme = {rule.scheme!r}: must be 'synchronous' and 'upwind' "
            "with a wall or sources"
        )
    poured = np.zeros(cells) if supply is None else np.array(supply, float)
    walled = ends == "wall"
    scheme: Any = InContainer(poured, walled, longest)
    if rule.beta > 0:
        scheme = SlopeDriven(poured, walled, longest, float(rule.d))
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
    below = (h - np.append(h[1:], 0.0)) - K.repose_drop
    below[-1] = -K.repose_drop if scheme.walled else 0.0
    above = np.append(below[0], below[:-1])
    flux = np.zeros(h.size + 1)
    flux[1:-1] = carried(R[:-1], R[1:], K)
    flux[-1] = 0.0 if scheme.walled else leaving(R[-1], K)
    exchange = eroded(R, below, above - below, K)
    new = (R + ((flux[:-1] - flux[1:]) + exchange)) + scheme.supply
    h, R = deposit_thin(h - exchange, new, R, K.dry, K.emptying)
    return h, R, float(flux[-1])
