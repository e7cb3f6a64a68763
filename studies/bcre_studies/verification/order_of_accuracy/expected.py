"""What order each kind of scheme must have, how small its error must be, and why."""

from __future__ import annotations

from math import inf
from typing import NamedTuple

from bcre_studies.models.registry import AUTOMATON, BCRE

CA, PDE = AUTOMATON.name, BCRE.name


class Expected(NamedTuple):
    """Formal order, the range of the observed one, and the error on the finest grid.

    ``why`` gives the reason of the range, ``why_below`` what lowers an order that is outside.
    """

    order: float
    lowest: float
    highest: float
    error: float
    why: str
    why_below: str = ""


_OF_MODEL = (
    "within a tenth of the formal order for the automaton; for the PDE one below its formal 5, "
    "since the limiter may cost an order at isolated points, and no upper end, since a solution "
    "smoother than its grid asks for converges faster"
)
WHY_ERROR = (
    "on the finest grid, relative to the spread of R: 1 % for the first-order scheme; for the PDE "
    "a hundredth of the 5 % that the studies call agreement"
)
EXPECTED = {
    CA: Expected(1.0, 0.9, 1.1, 0.01, _OF_MODEL),
    PDE: Expected(5.0, 4.0, inf, 5e-4, _OF_MODEL),
    "calibrated": Expected(
        1.0,
        0.9,
        inf,
        0.01,
        "a tenth below the formal order, and no upper end, since its leading error is calibrated "
        "away where D_eff = D and the flow is linear",
    ),
    "limited": Expected(
        2.0,
        1.8,
        2.2,
        0.01,
        "within a tenth of the formal order",
        "With a curvature term the stable step goes with d^2, so that v dt/d falls from grid to "
        "grid and takes less and less of the drift's error, (1 - c)(1 - 2 c) d^2, away: there the "
        "order is that of grids on which v dt/d is not small yet",
    ),
}


def kind(model: str, scheme: str) -> str:
    """The key of :data:`EXPECTED`: the scheme of the automaton if not the paper's, or model."""
    scheme, comma, _ = scheme.partition(",")
    return scheme if comma else model
