r"""The dimensionless numbers of a scene, its stable steps, and where its slope stands.

    Courant v dt/d      cell Peclet v d/D      exchange gamma R dt/d      Sd of both models

The exchange number is that of the thickest layer: at the start, and as thick as it may become
(``models.adapter.thickest_layer``).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

import bcre_ca
import bcre_pde
from bcre_studies.models.adapter import thickest_layer
from bcre_studies.models.automaton import rule_of
from bcre_studies.models.bcre import problem_of
from bcre_studies.scenes.scene import Scene

SLACK = 1e-9
"""A number counts as equal to another up to this part."""


@dataclass(frozen=True)
class Numbers:
    """What is known of a scene before it is run.

    Parameters
    ----------
    rule: the automaton with the step that it starts with.
    largest_R, thickest: largest layer at the start, and what it may become; lengths.
    slope: mean, least and largest slope S = -dh/dx at the start.
    sd_automaton, sd_bcre: second critical slopes; NaN where no closed form is known.
    """

    rule: bcre_ca.Rule
    largest_R: float
    thickest: float
    slope: tuple[float, float, float]
    sd_automaton: float
    sd_bcre: float

    @property
    def courant(self) -> float:
        """v dt/d."""
        return self.rule.v * self.rule.dt / self.rule.d

    @property
    def peclet(self) -> float:
        """v d/D of a cell; infinite without diffusion."""
        return self.rule.v * self.rule.d / self.rule.D if self.rule.D else math.inf

    def exchange(self, R: float) -> float:
        """gamma R dt/d."""
        return self.rule.gamma * R * self.rule.dt / self.rule.d

    @property
    def layer_step(self) -> float:
        """Largest dt that keeps R >= 0."""
        return self.rule.max_stable_step(0.0, self.slope[1])

    def wave_step(self, R: float) -> float:
        """d/(gamma R), the largest dt at which the climbing wave crosses one cell a step."""
        return self.rule.d / (self.rule.gamma * R) if self.rule.gamma * R > 0 else math.inf

    @property
    def is_stable(self) -> bool:
        """Whether the step is stable at the start."""
        least = min(self.layer_step, self.wave_step(self.largest_R))
        return self.rule.dt <= least * (1 + SLACK)


def numbers_of(scene: Scene) -> Numbers:
    """The numbers of a scene; nothing is run."""
    rule, m = rule_of(scene), scene.material
    h, R = scene.initial(scene.centres())
    slopes = -np.diff(h) / scene.d if h.size > 1 else np.array([m.Sc])
    mean = float(slopes.mean()) if scene.domain.ends != "periodic" else m.Sc
    limited = rule.scheme == "limited"
    return Numbers(
        rule,
        float(R.max()),
        thickest_layer(scene),
        (mean, float(slopes.min()), float(slopes.max())),
        math.nan if limited else rule.second_critical_slope(),
        bcre_pde.second_critical_slope(m.v, m.D, m.gamma, m.Sc),
    )


def explicit_step(scene: Scene, cells: int, R: float) -> float:
    """Largest stable step of BCRE's Runge-Kutta method on so many cells under a layer R."""
    material = problem_of(scene).material
    return bcre_pde.largest_explicit_step(material, scene.domain.length / cells, R)


def regime(slope: float, numbers: Numbers, Sc: float) -> str:
    """What a thin pulse does on this slope, by the closed forms of a frozen slope."""
    known = [Sd for Sd in (numbers.sd_automaton, numbers.sd_bcre) if not math.isnan(Sd)]
    low, high = min(known), max(known)
    if slope < Sc * (1 - SLACK):
        return "below repose: a pulse is laid down on its way"
    if slope <= Sc * (1 + SLACK):
        return "at repose: a thin pulse neither grows nor shrinks"
    if slope <= low:
        return "above repose, below Sd: a thin pulse grows as it runs downhill, and does not climb"
    if slope < high:
        first, other = ("the automaton", "BCRE")
        if numbers.sd_automaton > numbers.sd_bcre:
            first, other = other, first
        return f"between the two Sd: a thin pulse climbs in {first}, and not in {other}"
    return "above Sd: even the thinnest pulse climbs"
