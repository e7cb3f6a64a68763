"""Two-layer cellular automaton of sandpile surfaces (Pla-Castells, García-Fernández, Martínez).

Start at :mod:`bcre_ca.line.step` for the rule itself, :mod:`bcre_ca.rule` for its parameters,
:mod:`bcre_ca.line.evolve` for running it and :mod:`bcre_ca.theory` for its closed forms.
"""

from bcre_ca.line.evolve import (
    MARGIN,
    advance,
    evolve,
    evolve_many,
    frames,
    largest_stable_step,
    march,
    stepped_cells,
)
from bcre_ca.line.kernels import BLOCK
from bcre_ca.line.pile import Pile
from bcre_ca.line.sources import Source
from bcre_ca.line.step import step
from bcre_ca.rule import Rule
from bcre_ca.unstable import UnstableStep

__all__ = [
    "BLOCK",
    "MARGIN",
    "Pile",
    "Rule",
    "Source",
    "UnstableStep",
    "advance",
    "evolve",
    "evolve_many",
    "frames",
    "largest_stable_step",
    "march",
    "step",
    "stepped_cells",
]
