"""The compiled automaton on a plane: many steps a call, equal to the plain step to the bit.

``tilted``, ``split4`` and ``facets`` step one row; ``march`` leads them down the rows, several
steps together and in several threads, inside the ``windows`` where it is wet; ``edges`` renews what
lies beyond the ends; ``bounds`` looks for what limits the step; ``storage`` holds the layers.
"""

from __future__ import annotations

from bcre_ca.kept import kept
from bcre_ca.plane.kernels import bounds, facets, march, split4, tilted
from bcre_ca.plane.kernels.work import Form

_FACETS = Form(facets.REACH, facets.CARRIED, together=2)

FORMS = {
    "tilted": Form(tilted.REACH, tilted.CARRIED, together=8),
    "split4": Form(split4.REACH, split4.CARRIED, together=4),
    "facet8": _FACETS,
    "d8": _FACETS,
}


take_steps = kept(march.take_steps)
extremes = kept(bounds.extremes)

__all__ = ["FORMS", "extremes", "take_steps"]
