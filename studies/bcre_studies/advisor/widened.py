"""Advice past a scarp: against BCRE with a curvature term that gives the scarp a width.

With kappa = 0 the climbing wave steepens into a jump of h. Past it BCRE hardly converges, so that
there is nothing that a model could be near to. The reference is then BCRE with

    kappa = gamma d/2

the curvature that the scene's own cells add to the automaton (``bcre_ca.theory``).
"""

from __future__ import annotations

from dataclasses import replace

from bcre_studies.advisor.advise import Advice, Effort, advise
from bcre_studies.advisor.question import Question


def advise_with_reference(question: Question, effort: Effort) -> Advice:
    """:func:`advise`, and where a scarp leaves BCRE unresolved, again with kappa = gamma d/2."""
    advice = advise(question, effort)
    if not advice.needs_width:
        return advice
    kappa = question.scene.material.gamma * question.scene.d / 2
    widened = replace(question, scene=question.scene.with_changes(kappa=kappa))
    again = advise(widened, effort)
    return replace(again, instead_of=advice, pilots_s=advice.pilots_s + again.pilots_s)
