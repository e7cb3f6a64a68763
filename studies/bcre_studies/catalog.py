"""The studies, in the order in which a reader should meet them.

Titles stand here so that listing the studies imports none of them.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, NamedTuple, Protocol, cast

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from bcre_studies.comparison.claim import Claim


class Entry(NamedTuple):
    """Where a study's module is, below ``bcre_studies``, and its title."""

    module: str
    title: str


STUDIES = {
    "paper_figures": Entry("validation.paper_figures.study", "The paper's figures in both models"),
    "repose_return": Entry("validation.repose_return.study", "Return to the angle of repose"),
    "roughness_decay": Entry("validation.roughness_decay.study", "Decay of roughness by mode"),
    "random_roughness": Entry(
        "validation.random_roughness", "Decay of random roughness over 32 seeds"
    ),
    "uphill_propagation": Entry(
        "validation.uphill_propagation.study", "Uphill propagation, one mechanism at a time"
    ),
    "second_critical_angle": Entry(
        "validation.second_critical_angle.study", "The second critical angle"
    ),
    "avalanche_extent": Entry(
        "validation.avalanche_extent", "What an avalanche moves: how much, how far, and when"
    ),
    "opening_angle": Entry(
        "validation.opening_angle.study", "The angle at which an avalanche opens on a plane"
    ),
    "poured_heap": Entry("validation.poured_heap.study", "Which flow rules keep a heap round?"),
    "plane_agreement": Entry(
        "validation.plane_agreement",
        "A pulse on a plane in both models: the direction of the cells' diffusion",
    ),
    "choices": Entry(
        "validation.choices", "Do the verdicts stand when our own choices are halved and doubled?"
    ),
    "modified_equation": Entry(
        "verification.modified_equation",
        "How much of the difference is the automaton's own diffusion?",
    ),
    "agreement_map": Entry(
        "validation.agreement_map.study", "Where in its parameters does the automaton agree?"
    ),
    "sensitivity": Entry("validation.sensitivity", "Which parameter moves which property?"),
    "avalanche_statistics": Entry(
        "validation.avalanche_statistics.study", "Avalanches under slow driving: is there a scale?"
    ),
    "printed_rule": Entry("validation.printed_rule.study", "The printed rule, read in every way"),
    "one_variable": Entry(
        "validation.one_variable", "Control: which properties need the second layer?"
    ),
    "which_model": Entry("validation.which_model.study", "Which model has which property?"),
    "quasi_static_limit": Entry(
        "validation.quasi_static_limit.study", "When does a scene need no rolling layer?"
    ),
    "order_of_accuracy": Entry(
        "verification.order_of_accuracy.study", "Observed order of accuracy on exact solutions"
    ),
    "error_estimate": Entry(
        "verification.error_estimate", "How often BCRE's own error estimate covers the true error"
    ),
    "speed_error": Entry("performance.speed_error", "Speed against error"),
    "scaling": Entry("performance.scaling", "Speed by size, and the real-time budget"),
    "scene_needs": Entry("performance.scene_needs.study", "What does a scene need?"),
    "stability": Entry(
        "verification.stability.study", "Where a step stops being stable, measured and predicted"
    ),
    "hard_cases": Entry(
        "verification.hard_cases.study", "Hard cases: what happens, and who says so"
    ),
    "advice": Entry(
        "performance.advice.study", "Does the advised model reach the tolerance, at the least cost?"
    ),
}


class Study(Protocol):
    """What every study module offers; its docstring gives what is measured and its equation."""

    __doc__: str | None

    def run(self) -> dict[str, pd.DataFrame]:
        """Measure: the table ``"comparison"``, and what the figure needs besides."""

    def judge(self, tables: dict[str, pd.DataFrame]) -> list[Claim]:
        """Conclude: the claims, with their verdicts."""

    def draw(self, tables: dict[str, pd.DataFrame]) -> Figure:
        """Show."""


def study(name: str) -> Study:
    """The study of that name, imported now."""
    return cast("Study", importlib.import_module(f"bcre_studies.{STUDIES[name].module}"))
