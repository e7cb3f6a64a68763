"""A pile that steps on until nothing rolls."""

from __future__ import annotations

import math

from bcre_ca.line.evolve import MARGIN
from bcre_ca.line.pile import Pile
from bcre_ca.line.recording import Recording
from bcre_ca.rule import Rule


def settled(pile: Pile, rule: Rule, still: float, between: float) -> Pile:
    """The pile once R is nowhere more than ``still``, in steps that follow their bounds.

    Its ends are open: rolling sand drifts to the foot and leaves there.

    Parameters
    ----------
    pile, rule: as in :func:`bcre_ca.frames`.
    still: a length, > 0.
    between: time after which the layer is looked at again; the end is found as late as that.

    Raises
    ------
    FloatingPointError
        where the layers outgrow every step.
    """
    run = Recording(pile, rule, "open", 0.0, MARGIN, math.inf)
    return run.until_still(still, between)
