r"""The second critical slope Sd, measured by growth at a fixed place in the full nonlinear codes.

A trace R = 1e-150 is released on an incline of slope S; where it was released it obeys

    ln R = a + sigma_abs t - (1/2) ln t        and Sd is the S at which sigma_abs = 0

(absolute instability). The trace stays so small that the surface does not feel it, so the
nonlinear code shows its linear range. In the frame weighted by its own spatial decay, R
diffuses with sqrt(D (D + v d)) in the automaton and with D in BCRE; that sets how far off the ends
must be.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.optimize import root_scalar

import bcre_ca
import bcre_pde
from bcre_ca.theory import max_stable_step, second_critical_excess
from bcre_pde.theory import second_critical_slope
from bcre_studies.observables.outcome import growth_rate
from bcre_studies.scenes.domain import Array

TRACE = 1e-150
"""The rolling layer released: ends above 1e-300 and far below the sizes that move the surface."""

REACH = 2.0
"""Distance of the ends in units of sqrt(4 D t): an echo is then weakened by e^(-16)."""

FOLDS = 20.0
"""The search starts where a trace changes by e^20 at most: no over- or underflow."""

CELL_PECLET = (1.0, 0.5, 0.25)
"""Cells of the PDE's three grids, v dx/D; R varies as e^(v x/2D) about the place of release."""


def upwind_rule(material: bcre_pde.Material, d: float) -> bcre_ca.Rule:
    """The paper's automaton with cells of length d and the usual step; v, D, gamma > 0."""
    v, D, gamma, Sc = _positive(material)
    dt = bcre_ca.MARGIN * max_stable_step(v, D, gamma, d)
    return bcre_ca.Rule(v, D, gamma, Sc, d, dt)


def calibrated_rule(material: bcre_pde.Material, d: float) -> bcre_ca.Rule:
    """The calibrated automaton with cells of length d, D_eff = D; v, D, gamma > 0.

    Its step is the usual part of the stable one; where that is too short for D_eff = D, one half
    way between the calibrating step, at which no diffusion of its own is left, and the stable one.
    """
    v, D, gamma, Sc = _positive(material)
    rule = bcre_ca.Rule(v, D, gamma, Sc, d, dt=1.0, scheme="calibrated")
    bound, least = rule.max_stable_step(), rule.calibrating_step()
    usual = bcre_ca.MARGIN * bound
    return replace(rule, dt=usual if usual > least else (least + bound) / 2)


def measure_sd_automaton(rule: bcre_ca.Rule) -> float:
    """Sd - Sc of an upwind or calibrated rule with diffusion left.

    Released in one cell. What sigma_abs leaves out is of order d^2/(16 D' t1 t2) with the weighted
    diffusion D' = sqrt(D (D + v d)): below 1e-4 of gamma (Sd - Sc) at the times taken here.
    """
    D, d, dt = rule.diffusion_left(), rule.d, rule.dt
    expected = second_critical_excess(rule.v, D, rule.gamma, d)
    diffusion = math.sqrt(D * (D + rule.v * d))
    late = max(8 / (rule.gamma * expected), 200 * d**2 / diffusion)
    steps = math.ceil(late / 2 / dt)
    reach = math.ceil(REACH * math.sqrt(4 * diffusion * 2 * steps * dt) / d)

    def rate(excess: float) -> float:
        h = -(rule.Sc + excess) * d * np.arange(2 * reach + 1)
        R = np.zeros_like(h)
        R[reach] = TRACE
        h, middle = bcre_ca.evolve(h, R, rule, steps)
        _, end = bcre_ca.evolve(h, middle, rule, steps)
        return growth_rate((steps * dt, 2 * steps * dt), (middle[reach], end[reach]))

    return _root(rate, expected, FOLDS / (rule.gamma * expected * late), 1e-7)


def measure_sd_pde(material: bcre_pde.Material) -> bcre_pde.Measured:
    """Sd - Sc of BCRE on three grids, with the finest one's convergence index; v, D, gamma > 0.

    Lengths are counted in D/v and times in D/v^2, the only ones there are. Released is a Gaussian
    of width w = D/v: a point release that happened w^2/(4 D) earlier and, as it has been carried
    since, D/(4 v) uphill of its centre. There and from then on it is observed.
    """
    v, D, gamma, Sc = _positive(material)
    expected = second_critical_slope(v, D, gamma, Sc) - Sc
    times = (16 * D / v**2, 32 * D / v**2)
    earlier = D / (4 * v**2)
    reach = REACH * math.sqrt(4 * D * times[1])

    def on_grid(peclet: float) -> float:
        half = math.ceil(reach / (peclet * D / v))
        place = (half + 0.5) * peclet * D / v
        centre = place + v * earlier

        def rate(excess: float) -> float:
            def initial(x: Array) -> tuple[Array, Array]:
                return -(Sc + excess) * x, TRACE * np.exp(-(((x - centre) * v / D) ** 2))

            problem = bcre_pde.Problem(initial, material, length=2 * place)
            solution = bcre_pde.solve(problem, times, 2 * half + 1)
            middle, late = solution.R[:, half]
            return growth_rate((times[0] + earlier, times[1] + earlier), (middle, late))

        return _root(rate, expected, FOLDS / (gamma * expected * times[1]), 1e-6)

    coarse, medium, fine = (on_grid(peclet) for peclet in CELL_PECLET)
    return bcre_pde.Measured(fine, bcre_pde.grid_convergence_index(fine, medium, coarse).error)


def _root(rate: Callable[[float], float], start: float, spread: float, relative: float) -> float:
    """Zero of the rate, by secants that start about ``start`` and end wherever it is."""
    spread = min(spread, 0.2)
    found = root_scalar(
        rate, method="secant", x0=(1 - spread) * start, x1=(1 + spread) * start, rtol=relative
    )
    if not found.converged:
        raise ArithmeticError(f"no slope at which R neither grows nor decays: {found.flag}")
    return float(found.root)


def _positive(material: bcre_pde.Material) -> tuple[float, float, float, float]:
    for name in ("v", "D", "gamma"):
        if not getattr(material, name) > 0:
            raise ValueError(f"{name} = {getattr(material, name)!r}: Sd needs a number > 0")
    return material.v, material.D, material.gamma, material.Sc
