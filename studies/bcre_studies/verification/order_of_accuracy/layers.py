"""The exact solutions, and the layer R that each model makes of one at its last time."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

import bcre_ca
import bcre_pde
from bcre_ca.rule import Scheme
from bcre_pde import Method, exact
from bcre_studies.scenes.domain import Array

METHODS: tuple[Method, ...] = ("runge-kutta", "RK45", "DOP853", "LSODA", "BDF")
EXPLICIT = ("runge-kutta", "RK45", "DOP853")
TIME_TOLERANCE = {"explicit": 1e-13, "implicit": 1e-10}


@cache
def solutions() -> dict[str, exact.ExactSolution]:
    """The exact solutions, with parameters of order one."""
    found = (
        exact.rolling_mode(wavenumber=0.5, v=1.0, D=0.1),
        exact.surface_mode(wavenumber=0.5, gamma=0.5, kappa=0.0, v=1.0),
        exact.surface_mode(wavenumber=0.5, gamma=0.5, kappa=0.1, v=1.0),
        exact.frozen_slope_release(excess=0.6, v=1.0, D=0.3, gamma=0.2),
        exact.climbing_hump(v=1.0, gamma=0.5, height=0.3, width=1.5, length=20.0, until=2.0),
        exact.tilted_climbing_wave(excess=0.4, v=1.0, gamma=0.2, height=0.3, width=2.5),
        exact.steady_filling(w=0.1, v=1.0, gamma=0.2),
        exact.saturated_flow(amplitude=0.3, wavenumber=0.5, v=1.0, v_up=0.7),
    )
    return {_label(solution): solution for solution in found}


def _label(solution: exact.ExactSolution) -> str:
    kappa = solution.material.kappa
    return (
        f"{solution.name}, kappa = {kappa:g}" if solution.name == "surface mode" else solution.name
    )


def errors(solution: exact.ExactSolution, x: Array, R: Array) -> dict[str, float]:
    """L1, L2 and maximum error of R in the window, absolute; at the solution's last time."""
    inside = (x >= solution.window[0]) & (x <= solution.window[1])
    gap = np.abs(R - solution.layers(x, solution.until)[1])[inside]
    return {"L1": float(gap.mean()), "L2": float(np.sqrt((gap**2).mean())), "max": float(gap.max())}


def automaton_layer(
    solution: exact.ExactSolution, cells: int, share: float, scheme: Scheme = "upwind"
) -> tuple[Array, Array]:
    """Cell centres and R of the automaton at the last time; dt is a share of the stable step.

    That of the thick flow is :func:`thick_step`.
    """
    material, d = solution.material, solution.length / cells
    x = np.asarray((np.arange(cells) + 0.5) * d)
    pile = bcre_ca.Pile(*solution.layers(x, 0.0))
    rule = bcre_ca.Rule(
        material.v,
        material.D,
        material.gamma,
        material.Sc,
        d,
        dt=1.0,
        scheme=scheme,
        kappa=material.kappa,
        v_up=material.v_up,
    )
    if np.isfinite(material.v_up):
        steps = int(np.ceil(solution.until / (share * thick_step(pile, rule))))
        rule = replace(rule, dt=solution.until / steps)
        return x, bcre_ca.advance(pile, rule, steps, solution.ends).R
    rule = replace(rule, dt=share * bcre_ca.largest_stable_step(pile, rule, solution.ends))
    (end,) = bcre_ca.frames(pile, rule, [solution.until], solution.ends, rule.dt)
    return x, end.R


def thick_step(pile: bcre_ca.Pile, rule: bcre_ca.Rule) -> float:
    """Largest stable dt of a flow that is thick everywhere, gamma R >> v_up.

    A cell then loses v_up max(Sc - S, 0) whatever its layer, so that v dt/d + v_up dt max(Sc -
    S, 0)/min R <= 1 and v_up dt/d <= 1. :meth:`bcre_ca.Rule.max_stable_step` has gamma max(Sc -
    S, 0) instead, the loss of the thinnest layers, which must be allowed for where there are any.
    """
    slopes = -np.diff(pile.h) / rule.d
    loss = rule.v_up * max(rule.Sc - float(slopes.min()), 0.0) / float(pile.R.min())
    of_layer = 1 / (rule.v / rule.d + loss)
    return min(of_layer / 2 if rule.scheme == "limited" else of_layer, rule.d / rule.v_up)


def pde_layer(
    solution: exact.ExactSolution, cells: int, method: Method, tolerance: float | None = None
) -> tuple[Array, Array]:
    """Cell centres and R of the PDE at the last time, by default with next to no error in time."""
    if tolerance is None:
        tolerance = TIME_TOLERANCE["explicit" if method in EXPLICIT else "implicit"]
    end = bcre_pde.solve(
        solution.problem, [solution.until], cells, method=method, tolerance=tolerance
    )
    return end.x, end.R[-1]
