r"""One step of the rule whose layer is driven by the slope, in plain NumPy.

    F(i)  = beta S(i) R - D (R(i+1) - R(i))/d    S(i) = (h(i) - h(i+1))/d    into cell i+1 from i
    E(i)  = gamma R(i) (S*(i) - Sc)              S*(i) = max(S(i), -S(i-1), 0)
    R(i) += dt/d (F(i-1) - F(i)) + dt E(i) + dt w(i)
    h(i) -= dt E(i)

This is the automaton of Hadeler and Kuttler's model (Granular Matter 2 (1999) 9), with beta S in
place of v. Grains follow the slope either way: F takes the R of the cell that lies higher, and S*
is the steepest fall from a cell. Where the surface falls downhill everywhere, S* = S, and with beta
S = v the step is the paper's.

Ends are a closed top and an open foot, beyond which the surface goes on at repose and R is the
same; walls at both, against which the surface is level; or joined as in :mod:`bcre_ca.line.step`. w
is what sources pour.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from bcre_ca.coefficients import Coefficients
from bcre_ca.inner import inner
from bcre_ca.line.second_order import larger, smaller
from bcre_ca.schemes import JOINED, OPEN

Array = NDArray[np.float64]


@inner
def carried(R: Any, R_next: Any, fall: Any, d: float, K: Coefficients) -> Any:
    """dt/d F from a cell of layer R to the next one, which lies lower by ``fall``."""
    speed = K.courant * (fall / d)
    driven = larger(speed, 0.0) * R + smaller(speed, 0.0) * R_next
    return driven + K.diffusion * (R - R_next)


@inner
def eroded(R: Any, fall_above: Any, fall_below: Any, K: Coefficients) -> Any:
    """dt E of a cell, into which the surface falls by the one and from which by the other."""
    steepest = larger(larger(fall_below, -fall_above), 0.0)
    return R * (K.exchange * (steepest - K.repose_drop))


def step(h: Array, R: Array, K: Coefficients) -> tuple[Array, Array, float]:
    """The layers after one step and what left through the foot.

    Parameters
    ----------
    h, R: static and rolling layer, lengths, shape (N,).
    K: coefficients with no term absent, of the scheme :class:`bcre_ca.schemes.SlopeDriven`.
    """
    scheme: Any = K.scheme
    fall = np.concatenate([[0.0], h[:-1] - h[1:], [0.0]])
    beyond = R[-1]
    if scheme.ends == OPEN:
        fall[-1] = K.repose_drop
    elif scheme.ends == JOINED:
        beyond = R[0]
        fall[0] = fall[-1] = h[-1] - (h[0] - K.repose_drop * h.size)
    flux = np.zeros(h.size + 1)
    flux[1:] = carried(R, np.append(R[1:], beyond), fall[1:], scheme.d, K)
    if scheme.ends == JOINED:
        flux[0] = flux[-1]
    exchange = eroded(R, fall[:-1], fall[1:], K)
    new = (R + ((flux[:-1] - flux[1:]) + exchange)) + scheme.supply
    return h - exchange, new, float(flux[-1] - flux[0])
