"""What a model must offer to be run, compared and offered by the command."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from bcre_pde import Measured
from bcre_studies.models.run import Run
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.scene import Scene, SceneError

Stop = Callable[[Run], bool]

FRAME_BYTES = 35
"""Memory a frame and cell: both layers while they are gathered, and the text they become."""

NOISE_BYTES = 800
"""Memory a cell while 32 sines are added up to a rough surface."""


class Adapter(ABC):
    """Runs scenes in one model.

    A new model needs :meth:`run`; the other methods serve ``bcre run`` and have defaults that suit
    a model on the scene's own cells.
    """

    refined = False
    """Whether :meth:`measured` refines a grid, so that what it returns has an error."""

    ends: tuple[str, ...] = ("open", "wall", "periodic")
    """The ends that the model admits."""

    admits: tuple[str, ...] = ("source", "Gamma")
    """What else of a scene it admits that not all models do."""

    def require_admitted(self, scene: Scene) -> None:
        """Raise :class:`SceneError` where the scene asks for what the model does not have."""
        if scene.domain.ends not in self.ends:
            raise SceneError(
                f"domain.ends = {scene.domain.ends!r}: must be one of {self.ends} in this model"
            )
        if scene.source and "source" not in self.admits:
            raise SceneError(
                f"source: {len(scene.source)} given; must be none, this model has no sources"
            )
        if scene.material.Gamma and "Gamma" not in self.admits:
            raise SceneError(f"material.Gamma = {scene.material.Gamma!r}: must be 0 in this model")

    @abstractmethod
    def run(
        self,
        scene: Scene,
        times: Sequence[float],
        cells: int | None = None,
        stop: Stop | None = None,
    ) -> Run:
        """The scene in this model, recorded at the given ascending times.

        Parameters
        ----------
        cells: the model's own grid; left out, the one that the scene asks for.
        stop: called with the run so far after every recorded time; True ends the run there.
        """

    @staticmethod
    def laid(scene: Scene, cells: int | None) -> tuple[Array, Array]:
        """Cell centres, and the surface with all that rolls at the start laid on it."""
        if cells is not None:
            scene.require_held(cells)
        x = scene.centres(cells)
        return x, np.sum(scene.initial(x), axis=0)

    def on(self, scene: Scene, cells: int) -> Scene:
        """The scene with this number of cells as what it asks for."""
        return scene.with_changes(cells=cells)

    def answer(
        self, scene: Scene, times: Sequence[float], earlier: Sequence[Run], stop: Stop
    ) -> Run:
        """What ``bcre run`` shows: as :meth:`run`, but refined where the model can be.

        Parameters
        ----------
        earlier: runs of the same scene in other models, which this one is compared with.

        Raises
        ------
        SceneError
            where the model fails; the text names the key of the scene that makes it fail.
        """
        return self.run(scene, times, stop=stop)

    def measured(
        self,
        scene: Scene,
        times: Sequence[float],
        measure: Callable[[Run], Sequence[Any]],
        allowed: Callable[[Sequence[Any]], Iterable[float]],
    ) -> list[Measured]:
        """Several quantities of this model's run, each with its error.

        A rule on cells of its own is what it is and has no error. A model that solves an equation
        is refined until the error of each quantity is as small as ``allowed`` asks, a function of
        the quantities so far.
        """
        return [Measured(value, 0.0) for value in measure(self.run(scene, times))]

    def require_runnable(self, scene: Scene) -> None:
        """Raise :class:`SceneError` where the scene cannot be run, or not within a working day.

        A floating-point error says the same of numbers that cannot be computed with.
        """
        thickest_layer(scene)

    def memory(self, scene: Scene, frames: int) -> int:
        """Bytes that :meth:`answer` takes beyond its libraries, to within a factor of two."""
        return scene.domain.cells * (frames * FRAME_BYTES + noise_bytes(scene))

    def note(self, scene: Scene) -> str:
        """What a user should know of this model on this scene; mostly nothing."""
        return ""


def noise_bytes(scene: Scene) -> int:
    """Bytes a cell that sampling the scene takes."""
    return NOISE_BYTES * any(term.kind == "noise" for term in scene.surface)


def thickest_layer(scene: Scene) -> float:
    """What R may come to: R0 e^(gamma (S - Sc) t), but no more than what lies above repose.

    A source adds what it pours while the layer drifts past it, or all of it where nothing drifts.
    """
    x = scene.centres()
    h, R = scene.initial(x)
    u, thickest = h + scene.material.Sc * x, float(R.max())
    for source in scene.source:
        span = max(min(scene.time.until, source.until) - source.start, 0.0)
        passing = source.width / scene.material.v if scene.material.v > 0 else span
        thickest += source.rate / source.width * min(span, passing)
    if x.size < 2:
        return thickest
    excess = max(float(-np.diff(u).min() / scene.d), 0.0)
    growth = min(scene.material.gamma * excess * scene.time.until, 700.0)
    return min(thickest * math.exp(growth), thickest + float(np.ptp(u)))


def refuse_endless(scene: Scene, model: str, steps: float, most: int) -> None:
    """Raise :class:`SceneError` where a run would take more than ``most`` steps."""
    if steps > most:
        until, step = scene.time.until, scene.time.step
        raise SceneError(
            f"time.until = {until!r} with time.step = {step!r}: would take {steps:.1g} steps of "
            f"the {model} with this material and grid; must take at most {most:.0g}"
        )
