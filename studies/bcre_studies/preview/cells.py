r"""How many cells the automaton needs for an error of 5 % in R, by a closed form.

On a frozen slope both models have the same formula (``advisor.closed_forms``), BCRE with D and the
upwind automaton, to first order, with D_eff = D + (v d/2)(1 - v dt/d). The difference of the two is
the automaton's error. It is known here where the slope stays as it was,

    gamma t max|S(t) - S(0)| <= 0.1    and    |gamma (S - Sc)| t <= 0.3,

beyond which growth multiplies what D_eff leaves out.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bcre_studies.advisor.closed_forms import ClosedForm, closed_form
from bcre_studies.comparison.difference import relative_difference
from bcre_studies.models.automaton import rule_of
from bcre_studies.preview.numbers import numbers_of
from bcre_studies.scenes.scene import Scene

TOLERANCE = 0.05
FROZEN, GROWTH = 0.1, 0.3
POINTS = 4000
"""Where the two formulas are compared."""

MOST = 1_000_000
"""Cells beyond which nobody would go."""

LEAST_LEFT = 1e-6
"""Of a layer that has left the domain no error is asked."""


def cells_needed(scene: Scene, tolerance: float = TOLERANCE) -> int | str:
    """Fewest cells of the upwind automaton, with the step "auto"; or why they are not known."""
    if scene.automaton.scheme != "upwind":
        return f"there is none for the scheme {scene.automaton.scheme!r}"
    form = closed_form(scene)
    if form is None or form.name != "frozen slope":
        return "there is none for this scene"
    if why := _moves(scene, form):
        return why
    rule, numbers = rule_of(scene), numbers_of(scene)

    def suffice(cells: int) -> bool:
        finer = replace(rule, d=scene.domain.length / cells)
        step = finer.max_stable_step(numbers.largest_R, numbers.slope[1])
        D_eff = replace(finer, dt=min(step, scene.time.until)).effective_diffusion()
        return _error(scene, form, D_eff) <= tolerance

    low, high = 0, MOST
    if not suffice(MOST):
        return f"more than {MOST:,} cells"
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if suffice(middle) else (middle, high)
    return high


def _moves(scene: Scene, form: ClosedForm) -> str:
    """Why the slope is not frozen, or why nothing is left to have an error; else nothing."""
    m, t = scene.material, scene.time.until
    x = scene.centres(POINTS)
    before, released = form.layers(x, 0.0)
    after, left = form.layers(x, t)
    if not left.mean() > LEAST_LEFT * released.mean():
        return "the layer has left the domain by the end"
    bent = float(np.abs(np.gradient(after - before, x)).max())
    excess = float(-np.gradient(before, x).mean()) - m.Sc
    if m.gamma * t * bent > FROZEN:
        return "the layer is thick enough to change the slope that it runs on"
    if abs(m.gamma * excess) * t > GROWTH:
        return "the layer grows or shrinks too much on its way"
    return ""


def _error(scene: Scene, form: ClosedForm, D_eff: float) -> float:
    """Relative L1 difference of R at the end between D_eff and D."""
    x, t = scene.centres(POINTS), scene.time.until
    counted = closed_form(scene.with_changes(D=D_eff))
    assert counted is not None
    return relative_difference(counted.layers(x, t)[1], form.layers(x, t)[1])
