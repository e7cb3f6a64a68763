"""Pieces of work whose amount is known: so many cell-steps of a model, all cells wet.

The layers lie about the repose line with sand rolling on all of it, and the ends are joined, so
that they look the same after any number of steps and no cell runs dry.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from pde import CartesianGrid

import bcre_ca
from bcre_ca.rule import Ends, Scheme
from bcre_pde import Material
from bcre_pde.equation import BCRE
from bcre_studies.performance.rivals import numpy_automaton
from bcre_studies.scenes.domain import Array
from bcre_studies.timing.machine import Load

RULE = bcre_ca.Rule(v=0.5, D=0.1, gamma=0.01, Sc=0.5, d=1.0, dt=0.4)
WAVE = 1000.0
"""Cells of a wave of the layers."""


def wet_slope(cells: int) -> tuple[Array, Array]:
    """h and R with sand rolling everywhere."""
    wave = np.sin(2 * np.pi * np.arange(cells) / min(WAVE, cells))
    return -RULE.Sc * np.arange(cells) + 0.1 * wave, 1 + 0.5 * wave


def steps_for(cells: int, cell_steps: float) -> int:
    """Steps that make about so many cell-steps, and one block at least."""
    return max(round(cell_steps / cells), bcre_ca.BLOCK)


def automaton(scheme: Scheme, cells: int, cell_steps: float = 3e7) -> Load:
    """The compiled automaton, many steps a call."""
    (h, R), steps = wet_slope(cells), steps_for(cells, cell_steps)
    rule = replace(RULE, scheme=scheme)
    return Load(lambda: bcre_ca.march(h, R, rule, steps, _ends(cells)), float(cells * steps))


def _ends(cells: int) -> Ends:
    """Joined, but open where tiles are to be had: in so few steps little leaves."""
    return "open" if cells > 1_000_000 else "periodic"


def plain_numpy(cells: int, cell_steps: float = 2e6) -> Load:
    """The automaton in preallocated NumPy."""
    (h, R), steps = wet_slope(cells), max(round(cell_steps / cells), 2)
    return Load(lambda: numpy_automaton.march(h, R, RULE, steps, "periodic"), float(cells * steps))


def right_hand_side(cells: int, evaluations: float = 2e6) -> Load:
    """The right-hand side of BCRE, fifth order."""
    material = Material(RULE.v, RULE.D, RULE.gamma, RULE.Sc)
    grid = CartesianGrid([[0.0, float(cells)]], cells, periodic=True)
    equation = BCRE(material, grid)
    h, R = wet_slope(cells)
    state = BCRE.state(grid, h + RULE.Sc * np.arange(cells), R)
    times = max(round(evaluations / cells), 2)

    def call() -> None:
        for _ in range(times):
            equation.evolution_rate(state)

    return Load(call, float(cells * times))


def batch(scenes: int, cells: int, steps: int) -> Load:
    """Many scenes of one rule in one call."""
    h, R = (np.tile(layer, (scenes, 1)) for layer in wet_slope(cells))
    return Load(lambda: bcre_ca.evolve_many(h, R, RULE, steps, "periodic"), float(h.size * steps))


def partly_wet(cells: int, share: float, steps: int) -> tuple[Load, Load]:
    """A pile of which a share is wet, and one that is wet all over; amounts in cells of the pile.

    The cut-off of 1e-100 keeps the tails from numbers so small that arithmetic on them is slow.
    """
    rule = replace(RULE, dry=1e-100)
    h, everywhere = wet_slope(cells)
    wet = slice(round(cells * (1 - share) / 2), round(cells * (1 + share) / 2))
    part = np.zeros(cells)
    part[wet] = everywhere[wet]

    def fresh(R: Array) -> Load:
        def call() -> None:
            layers = h.copy(), R.copy()
            bcre_ca.march(*layers, rule, steps, "open")

        return Load(call, float(cells * steps))

    return fresh(part), fresh(everywhere)
