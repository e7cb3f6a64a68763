"""The automaton's state on a line, and what makes a valid start."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from typing import Any, get_args

import numpy as np
from numpy.typing import NDArray

from bcre_ca.gate import layers_of, numbers_of, require_finite, require_kind, require_start
from bcre_ca.rule import Ends

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Pile:
    """The automaton's state: layers h and R of shape (N,), time, and what happened on the way.

    ``outflow`` is the area that has left through the foot: ``d sum(h + R) + outflow`` does not
    change. ``steps`` counts the steps taken. ``lowered`` and ``raised`` count how often a step that
    follows its bounds became shorter or longer, ``redone`` how often a block of steps was repeated
    in shorter ones.
    """

    h: Array
    R: Array
    t: float = 0.0
    outflow: float = 0.0
    steps: int = 0
    lowered: int = 0
    raised: int = 0
    redone: int = 0

    __hash__ = None  # type: ignore[assignment]

    def __eq__(self, other: object) -> bool:
        """Whether all layers and accounts are the same."""
        if not isinstance(other, Pile):
            return NotImplemented
        return all(
            np.array_equal(getattr(self, f.name), getattr(other, f.name)) for f in fields(self)
        )

    def mass(self, d: float) -> float:
        """Area of sand in the pile, d sum(h + R)."""
        return d * (math.fsum(self.h) + math.fsum(self.R))


def require_ends(ends: Any) -> None:
    """Raise ValueError for unknown ends."""
    if ends not in get_args(Ends):
        raise ValueError(f"ends = {ends!r}: must be one of {get_args(Ends)}")


def line_of(h: Any, R: Any) -> tuple[Array, Array]:
    """New arrays of the layers of one pile, finite or not.

    Raises
    ------
    ValueError
        naming the layer, where they are no numbers of one shape (N,) with N >= 1.
    """
    h = numbers_of("h", h)
    if h.ndim == 2:
        raise ValueError(
            f"h has shape {h.shape}: evolve takes one line of cells; evolve_many takes many "
            "piles, (piles, N), but a plane is not a batch of lines"
        )
    return layers_of(h, R, 1, "(N,) with N >= 1")


def checked(pile: Pile, is_start: bool = True) -> Pile:
    """A pile with layers of its own, from which a run can start; ValueError where it is none.

    One that unstable steps have led to goes on with the R < 0 that they made.
    """
    require_kind("pile", pile, Pile)
    h, R = line_of(pile.h, pile.R)
    if is_start:
        require_start(h, R)
    else:
        require_finite(h, R)
    return replace(pile, h=h, R=R)
