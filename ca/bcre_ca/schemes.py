"""The schemes, each a type, so that each is compiled by itself."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numba.extending import overload
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Upwind(NamedTuple):
    """The paper's differences, of first order."""


class Calibrated(NamedTuple):
    """Upwind, less the diffusion and the curvature that upwind differences add."""


class Limited(NamedTuple):
    """Second order with limited slopes."""


class InPlace(NamedTuple):
    """Upwind, cells updated in place one after the other, downhill or uphill."""

    downhill: bool


OPEN, WALLED, JOINED = 0, 1, 2


class InContainer(NamedTuple):
    """Upwind, with sources or a wall at the foot.

    supply: what sources pour into each cell, shape (N,): length/time, or a length in a step.
    ends: :data:`OPEN`, :data:`WALLED` or :data:`JOINED`.
    longest: a step that is long enough where no other bound is.
    """

    supply: Array
    ends: int
    longest: float


class SlopeDriven(NamedTuple):
    """The rule of :mod:`bcre_ca.line.slope_driven`, in whose parameters v is beta.

    d is the cell length; the others are those of :class:`InContainer`.
    """

    supply: Array
    ends: int
    longest: float
    d: float


CompiledScheme = Upwind | Calibrated | Limited | InPlace | InContainer | SlopeDriven
"""A scheme is a type, so that each is compiled by itself."""


def by_scheme(default: Callable[..., Any], others: dict[type, Callable[..., Any]]) -> Any:
    """A function whose body is chosen by the scheme, its last argument.

    Python chooses at each call, the compiler once.
    """

    def chosen(*arguments: Any) -> Any:
        return others.get(type(arguments[-1]), default)(*arguments)

    def compiled(*arguments: Any) -> Any:
        return others.get(arguments[-1].instance_class, default)

    overload(chosen, strict=False)(compiled)
    return chosen
