"""Whether a scene needs a rolling layer at all: the isotonic step and its error.

The quasi-static limit (``bcre_pde.line.prigozhin_zaltzman``) follows the surface alone. It is near
BCRE where eps and tau are small (``observables.rolling_share``); how near is measured against the
reference, at every recorded time, since two models may part on the way and rest alike in the end.
"""

from __future__ import annotations

import statistics
from dataclasses import dataclass

from bcre_studies.advisor.deviation import deviation
from bcre_studies.advisor.pilot import Reference
from bcre_studies.advisor.question import Question
from bcre_studies.models.registry import QUASI_STATIC
from bcre_studies.observables.rolling_share import smallness, surface_error

OF_THE_LAYER = ("R", "front")
"""Observables that say nothing without a rolling layer."""

TIMED = 3
"""Runs whose median time counts."""


@dataclass(frozen=True)
class WithoutLayer:
    """The isotonic steps on the scene's own cells.

    Parameters
    ----------
    eps, tau: of the reference.
    error: the larger of that of the observable and that of the surface at any recorded time.
    seconds: of all recorded times.
    """

    cells: int
    eps: float
    tau: float
    error: float
    seconds: float


def without_layer(question: Question, against: Reference) -> WithoutLayer | None:
    """The isotonic steps where they meet the request, or None.

    They are no answer to a question about the layer, nor where the ends are joined, between which
    nothing but a level u can stand.
    """
    scene = question.scene
    if question.observable in OF_THE_LAYER or scene.domain.ends == "periodic":
        return None
    runs = [QUASI_STATIC.run(scene, question.times) for _ in range(TIMED)]
    error = max(
        deviation(runs[0], against.run, question.observable), surface_error(runs[0], against.run)
    )
    if not error + against.error <= question.tolerance:
        return None
    seconds = statistics.median(run.wall_s for run in runs)
    return WithoutLayer(scene.domain.cells, *smallness(against.run), error, seconds)
