r"""Pulses released one after another at the same place, each when the one before has left.

After a pause the rolling layer is down to traces; the next pulse is added to it and the surface is
taken as it was left.
"""

from __future__ import annotations

import bcre_ca
import bcre_pde
from bcre_studies.models.automaton import rule_of
from bcre_studies.models.bcre import problem_of
from bcre_studies.observables.outcome import slope
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.scene import Scene

SOLVER_TOLERANCE = 1e-4
"""Local error per step: the steps are bounded by stability, the slope is read to three digits."""


def slopes_of_automaton(scene: Scene, pulses: int) -> list[float]:
    """Slope S after each of so many of the scene's pulses, ``scene.time.until`` apart."""
    h, pulse = scene.initial(scene.centres())
    pile = bcre_ca.Pile(h, pulse)
    rule, ends, time = rule_of(scene), scene.domain.ends, scene.time
    slopes = []
    for _ in range(pulses):
        (pile,) = bcre_ca.frames(pile, rule, [time.until], ends, time.step)
        slopes.append(slope(scene.centres(), pile.h))
        pile = bcre_ca.Pile(pile.h, pile.R + pulse)
    return slopes


def slopes_of_pde(scene: Scene, cells: int, pulses: int) -> list[float]:
    """Slope S after each pulse in BCRE on a grid of so many cells."""
    x, problem = scene.centres(cells), problem_of(scene)
    _, pulse = problem.initial(x)
    slopes = []
    for _ in range(pulses):
        solution = bcre_pde.solve(problem, [scene.time.until], cells, tolerance=SOLVER_TOLERANCE)
        slopes.append(slope(x, solution.h[-1]))
        problem = _next_problem(solution, pulse)
    return slopes


def _next_problem(solution: bcre_pde.Solution, pulse: Array) -> bcre_pde.Problem:
    """The same problem from where it has come to, with another pulse, on the same grid."""
    problem, h, R = solution.problem, solution.h[-1], solution.R[-1] + pulse
    foot = _foot(solution)

    def initial(x: Array) -> tuple[Array, Array]:
        return (h, R) if x.size == h.size else (x * 0 + foot, x * 0)

    return bcre_pde.Problem(initial, problem.material, problem.length, problem.ends)


def _foot(solution: bcre_pde.Solution) -> float:
    """h on an open foot: with kappa = 0 it stays, else by a parabola in u with u_x = 0 there."""
    problem = solution.problem
    end = solution.x[-1:] * 0 + problem.length
    if problem.material.kappa == 0:
        return float(problem.initial(end)[0][0])
    before, last = solution.u[-1, -2:]
    return float((9 * last - before) / 8 - problem.material.Sc * problem.length)
