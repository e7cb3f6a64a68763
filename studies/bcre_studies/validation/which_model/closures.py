"""R(x) of each closure's automaton beside its model, as it stands and with the cells counted in."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, cast

import bcre_pde
from bcre_ca import theory
from bcre_pde.line.hadeler_kuttler import HadelerKuttler as Equation
from bcre_studies.comparison.difference import relative_difference
from bcre_studies.comparison.rounding import significant
from bcre_studies.comparison.verdict import verdict_of
from bcre_studies.models.aradian import thick_flow
from bcre_studies.models.bcre import SHARE, run_of, solver_options
from bcre_studies.models.effective import effective
from bcre_studies.models.hadeler_kuttler import HadelerKuttler, SlopeDrivenAutomaton
from bcre_studies.models.registry import BCRE
from bcre_studies.models.run import Run
from bcre_studies.observables.outcome import slope
from bcre_studies.scenes.scene import Scene, load
from bcre_studies.validation.which_model.properties import SUBJECTS, Row, Subject

if TYPE_CHECKING:
    from bcre_studies.models.automaton import Automaton

TOLERANCE = 0.05
SCENES = {"figure1": 180.0, "figure3": 10.0}
"""When R(x) is compared."""

EARLIER = {("D = 0", "figure1"): 90.0, ("Hadeler-Kuttler", "figure1"): 10.0}
"""Where no front climbs the layer has left figure 1 by t = 180: it is compared on its way."""

FINER = (4, 8)
"""Cells of the model over those of the automaton."""

CLOSURES = tuple(dict.fromkeys(subject.closure for subject in SUBJECTS if subject.closure))

Solve = Callable[[int], Run]


def pair(closure: str) -> tuple[Subject, Subject]:
    """The model and the automaton of a closure."""
    model, rule = (subject for subject in SUBJECTS if subject.closure == closure)
    return model, rule


def profile(case: tuple[str, str]) -> Row:
    """The difference of R from the model, and from the model with the automaton's own terms."""
    closure, name = case
    model, rule = pair(closure)
    scene, until = load(name).with_changes(**rule.changes), EARLIER.get(case, SCENES[name])
    scene = scene.with_changes(step=_step(rule, scene))
    x, own = scene.centres(), rule.model.run(scene, [until]).R[-1]

    def nominal(cells: int) -> Run:
        return model.model.run(scene, [until], cells)

    gaps = []
    for solve in (nominal, with_cells(closure, scene, until)):
        coarse, fine = (solve(factor * x.size).sample(x) for factor in FINER)
        gap = relative_difference(own, fine)
        gaps.append((gap, relative_difference(coarse, fine) <= SHARE * max(gap, TOLERANCE)))
    (gap, resolved), (left, resolved_left) = gaps
    return {
        "closure": closure,
        "scene": name,
        "t": until,
        "difference": significant(gap, 2),
        "difference_effective": significant(left, 2),
        "verdict": str(verdict_of(gap, resolved, left, resolved_left, TOLERANCE)),
    }


def _step(rule: Subject, scene: Scene) -> float:
    """dt = d as in the paper, or the automaton's largest step where that is shorter."""
    automaton = cast("Automaton", rule.model.adapter())
    return min(scene.d, automaton.rule(scene).dt)


def with_cells(closure: str, scene: Scene, until: float) -> Solve:
    """The model with the automaton's D_eff and, where it has the term, kappa_eff.

    Of a thick flow they are those under the layer that lies everywhere at the start; of Hadeler and
    Kuttler's model D_eff is that of the speed on the initial slope.
    """
    if closure != "Hadeler-Kuttler":
        changed = effective(thick_flow(scene) if closure == "Aradian" else scene)
        return lambda cells: BCRE.run(changed, [until], cells)
    rule, x = SlopeDrivenAutomaton().rule(scene), scene.centres()
    speed = rule.beta * slope(x, scene.initial(x)[0])
    D = theory.effective_diffusion(speed, 0.0, rule.d, rule.dt)
    problem = HadelerKuttler().problem(scene)
    spreading = replace(problem, material=replace(problem.material, D=D))

    def solve(cells: int) -> Run:
        options = solver_options(scene)
        return run_of(
            scene, bcre_pde.solve(spreading, [until], cells, equation=Equation, **options)
        )

    return solve
