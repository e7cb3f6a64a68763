"""Slow driving: a little sand or slope at a time, then rest until nothing rolls.

Tilting: u += dS (L - x), then a trigger, rolling sand at one place; wait until R < 1e-9. Feeding:
a grain on the surface and a trigger, each at a random place. The material is figure 1's with
Sc = 0, which merely tilts the picture.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

import bcre_pde
from bcre_ca import MARGIN, Pile, Rule
from bcre_ca.line.settling import settled
from bcre_studies.observables.outcome import slope
from bcre_studies.scenes.domain import Array

V, D, GAMMA = 0.1, 0.1, 0.01
"""Figure 1's."""

TILT = 0.01
"""dS, the slope added at a time."""

STILL = 1e-9
"""Nothing rolls where R is nowhere more than this, a length."""

LOOKS = 8
"""How often rest is looked for while sand drifts once down the slope."""

WIDTH = 2.0
"""Of the Gaussian trigger that both models are given; the other one is a single cell's."""


class Events(NamedTuple):
    """What followed each trigger, arrays of shape (triggers,).

    slope: S - Sc just before, least squares over the middle half.
    size: area that left through the foot.
    duration: until nothing rolled, looked for at intervals.
    place: cells or length from the top, where the trigger was.
    """

    slope: Array
    size: Array
    duration: Array
    place: Array


@dataclass(frozen=True)
class Tilting:
    """Slow tilting of the two-layer automaton.

    Parameters
    ----------
    cells: on a slope of ``length``; d is their quotient.
    trigger: area of rolling sand.
    tilts, tilt: how many, and the slope of each.
    from_foot: distance of every trigger from the foot; None for random places.
    wide: whether the trigger is a Gaussian of :data:`WIDTH` instead of one cell.
    """

    length: float
    cells: int
    trigger: float
    tilts: int
    seed: int
    tilt: float = TILT
    from_foot: float | None = None
    wide: bool = False


@dataclass(frozen=True)
class Feeding:
    """Grains of area 1 on the surface of a slope at repose, one at a time, each with a trigger."""

    cells: int
    trigger: float
    grains: int
    seed: int


def tilted(drive: Tilting) -> Events:
    """The events of the automaton under slow tilting."""
    d = drive.length / drive.cells
    relax = _Automaton(drive.length, drive.cells)
    return _events(drive, relax, d)


def tilted_bcre(drive: Tilting, effective: bool) -> Events:
    """The events of BCRE on so many cells, with its own or with the automaton's D and kappa.

    The latter are those of d = 1 and a step of :data:`MARGIN` of the bound.
    """
    rule = Rule(V, D, GAMMA, 0.0, d=1.0, dt=1.0)
    rule = Rule(V, D, GAMMA, 0.0, d=1.0, dt=MARGIN * rule.max_stable_step())
    material = bcre_pde.Material(
        v=V,
        D=rule.effective_diffusion() if effective else D,
        gamma=GAMMA,
        Sc=0.0,
        kappa=rule.effective_curvature() if effective else 0.0,
    )
    relax = _Bcre(drive.length, drive.cells, material)
    return _events(drive, relax, drive.length / drive.cells)


def fed(drive: Feeding) -> Events:
    """The events of the automaton under feeding; no grain falls on the last cell, which is held."""
    relax, chance = _Automaton(float(drive.cells), drive.cells), np.random.default_rng(drive.seed)
    h, rows = np.zeros(drive.cells), []
    for _ in range(drive.grains):
        h, R = h.copy(), np.zeros(drive.cells)
        h[chance.integers(drive.cells - 1)] += 1.0
        place = int(chance.integers(drive.cells))
        R[place] = drive.trigger
        steepness = slope(relax.x, h)
        h, size, duration = relax(h, R)
        rows.append((steepness, size, duration, float(place)))
    return Events(*np.array(rows).T)


Relax = Callable[[Array, Array], tuple[Array, float, float]]
"""h and R -> h at rest, the area that left, and the time it took."""


class _Automaton:
    """Relaxes a pile with steps that follow their bounds."""

    def __init__(self, length: float, cells: int) -> None:
        self._rule = Rule(V, D, GAMMA, 0.0, d=length / cells, dt=1.0)
        self._between = length / V / LOOKS
        self.x = (np.arange(cells) + 0.5) * length / cells

    def __call__(self, h: Array, R: Array) -> tuple[Array, float, float]:
        end = settled(Pile(h, R), self._rule, STILL, self._between)
        return end.h, end.outflow, end.t


class _Bcre:
    """Relaxes a pile by BCRE, on its own cells."""

    LOCAL_ERROR = 1e-3
    """Of the steps in time, relative to the largest R; the grid's error is the larger one."""

    MOST_LOOKS = 1000

    def __init__(self, length: float, cells: int, material: bcre_pde.Material) -> None:
        self._length, self._cells, self._material = length, cells, material
        self._times = [length / V / LOOKS * look for look in range(self.MOST_LOOKS)]
        self.x = (np.arange(cells) + 0.5) * length / cells

    def __call__(self, h: Array, R: Array) -> tuple[Array, float, float]:
        def initial(x: Array) -> tuple[Array, Array]:
            return (h, R) if x.size == h.size else (np.zeros(x.size), np.zeros(x.size))

        solution = bcre_pde.solve(
            bcre_pde.Problem(initial, self._material, self._length),
            self._times,
            self._cells,
            tolerance=self.LOCAL_ERROR,
            stop=lambda so_far: so_far.R[-1].max() <= STILL,
        )
        return solution.h[-1], float(solution.outflow[-1]), float(solution.t[-1])


def _events(drive: Tilting, relax: _Automaton | _Bcre, d: float) -> Events:
    h, rows = np.zeros(drive.cells), []
    for place in _places(drive):
        h = h + drive.tilt * (drive.length - relax.x)
        steepness = slope(relax.x, h)
        h, size, duration = relax(h, _trigger(drive, relax.x, place, d))
        rows.append((steepness, size, duration, place))
    return Events(*np.array(rows).T)


def _places(drive: Tilting) -> Iterator[float]:
    """Where the triggers are, in lengths from the top; the same for every model and grid."""
    chance = np.random.default_rng(drive.seed)
    for _ in range(drive.tilts):
        place = float(chance.uniform(0.0, drive.length))
        yield place if drive.from_foot is None else drive.length - drive.from_foot


def _trigger(drive: Tilting, x: Array, place: float, d: float) -> Array:
    if drive.wide:
        height = drive.trigger / (math.sqrt(math.pi) * WIDTH)
        return np.asarray(height * np.exp(-(((x - place) / WIDTH) ** 2)))
    R = np.zeros_like(x)
    R[min(int(place / d), x.size - 1)] = drive.trigger / d
    return R
