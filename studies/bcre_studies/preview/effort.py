"""What a run is expected to take: steps, seconds and memory, each from the least to the most."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import bcre_pde
from bcre_studies.models.bcre import grids_of
from bcre_studies.models.registry import AUTOMATON, BCRE
from bcre_studies.preview.numbers import Numbers, explicit_step
from bcre_studies.scenes.scene import Scene
from bcre_studies.timing.costs import Costs, closures_of


class Effort(NamedTuple):
    """Steps and seconds of one model, least and most; the most under the thickest layer."""

    steps: tuple[float, float]
    seconds: tuple[float, float]


def of_automaton(scene: Scene, numbers: Numbers, costs: Costs, frames: int) -> Effort:
    """By the step at the start, which a thick layer shortens where it is "auto"."""
    least = scene.time.until / numbers.rule.dt
    most = least
    if scene.time.step == "auto":
        most = max(least, scene.time.until / numbers.wave_step(numbers.thickest))
    closures, name = closures_of(scene), scene.automaton.scheme
    taken = [
        costs.seconds(name, scene.domain.cells, steps, closures, frames) for steps in (least, most)
    ]
    return Effort((least, most), (taken[0], taken[1]))


def of_bcre(scene: Scene, numbers: Numbers, costs: Costs, frames: int) -> Effort:
    """From the fewest grids that give an error to all of them, with Runge-Kutta steps."""
    grids = list(grids_of(scene))
    layers = numbers.largest_R, numbers.thickest
    parts = grids[: bcre_pde.LEAST_GRIDS], grids
    steps = [_steps(scene, part, R) for part, R in zip(parts, layers, strict=True)]
    closures = closures_of(scene)
    taken = [
        sum(
            costs.seconds(BCRE.name, cells, own, closures, frames)
            for cells, own in zip(part, counts, strict=True)
        )
        for part, counts in zip(parts, steps, strict=True)
    ]
    return Effort((steps[0][-1], steps[1][-1]), (taken[0], taken[1]))


def _steps(scene: Scene, grids: Sequence[int], R: float) -> list[float]:
    return [scene.time.until / explicit_step(scene, cells, R) for cells in grids]


def memory(scene: Scene, frames: int) -> int:
    """Bytes that both models take, beyond their libraries."""
    return sum(model.adapter().memory(scene, frames) for model in (AUTOMATON, BCRE))
