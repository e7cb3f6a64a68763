"""Two-layer cellular automaton of sandpile surfaces (Pla-Castells, García-Fernández, Martínez).

Start at :mod:`bcre_ca.step` for the rule itself, :mod:`bcre_ca.rule` for its parameters,
:mod:`bcre_ca.evolve` for running it and :mod:`bcre_ca.theory` for what can be said of it with
pencil and paper.
"""

from bcre_ca.evolve import MARGIN, Pile, advance, evolve, frames, largest_stable_step
from bcre_ca.rule import Rule, UnstableStep
from bcre_ca.step import step

__all__ = [
    "MARGIN",
    "Pile",
    "Rule",
    "UnstableStep",
    "advance",
    "evolve",
    "frames",
    "largest_stable_step",
    "step",
]
