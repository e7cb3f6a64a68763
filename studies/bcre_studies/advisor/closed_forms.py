r"""Closed forms that a scene may have, and their layers at every time.

* **Frozen slope**: Gaussian pulses on an even slope S, h as it was at the start,

      R = sum_p A_p w_p/W_p exp(sigma t - (x - x_p - v t)^2/W_p^2)      W_p^2 = w_p^2 + 4 D t

  with sigma = gamma (S - Sc); a uniform layer, where the ends are joined, is A e^(sigma t). It is
  exact where gamma = 0 or S = Sc (E = 0), as far as the ends are away; else as far as R is too thin
  to move the slope. h follows it by h(t) = h(0) - sigma int R dt.
* **Climbing wave**: D = kappa = 0, joined ends, and u the surface of a simple wave, in BCRE
  R + u + (v/gamma) ln R the same everywhere: R(x, t) = R0(x + c(R) t), c = gamma R, until it breaks
  (:mod:`bcre_pde.simple_wave`).

How far a form is off is measured, as with every other candidate; here is decided only whether the
formula can be written down.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, partial

import numpy as np

from bcre_pde import simple_wave
from bcre_studies.models.bcre import problem_of
from bcre_studies.models.run import Run
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.scene import Scene
from bcre_studies.scenes.terms import Gaussian, Incline, Uniform

SAME = 1e-3
"""A surface is that of a simple wave if it is so to this part of R."""

NODES = 256
"""Gauss-Legendre nodes of the time integral of R: a pulse passes over many of them."""

IMAGES = range(-3, 4)
"""Copies of a pulse beside joined ends."""

Layers = Callable[[Array, float], tuple[Array, Array]]


@dataclass(frozen=True)
class ClosedForm:
    """A formula for a scene: its name, how it reads, and h and R at positions x (N,) and time t."""

    name: str
    formula: str
    layers: Layers

    def run(self, scene: Scene, times: Sequence[float], cells: int) -> Run:
        """The formula at the centres of so many cells, as the record of a run."""
        x = scene.centres(cells)
        h, R = (np.array(rows) for rows in zip(*(self.layers(x, t) for t in times), strict=True))
        area = (h + R).sum(axis=1) * scene.domain.length / cells
        return Run(scene, x, np.array(times), h, R, area[0] - area, steps=0, evaluations=0)


def closed_form(scene: Scene) -> ClosedForm | None:
    """The closed form that can be written down for a scene, or None."""
    return _frozen_slope(scene) or _climbing_wave(scene)


def _frozen_slope(scene: Scene) -> ClosedForm | None:
    m = scene.material
    even = all(isinstance(term, Incline) for term in scene.surface)
    known = (Gaussian, Uniform) if scene.domain.ends == "periodic" else (Gaussian,)
    if scene.source or m.Gamma or scene.domain.ends == "wall":
        return None
    if not scene.rolling or not all(isinstance(term, known) for term in scene.rolling):
        return None
    if not (even or m.gamma == m.kappa == 0):
        return None
    slope = sum(term.slope for term in scene.surface if isinstance(term, Incline))
    sigma = m.gamma * (slope - m.Sc) if even else 0.0

    def R(x: Array, t: float) -> Array:
        terms = [_carried(term, scene, x, t) for term in scene.rolling]
        return np.asarray(np.sum(terms, axis=0) * np.exp(sigma * t))

    def layers(x: Array, t: float) -> tuple[Array, Array]:
        h, _ = scene.initial(x)
        if sigma and t > 0:
            nodes, weights = _gauss()
            passed = (t * (1 + node) / 2 for node in nodes)
            h = h - sigma * t / 2 * sum(w * R(x, s) for w, s in zip(weights, passed, strict=True))
        return h, R(x, t)

    growth = f" e^({sigma:.3g} t)" if sigma else ""
    return ClosedForm(
        "frozen slope",
        f"R = sum of A w/W exp(-((x - x0 - v t)/W)^2){growth}, W^2 = w^2 + 4 D t",
        layers,
    )


@cache
def _gauss() -> tuple[Array, Array]:
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    return nodes, weights


def _carried(term: object, scene: Scene, x: Array, t: float) -> Array:
    """A term of the rolling layer at time t, drifted and spread."""
    if isinstance(term, Uniform):
        return np.full_like(x, term.amplitude)
    assert isinstance(term, Gaussian)
    m, length = scene.material, scene.domain.length
    spread = term.width**2 + 4 * m.D * t
    shifts = [length * image for image in IMAGES] if scene.domain.ends == "periodic" else [0.0]
    place = term.centre + m.v * t
    if len(shifts) > 1:
        place %= length
    pulses = (np.exp(-((x - place - shift) ** 2) / spread) for shift in shifts)
    return np.asarray(term.amplitude * term.width / np.sqrt(spread) * sum(pulses))


def _climbing_wave(scene: Scene) -> ClosedForm | None:
    m, length = scene.material, scene.domain.length
    if m.D or m.kappa or m.gamma == 0 or scene.domain.ends != "periodic" or scene.source:
        return None
    x = scene.centres(4096)
    h, R = scene.initial(x)
    if not R.min() > 0:
        return None
    material = problem_of(scene).material
    speed = partial(simple_wave.climb, material)
    level = h - simple_wave.surface(material, x, R)
    breaking = simple_wave.breaking_time(float(np.max(np.gradient(speed(R), x))))
    if np.ptp(level) > SAME * R.mean() or scene.time.until >= breaking:
        return None
    constant, thickest = float(level.mean()), float(1.01 * R.max())

    def start(place: Array) -> Array:
        return scene.initial(place % length)[1]

    def layers(x: Array, t: float) -> tuple[Array, Array]:
        R = simple_wave.layer(x, t, start, speed, thickest)
        return simple_wave.surface(material, x, R) + constant, R

    return ClosedForm("climbing wave", "R(x, t) = R0(x + gamma R t), until it breaks", layers)
