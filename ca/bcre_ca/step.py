r"""One step of the automaton, in plain NumPy: the executable definition of the rule.

With h the static and R the rolling layer, x running downhill and dh = h(i+1) - h(i),

    F(i)  = v R(i) - D (R(i+1) - R(i))/d               flux from cell i to cell i+1
    E(i)  = gamma R(i) ((h(i) - h(i+1))/d - Sc)        eroded from h, added to R
    R(i) += dt/d (F(i-1) - F(i)) + dt E(i)
    h(i) -= dt E(i)

(equations 2 to 6 of the paper, with dt and d restored). The synchronous rule reads everything
from the old state; the in-place rules visit the cells one after the other and read what they find.

Ends: ``"open"`` has a closed top (no flux into cell 0) and an open foot, where R leaves by
advection and the surface goes on at the repose slope, so that nothing is exchanged in the last
cell but by curvature. ``"periodic"`` joins the ends in R and in the height above the repose line,
u = h + Sc x.

A calibrated rule, a curvature term and a saturated exchange change what is eroded
(:mod:`bcre_ca.exchange`) and the coefficients (:mod:`bcre_ca.coefficients`), not the step; the
flux-limited rule has a step of its own (:mod:`bcre_ca.limited`).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bcre_ca import limited
from bcre_ca.exchange import carried, eroded, settle
from bcre_ca.rule import Ends, Rule

Array = NDArray[np.float64]


def step(h: Array, R: Array, rule: Rule, ends: Ends = "open") -> tuple[Array, Array, float]:
    """One step of the rule; no judgement of its stability.

    Parameters
    ----------
    h, R: static and rolling layer at the N cell centres, lengths, shape (N,).
    rule: the automaton's parameters.
    ends: ``"open"`` or ``"periodic"``.

    Returns
    -------
    h, R: the new layers, shape (N,).
    outflow: what left through the foot, in units of R (times d: an area).
    """
    if rule.scheme == "limited":
        fall = period_drop(rule, h.size) if ends == "periodic" else None
        return limited.step(h, R, rule.coefficients(), fall)
    if rule.order == "synchronous":
        return _synchronous(h, R, rule, ends)
    return _in_place(h, R, rule, ends)


def _synchronous(h: Array, R: Array, rule: Rule, ends: Ends) -> tuple[Array, Array, float]:
    c, b, q, k, s, a, m, u, dry = rule.coefficients()
    if ends == "periodic":
        R_next = np.append(R[1:], R[0])
        h_next = np.append(h[1:], h[0] - period_drop(rule, h.size))
        flux_out = carried(R, R_next, q, b)
        flux_in = np.append(flux_out[-1], flux_out[:-1])
        drop = (h - h_next) - s
        exchange = eroded(R, drop, np.append(drop[-1], drop[:-1]) - drop, k, a, m, u)
        outflow = 0.0
    else:
        flux_out = np.append(carried(R[:-1], R[1:], q, b), c * R[-1])
        nothing = R.dtype.type(0)
        flux_in = np.append(nothing, flux_out[:-1])
        drop = (h[:-1] - h[1:]) - s
        bend = np.append(nothing, drop[:-1] - drop[1:])[: drop.size]
        above = drop[-1] if drop.size else nothing
        at_foot = eroded(R[-1], 0.0, above, k, a, m, None)
        exchange = np.append(eroded(R[:-1], drop, bend, k, a, m, u), at_foot)
        outflow = float(flux_out[-1])
    h, R = settle(h - exchange, R + ((flux_in - flux_out) + exchange), dry)
    return h, R, outflow


def _in_place(h: Array, R: Array, rule: Rule, ends: Ends) -> tuple[Array, Array, float]:
    K = rule.coefficients()
    c, b, q, k, s = K[:5]
    h, R, last = h.copy(), R.copy(), h.size - 1
    outflow = 0.0
    for i in range(last + 1) if rule.order == "right" else range(last, -1, -1):
        if i < last:
            flux = carried(R[i], R[i + 1], q, b)
            exchange = eroded(R[i], (h[i] - h[i + 1]) - s, 0.0, k, None, None, None)
            R[i + 1] += flux
        elif ends == "periodic":
            flux = carried(R[i], R[0], q, b)
            drop = (h[i] - (h[0] - period_drop(rule, h.size))) - s
            exchange = eroded(R[i], drop, 0.0, k, None, None, None)
            R[0] += flux
        else:
            flux, exchange = c * R[i], 0.0
            outflow = float(flux)
        R[i] += exchange - flux
        h[i] -= exchange
    h, R = settle(h, R, K.dry)
    return h, R, outflow


def period_drop(rule: Rule, cells: int) -> float:
    """Fall of the repose line over one period, Sc N d: a periodic h repeats up to this."""
    return rule.Sc * rule.d * cells
