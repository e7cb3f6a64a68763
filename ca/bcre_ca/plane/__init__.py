"""The two-layer automaton on a plane: cells (i, j), i along x and j across.

Start at :mod:`bcre_ca.plane.tilted`, :mod:`bcre_ca.plane.split4` and :mod:`bcre_ca.plane.facets`
for the rules, a screen each, :mod:`bcre_ca.plane.setting` for what stays the same during a run,
:mod:`bcre_ca.plane.evolve` for running it, :mod:`bcre_ca.plane.run` for doing so step by step
without a copy, and :mod:`bcre_ca.plane.theory` for the closed forms.
"""

from bcre_ca.plane.evolve import MARGIN, advance, evolve, frames
from bcre_ca.plane.layers import Sand
from bcre_ca.plane.run import BLOCK, Run
from bcre_ca.plane.setting import Plane
from bcre_ca.plane.sources import Source
from bcre_ca.plane.step import step
from bcre_ca.plane.theory import opening_angle

__all__ = [
    "BLOCK",
    "MARGIN",
    "Plane",
    "Run",
    "Sand",
    "Source",
    "advance",
    "evolve",
    "frames",
    "opening_angle",
    "step",
]
