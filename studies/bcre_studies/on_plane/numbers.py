r"""The dimensionless numbers of a scene on a plane, its stable steps, its slopes, and their angles.

Courant v dt/d      cell Peclet v d/D      exchange gamma R dt/d      Sd of both models
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

import bcre_pde
from bcre_ca.plane import MARGIN, Plane
from bcre_ca.plane.bounds import excess_of
from bcre_ca.plane.sources import cells_of
from bcre_ca.plane.theory import OUTGOING, max_stable_step, opening_angle_on
from bcre_pde.plane import Material, theory
from bcre_studies.models.plane.automaton import plane_of
from bcre_studies.preview.numbers import Numbers
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.plane.scene import PlaneScene


@dataclass(frozen=True)
class PlaneNumbers(Numbers):
    """As on a line, with the bounds of a plane; slopes are those that its flow rule reads.

    Parameters
    ----------
    plane: what the sand lies on, its rule with the step of the start.
    """

    plane: Plane

    @property
    def layer_step(self) -> float:
        """Largest dt that keeps R >= 0."""
        return max_stable_step(self.plane, 0.0, self.rule.Sc - self.slope[1])

    def wave_step(self, R: float) -> float:
        """Largest dt at which the surface wave is stable; sand leaves to two sides on split4."""
        return super().wave_step(R) / OUTGOING[self.plane.flow]


def numbers_of(scene: PlaneScene) -> PlaneNumbers:
    """The numbers of a scene; nothing is run.

    Raises
    ------
    ValueError
        for a source above no cell that can hold sand.
    """
    h, R = scene.initial()
    plane, m = plane_of(scene, h), scene.material
    cells_of(plane.sources, plane.free(h.shape), scene.domain.d, plane.sides == "periodic")
    slopes = _slopes(h, plane)
    mean, least, most = (float(value) for value in (slopes.mean(), slopes.min(), slopes.max()))
    largest = float(R.max())
    if scene.time.step == "auto":
        longest = max_stable_step(plane, largest, m.Sc - least)
        dt = MARGIN * longest if math.isfinite(longest) else plane.rule.dt
        plane = replace(plane, rule=replace(plane.rule, dt=min(dt, scene.time.until)))
    return PlaneNumbers(
        rule=plane.rule,
        largest_R=largest,
        thickest=_thickest(scene, h, largest, most),
        slope=(mean, least, most),
        sd_automaton=plane.rule.second_critical_slope(),
        sd_bcre=bcre_pde.second_critical_slope(m.v, m.D, m.gamma, m.Sc),
        plane=plane,
    )


def _slopes(h: Array, plane: Plane) -> Array:
    """S of the cells that can hold sand; on a tilted plane without what goes on beyond the foot."""
    free = plane.free(h.shape)
    S = excess_of(h, plane) / plane.rule.d + plane.rule.Sc
    if plane.flow == "tilted" and plane.ends != "periodic":
        S, free = S[:-1], free[:-1]
    return np.asarray(S[free]) if free.any() else np.array([plane.rule.Sc])


def _thickest(scene: PlaneScene, h: Array, largest: float, steepest: float) -> float:
    """What R may come to: R0 e^(gamma (S - Sc) t), but no more than what lies above repose.

    A source adds what it pours while the layer drifts off its disc. On a free surface sand flows
    together, so that no such bound is known: infinite.
    """
    m, thickest = scene.material, largest
    if scene.automaton.flow != "tilted":
        return math.inf
    for source in scene.source:
        span = max(min(scene.time.until, source.until) - source.start, 0.0)
        passing = source.width / m.v if m.v > 0 else span
        disc = max(math.pi * source.width**2 / 4, scene.domain.d**2)
        thickest += source.rate / disc * min(span, passing)
    u = h + m.Sc * scene.domain.centres().x
    growth = m.gamma * max(steepest - m.Sc, 0.0) * scene.time.until
    return min(thickest * math.exp(min(growth, 700.0)), thickest + float(np.ptp(u)))


def opening_angles(numbers: PlaneNumbers, scene: PlaneScene) -> tuple[float, float] | str:
    """theta in degrees in the automaton and in BCRE at the steepest slope; or why there is none."""
    m, S = scene.material, numbers.slope[2]
    if scene.automaton.flow != "tilted":
        return "there is no closed form on a free surface"
    if not m.Sc * (1 + 1e-9) < S:
        return "there is none: nothing is steeper than repose, so that no avalanche grows"
    if not (m.D > 0 and m.across > 0 and m.gamma > 0):
        return "there is no closed form without D, D_across and gamma"
    material = Material(m.v, m.D, m.across, m.gamma, m.Sc)
    return opening_angle_on(numbers.plane, S), theory.opening_angle(material, S)
