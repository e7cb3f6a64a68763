"""What the advice is held against: BCRE, refined until its own error no longer counts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from bcre_studies.advisor.advise import Advice, Effort, advise
from bcre_studies.advisor.deviation import deviation, uncertainty
from bcre_studies.advisor.pilot import run_model
from bcre_studies.advisor.question import Question
from bcre_studies.models.registry import BCRE
from bcre_studies.models.run import Run, frame_times
from bcre_studies.scenes.scene import Scene
from bcre_studies.timing.costs import recorded

TOLERANCE = 0.05
FRAMES = 3
TRUTH = 0.05
"""The true solution's own error may be this part of the tolerance."""
COARSEST_TRUTH, FINEST_TRUTH = 100, 1600
OBSERVED = ("R", "h")
PILOTS_S = 3.0
"""Seconds of pilots a scene, by the recorded costs."""

Row = dict[str, Any]


@dataclass(frozen=True)
class Truth:
    """BCRE on doubled grids, coarsest first, the last fine enough to judge by if any is."""

    runs: tuple[Run, ...]

    @property
    def run(self) -> Run:
        """The finest."""
        return self.runs[-1]

    def error(self, observable: str) -> float:
        """Its own error, relative."""
        return uncertainty(self.runs, observable)

    def resolved(self, observable: str) -> bool:
        """Whether others can be judged by it."""
        return self.error(observable) <= TRUTH * TOLERANCE


def truth(scene: Scene) -> Truth:
    """BCRE on doubled grids until all that is observed is resolved, or the finest is reached."""
    times = frame_times(scene, FRAMES)
    cells = COARSEST_TRUTH
    runs = [run_model(scene, BCRE.name, times, n) for n in (cells, 2 * cells)]
    while True:
        cells = 2 * runs[-1].x.size
        runs.append(run_model(scene, BCRE.name, times, cells))
        found = Truth(tuple(runs))
        if cells >= FINEST_TRUTH or all(map(found.resolved, OBSERVED)):
            return found


def error_of(scene: Scene, model: str, cells: int, true: Truth, observable: str) -> float:
    """The true error of a model on so many cells."""
    run = run_model(scene, model, frame_times(scene, FRAMES), cells)
    return deviation(run, true.run, observable)


def advice_on(scene: Scene, observable: str, **effort: Any) -> Advice:
    return advise(
        Question(scene, TOLERANCE, observable, frames=FRAMES),
        Effort(recorded(), clocked=False, seconds=PILOTS_S, **effort),
    )
