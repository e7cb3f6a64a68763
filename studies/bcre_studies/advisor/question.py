"""What is asked of a scene: an observable to a tolerance, or as near as a time per frame lets."""

from __future__ import annotations

import math
from dataclasses import dataclass

from bcre_studies.advisor.deviation import posed
from bcre_studies.models.run import frame_times
from bcre_studies.scenes.scene import Scene


def seconds_of(text: str) -> float:
    """Seconds of a time such as "16ms", "0.016s" or "0.016".

    Raises
    ------
    ValueError
        for anything else.
    """
    unit = 1e-3 if text.endswith("ms") else 1.0
    try:
        seconds = float(text.removesuffix("ms").removesuffix("s")) * unit
    except ValueError:
        seconds = math.nan
    if not 0 < seconds < math.inf:
        raise ValueError(f"--budget = {text!r}: must be a time > 0 such as 16ms, 0.016s or 0.016")
    return seconds


@dataclass(frozen=True)
class Question:
    """What is asked of a scene.

    Parameters
    ----------
    tolerance: largest relative error of the observable, between 0 and 1.
    observable: one of ``deviation.OBSERVABLES``.
    budget: seconds per frame; given, the most accurate model that holds it is wanted.
    frames: as of ``bcre run``: times from 0 to the end, frames - 1 of them to be computed.

    Raises
    ------
    ValueError
        naming key, value and what is allowed.
    """

    scene: Scene
    tolerance: float = 0.05
    observable: str = "R"
    budget: float | None = None
    frames: int = 11

    def __post_init__(self) -> None:
        if not 0 < self.tolerance < 1:
            raise ValueError(f"--tolerance = {self.tolerance!r}: must lie between 0 and 1")
        if self.observable not in posed(self.scene):
            allowed = ", ".join(posed(self.scene))
            raise ValueError(
                f"--observable = {self.observable!r}: must be one of {allowed} in this scene"
            )
        if self.budget is not None and not 0 < self.budget < math.inf:
            raise ValueError(f"--budget = {self.budget!r}: must be a time > 0 in seconds")

    @property
    def times(self) -> list[float]:
        """When the runs are recorded."""
        return frame_times(self.scene, self.frames)

    @property
    def whole_time(self) -> float:
        """Seconds that the whole run may take; infinite without a budget."""
        return math.inf if self.budget is None else self.budget * (self.frames - 1)
