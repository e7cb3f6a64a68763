"""Whether a small rough disturbance of a uniform layer grows, measured by stepping either model.

The layer is 1 on the repose line of a small periodic pile, d = dt = 1; R and u are disturbed by
seeded noise of 1e-8. It grows where, after the steps, the largest deviation is more than twice that
at the start and a fifth more than half-way, or :data:`FAR` times that at the start: where a wave
of R and one of u have nearly the same factor, the one drives the other for a while in a stable step
too, but not so far.
"""

from __future__ import annotations

from functools import cache

import numpy as np

import bcre_ca
from bcre_pde import Material
from bcre_pde.explicit import ExplicitMethod
from bcre_pde.fixed_step import take_fixed_steps
from bcre_studies.scenes.domain import Array
from bcre_studies.verification.stability.amplification import Numbers, Variant, rule_with

SIZE = 1e-8
"""Small enough for products of waves not to count, large enough for rounding not to."""

FAR = 1e4

STEPS = 600
CELLS = 32
CELLS_IN_PLACE = 96
"""Of the automaton. What grows along a sweep by 1 + e a cell needs a long row."""

PDE = (32, 200)
"""Cells and steps; its factors pass 1 steeply."""


@cache
def noise(cells: int) -> tuple[Array, Array]:
    """Deviations of u and R at the start: uniform in (-1, 1) times SIZE, of mean zero."""
    layers = SIZE * np.random.default_rng(2024).uniform(-1, 1, (2, cells))
    u, R = layers - layers.mean(axis=1, keepdims=True)
    return u, R


def automaton_grows(numbers: Numbers, variant: Variant) -> bool:
    """Whether it grows in the automaton with these numbers."""
    rule = rule_with(numbers, variant)
    cells = CELLS if rule.order == "synchronous" else CELLS_IN_PLACE
    u, disturbance = noise(cells)
    steady = _steady_layer(rule, cells)
    h, R = u.copy(), steady + disturbance

    def deviation() -> float:
        bcre_ca.march(h, R, rule, STEPS // 2, "periodic")
        return _largest(h, R - steady)

    with np.errstate(all="ignore"):
        return _grows(_largest(u, disturbance), deviation(), deviation())


def _steady_layer(rule: bcre_ca.Rule, cells: int) -> Array:
    """The layer of 1 that drift and diffusion leave as it is.

    A sweep begins in cell 0 or ends there, which therefore holds one flux f more than the others
    between two sweeps, or one less: f = c/(1 - q) downhill, c/(1 - b) uphill.
    """
    folded = rule.coefficients()
    c, b, q = folded.courant, folded.diffusion or 0.0, folded.outgoing
    layer = np.ones(cells)
    if rule.order == "right" and q < 1:
        layer[0] += c / (1 - q)
    if rule.order == "left" and b < 1:
        layer[0] -= c / (1 - b)
    return layer


def pde_grows(numbers: Numbers, method: ExplicitMethod) -> bool:
    """Whether it grows in BCRE with fixed steps of an explicit method, dx in the place of d."""
    cells, steps = PDE
    v, D, gamma = numbers
    material = Material(v, D, gamma, Sc=0.0)
    u, R = noise(cells)

    def steps_on(u: Array, R: Array) -> tuple[Array, Array]:
        return take_fixed_steps(material, u, R, 1.0, 1.0, steps // 2, method)

    with np.errstate(all="ignore"):
        half_way = steps_on(u, 1 + R)
        u_end, R_end = steps_on(*half_way)
        deviation = _largest(half_way[0], half_way[1] - 1)
        return _grows(_largest(u, R), deviation, _largest(u_end, R_end - 1))


def _largest(u: Array, R: Array) -> float:
    return float(np.maximum(np.abs(u).max(), np.abs(R).max()))  # NaN if either is


def _grows(start: float, half_way: float, end: float) -> bool:
    return not end <= max(min(1.2 * half_way, FAR * start), 2 * start)
