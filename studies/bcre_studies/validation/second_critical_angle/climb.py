r"""Does a pulse near the foot climb to the top of figure 1's slope, and from which slope on?

The scene is figure 1 (v = 0.1, D = 0.1, gamma = 0.01, Sc = 0.5, L = 100) with a pulse of any
amplitude, width 3, at x = 85 on any incline S0, until t = 3000. The step is dt = 0.2 d, which keeps
the surface wave stable up to gamma R = 5. The threshold of a pulse is the lowest S0 at which the
outcome is not ``no`` (``outcome``).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bcre_studies.models.registry import AUTOMATON, Model
from bcre_studies.observables.outcome import Outcome, decided, outcome
from bcre_studies.scenes.scene import Scene, load

CENTRE = 85.0
UNTIL = 3000.0
CELLS = 100
STEP = 0.2
"""dt on :data:`CELLS`, in proportion to d on finer cells."""
TIMES = [float(t) for t in np.linspace(0.0, UNTIL, 61)]

SOLVER_TOLERANCE = 1e-4
"""Local error per step: the steps are bounded by stability, the outcome is one of three words."""

WIDTH = 1.008
"""A threshold is bracketed to this ratio: half of it, 0.4 %, is under a tenth of the tolerance."""


def pulse_scene(excess: float, pulse: float) -> Scene:
    """Figure 1 with S0 = Sc + ``excess`` and a pulse of that amplitude, run long enough."""
    scene = load("figure1")
    slope = scene.material.Sc + excess
    return scene.with_changes(
        until=UNTIL,
        step=STEP,
        **{"surface.0.slope": slope, "rolling.0.amplitude": pulse},
        **{"rolling.0.centre": CENTRE, "solver.tolerance": SOLVER_TOLERANCE},
    )


def climb(model: Model, cells: int, excess: float, pulse: float) -> Outcome:
    """What becomes of the pulse.

    Parameters
    ----------
    model: the effective one has D_eff and kappa_eff of d = 1, dt = 0.2.
    cells: the grid; 100 cells are d = 1.
    excess: S0 - Sc.
    pulse: amplitude, a length.
    """
    scene = pulse_scene(excess, pulse)
    if model is AUTOMATON:
        scene = scene.with_changes(step=STEP * CELLS / cells)
    return outcome(model.run(scene, TIMES, cells, decided), CENTRE)


@dataclass(frozen=True)
class Bracket:
    """The threshold: the pulse does not climb at ``low``, and does at ``high``."""

    low: float
    high: float

    @property
    def value(self) -> float:
        """Middle of the bracket."""
        return (self.low + self.high) / 2

    @property
    def error(self) -> float:
        """Half of its width."""
        return (self.high - self.low) / 2


def threshold(model: Model, grids: tuple[int, ...], pulse: float, within: Bracket) -> Bracket:
    """S0 - Sc from which on the pulse climbs: a bracket that holds on every grid.

    Bisected on the first grid; where it does not hold on a further one it is widened until it does.
    """

    def climbs_on(cells: int) -> Callable[[float], bool]:
        return lambda excess: climb(model, cells, excess, pulse).climbs

    low, high = _widened(climbs_on(grids[0]), within.low, within.high)
    low, high = _bisected(climbs_on(grids[0]), low, high)
    for cells in grids[1:]:
        low, high = _widened(climbs_on(cells), low, high)
    return Bracket(low, high)


def _bisected(climbs: Callable[[float], bool], low: float, high: float) -> tuple[float, float]:
    while high > WIDTH * low:
        middle = math.sqrt(low * high)
        low, high = (low, middle) if climbs(middle) else (middle, high)
    return low, high


def _widened(climbs: Callable[[float], bool], low: float, high: float) -> tuple[float, float]:
    while climbs(low):
        low /= WIDTH
    while not climbs(high):
        high *= WIDTH
    return low, high
