r"""One step of the automaton in plain NumPy: the executable definition of the rule.

With h the static and R the rolling layer, x running downhill and cells of length d,

    F(i)  = v R(i) - D (R(i+1) - R(i))/d               flux from cell i to cell i+1
    E(i)  = gamma R(i) ((h(i) - h(i+1))/d - Sc)        eroded from h, added to R
    R(i) += dt/d (F(i-1) - F(i)) + dt E(i)
    h(i) -= dt E(i)

(equations 2 to 6 of the paper, with dt and d restored). The synchronous rule reads only the old
state. The in-place rules visit the cells one after the other and read what they find.

Open ends are a closed top, with no flux into cell 0, and an open foot: there R leaves by advection,
and the surface goes on at the repose slope, so that only its curvature erodes the last cell.
Periodic ends join R, and the height above the repose line h + Sc x.

Calibration, curvature and thick flows change what is eroded and carried (:mod:`bcre_ca.exchange`)
and the coefficients (:mod:`bcre_ca.coefficients`), not the step. The limited scheme has a step of
its own (:mod:`bcre_ca.line.second_order`), and so have lines with sources and walls
(:mod:`bcre_ca.line.container`) and a layer that the slope drives
(:mod:`bcre_ca.line.slope_driven`).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bcre_ca.coefficients import fold
from bcre_ca.exchange import carried, deposit_thin, eroded, eroded_at_foot, leaving
from bcre_ca.gate import numbers_of, require_kind
from bcre_ca.line import container, second_order, slope_driven
from bcre_ca.line.drops import drops, period_drop
from bcre_ca.line.pile import line_of, require_ends
from bcre_ca.rule import Ends, Rule
from bcre_ca.schemes import InContainer, SlopeDriven

Array = NDArray[np.float64]


def step(
    h: Array,
    R: Array,
    rule: Rule,
    ends: Ends = "open",
    frozen: Array | None = None,
    supply: Array | None = None,
) -> tuple[Array, Array, float]:
    """One step of the rule, stable or not.

    Parameters
    ----------
    h, R: static and rolling layer at the N cell centres, lengths, shape (N,).
    rule: the automaton's parameters.
    ends: ``"open"``, ``"wall"`` or ``"periodic"``.
    frozen: a surface whose slope the exchange sees instead of that of h; synchronous upwind only.
    supply: what sources pour into each cell, length/time, shape (N,).

    Returns
    -------
    h, R: the new layers, shape (N,).
    outflow: what left through the foot, in units of R (times d: an area).

    Raises
    ------
    ValueError
        naming the argument, where it is not what is asked for.

    >>> rule = Rule(v=1.0, D=0.0, gamma=0.1, Sc=0.5, d=1.0, dt=0.5)
    >>> step(np.array([3.0, 2.0, 1.5]), np.array([0.0, 1.0, 0.0]), rule)
    (array([3. , 2. , 1.5]), array([0. , 0.5, 0.5]), 0.0)
    """
    require_kind("rule", rule, Rule)
    require_ends(ends)
    h, R = line_of(h, R)
    if frozen is not None:
        rule.require_upwind("a frozen slope")
        frozen, _ = line_of(frozen, R)
    if supply is not None:
        supply = numbers_of("supply", supply)
        if supply.shape != h.shape:
            raise ValueError(f"supply has shape {supply.shape}: must be that of h, {h.shape}")
    p = container.parameters_of(rule, ends, h.size, supply)
    if isinstance(p.scheme, SlopeDriven):
        return slope_driven.step(h, R, fold(p, float(rule.dt)))
    if isinstance(p.scheme, InContainer):
        return container.step(h, R, fold(p, float(rule.dt)))
    if rule.scheme == "limited":
        return second_order.step(h, R, rule.coefficients(), period_drop(rule, h.size, ends))
    if rule.order == "synchronous":
        return _synchronous(h, R, rule, ends, h if frozen is None else frozen)
    return _in_place(h, R, rule, ends)


def _synchronous(
    h: Array, R: Array, rule: Rule, ends: Ends, surface: Array
) -> tuple[Array, Array, float]:
    K = rule.coefficients()
    above, below = drops(surface, K.repose_drop, period_drop(rule, h.size, ends))
    flux_out = carried(R, np.append(R[1:], R[0]), K)
    exchange = eroded(R, below, above - below, K)
    flux_in = np.append(flux_out[-1], flux_out[:-1])
    outflow = 0.0
    if ends == "open":
        flux_in[0], flux_out[-1] = 0.0, leaving(R[-1], K)
        exchange[-1] = eroded_at_foot(R[-1], above[-1], K)
        outflow = float(flux_out[-1])
    h, R = deposit_thin(h - exchange, R + ((flux_in - flux_out) + exchange), R, K.dry, K.emptying)
    return h, R, outflow


def _in_place(h: Array, R: Array, rule: Rule, ends: Ends) -> tuple[Array, Array, float]:
    K, last = rule.coefficients(), h.size - 1
    R_before, h, R, outflow = R, h.copy(), R.copy(), 0.0
    for i in range(last + 1) if rule.order == "right" else range(last, -1, -1):
        if i == last and ends == "open":
            flux, exchange = K.courant * R[i], 0.0
            outflow = float(flux)
        else:
            h_below = h[i + 1] if i < last else h[0] - rule.Sc * rule.d * h.size
            flux = carried(R[i], R[(i + 1) % h.size], K)
            exchange = eroded(R[i], (h[i] - h_below) - K.repose_drop, 0.0, K)
            R[(i + 1) % h.size] += flux
        R[i] += exchange - flux
        h[i] -= exchange
    h, R = deposit_thin(h, R, R_before, K.dry, K.emptying)
    return h, R, outflow
