r"""Closed forms of the automaton on a plane: what the rule does there, with pencil and paper.

On a frozen slope S of a tilted plane, with sigma = gamma (S - Sc), the rule is linear, and one step
multiplies R(i, j) = e^(m i + n j) by

    1 + dt [ sigma - (v/d)(1 - e^-m) + (2 D/d^2)(cosh m - 1) + (2 D_across/d^2)(cosh n - 1) ]

(insert it). All else on frozen slopes follows from the bracket.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from scipy.optimize import brentq, minimize_scalar

from bcre_ca.exchange import exchanging
from bcre_ca.plane.setting import Plane

OUTGOING = {"tilted": 1.0, "split4": 2.0, "facet8": 1.0, "d8": 1.0}
"""Largest sum of the parts of v dt/d that leave a cell, and of those that a rise of its h takes."""


class Edge(NamedTuple):
    """The edge of an avalanche: e^(along x - across y) is steady there, y = x tan(theta) on it.

    ``theta`` in degrees, ``along`` and ``across`` in 1/length. ``parting`` is by how much faster
    what comes from below fades uphill, e^(-parting x) of it is left; 0 from Sd on, where sand grows
    at every place.
    """

    theta: float
    along: float
    across: float
    parting: float


def edge(v: float, D: float, D_across: float, sigma: float, d: float) -> Edge:
    r"""The edge of an avalanche below its start, and the steady wave that makes it.

    N(i, j), all the sand that ever passed cell (i, j), is the sum of R over the steps. Summed, a
    step says that the bracket above, as an operator, takes N to minus the sand released: dt falls
    out, and the angle is that of any stable step. Away from the start N is made of the solutions
    e^(m i - n j) of bracket = 0. With Pe = v d/D, Sig = sigma d^2/D and a = D_across/D that is

        4 a sinh^2(n/2) = q(m) = Pe (1 - e^-m) - 2 (cosh m - 1) - Sig
        n(m) = 2 asinh( (1/2) sqrt(q(m)/a) ).

    Along the ray at the angle theta, i = r cos theta and j = r sin theta, the integral over m is
    governed by its saddle, where m cos theta - n(m) sin theta is least over m. The edge is where
    N neither grows nor decays along the ray, where that least value is 0:

        cot theta = max over m of n(m)/m,   q(m) > 0.

    n rises up to m = (1/2) ln(1 + Pe), where q is largest, and 1/m falls, so that the maximum lies
    between the first root of q and there. Where q is positive nowhere the slope is Sd or more, the
    Sd of the line, and sand grows at every place. As d -> 0 this becomes
    tan^2 theta = (D_across/D)(S - Sc)/(Sd - S), with Sd - Sc = v^2/(4 D gamma).

    Parameters
    ----------
    v, D, D_across: drift and diffusion along and across, > 0 but v.
    sigma: gamma (S - Sc), 1/time, > 0.
    d: cell length.
    """
    for name, value in (("D", D), ("D_across", D_across), ("sigma", sigma), ("d", d)):
        if not value > 0:
            raise ValueError(f"{name} = {value!r}: must be > 0 for an avalanche to have an edge")
    peclet, growth, ratio = v * d / D, sigma * d**2 / D, D_across / D

    def q(m: float) -> float:
        return -peclet * math.expm1(-m) - 4 * math.sinh(m / 2) ** 2 - growth

    def across(m: float) -> float:
        return 2 * math.asinh(math.sqrt(max(q(m), 0.0) / ratio) / 2)

    steepest = math.log1p(peclet) / 2
    if q(steepest) <= 0:
        return Edge(90.0, steepest / d, 0.0, 0.0)
    root = brentq(q, 0.0, steepest, xtol=1e-300, rtol=1e-15)
    found = minimize_scalar(
        lambda m: -across(m) / m,
        bounds=(root, steepest),
        method="bounded",
        options={"xatol": 1e-13},
    )
    theta = math.degrees(math.atan2(1.0, -found.fun))
    return Edge(theta, found.x / d, across(found.x) / d, 2 * (steepest - found.x) / d)


def opening_angle(v: float, D: float, D_across: float, sigma: float, d: float) -> float:
    """Half the angle at which an avalanche opens, in degrees; 90 from Sd on. See :func:`edge`."""
    return edge(v, D, D_across, sigma, d).theta


def opening_angle_on(plane: Plane, slope: float) -> float:
    """:func:`opening_angle` of a tilted plane's own rule at the slope ``slope``."""
    if plane.flow != "tilted":
        raise ValueError(f"flow = {plane.flow!r}: the opening angle is that of 'tilted'")
    rule = plane.rule
    sigma = rule.gamma * (slope - rule.exchange_slope())
    return opening_angle(rule.v, rule.D, plane.across, sigma, rule.d)


def max_stable_step(plane: Plane, largest_R: float = 0.0, deficit: float = 0.0) -> float:
    r"""Largest dt that keeps R >= 0 and the surface wave stable.

    R: what leaves a cell must not exceed what is there,

        ( w v/d + 2 (D + D_across)/d^2 + gamma max(Sc - S, 0) ) dt <= 1,

    with w the largest sum of the parts that flow: 1 along x, and on a facet, where it is cos alpha;
    for ``split4`` sum(q)/sqrt(sum q^2), which is 2 on a peak with four equal sides.

    h: raising one cell by e raises what is eroded there by gamma R dt w e/d, the derivative of
    gamma R S by h, which must not exceed e: w gamma R dt/d <= 1. On a facet S changes by
    cos alpha - sin alpha and at most by 1, on ``split4`` by sum(q)/sqrt(sum q^2) again.

    Parameters
    ----------
    largest_R: largest rolling layer, a length.
    deficit: largest max(Sc - S, 0), a slope.
    """
    rule, w = plane.rule, OUTGOING[plane.flow]
    saturation = rule.gamma / rule.v_up if math.isfinite(rule.v_up) else None
    X = float(exchanging(largest_R, saturation))
    of_layer = (
        w * rule.v / rule.d
        + 2 * (rule.D + plane.across) / rule.d**2
        + rule.gamma * max(deficit, 0.0)
    )
    of_wave = w * rule.gamma * X / rule.d
    fastest = max(of_layer, of_wave)
    return 1 / fastest if fastest > 0 else math.inf


def silo_layer(v: float, rise: float, radius: float, r: float) -> float:
    """R = w (a^2 - r^2)/(2 v r) in a round silo of radius a that fills at the rate w from its axis.

    The sand that comes to rest beyond r, w pi (a^2 - r^2) a unit of time, crosses r as
    2 pi r v R.
    """
    return rise * (radius**2 - r**2) / (2 * v * r)


def rill_growth(
    v: float, D: float, gamma: float, S: float, Sc: float, R0: float, d: float, k: float
) -> float:
    """Growth rate l > 0 of ripples of wavenumber k across an even sheet R0 that erodes, on
    ``split4``.

    Let h = -S x + a e^(l t) cos k y and R = R0 + b e^(l t) cos k y, for times in which the sheet
    grows little, and sigma = gamma (S - Sc). To first order S does not change; sand runs aside at
    v R0/S times the slope across, which gathers it in the furrows, and they erode faster:

        l b = (sigma - D K) b - (v R0/S) K a,   l a = -sigma b,   K = 2 (1 - cos k d)/d^2

    so that l^2 + l (D K - sigma) - sigma v R0 K/S = 0. Without D it grows the faster the shorter
    the wave: the continuous problem is ill posed and the cells choose the rills.
    """
    sigma, K = gamma * (S - Sc), 2 * (1 - math.cos(k * d)) / d**2
    half = (D * K - sigma) / 2
    return math.sqrt(half**2 + sigma * v * R0 * K / S) - half
