r"""What a cell does, in one place for every flow: exchange, flux, walls, base.

    dt E = X(R) (gamma dt/d) (drop - Sc d),     at most h - base

The plain steps call these functions with arrays, the compiled ones with single cells. A ``gate``
between two cells is 1 where both hold sand, 0 at a wall, and None where there are no walls.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import types
from numba.extending import overload

from bcre_ca.exchange import deposit_thin, exchanging
from bcre_ca.inner import inner
from bcre_ca.plane.coefficients import Coefficients


def _least(a: Any, b: Any) -> Any:
    return np.minimum(a, b)


@overload(_least)
def _least_of_cells(a, b):
    # NumPy's own would also look for NaN, which costs a third of the speed.
    return lambda a, b: min(a, b)


def _larger(a: Any, b: Any) -> Any:
    return np.maximum(a, b)


@overload(_larger)
def _larger_of_cells(a, b):
    return lambda a, b: max(a, b)


def _either(condition: Any, a: Any, b: Any) -> Any:
    return np.where(condition, a, b)


@overload(_either)
def _either_of_cells(condition, a, b):
    return lambda condition, a, b: a if condition else b


least: Any = _least
larger: Any = _larger
either: Any = _either


@inner
def gated(flow: Any, gate: Any) -> Any:
    """A flux or a drop through a face: nothing at a wall."""
    if gate is None:
        return flow
    return flow * gate


def _gate_between(free: Any, other: Any) -> Any:
    return free * other


@overload(_gate_between)
def _gate_between_cells(free, other):
    if isinstance(free, types.NoneType):
        return lambda free, other: None
    return lambda free, other: free * other


gate_between: Any = _gate_between


@inner
def eroded(R: Any, excess: Any, h: Any, base: Any, K: Coefficients) -> Any:
    """dt E of a cell whose surface drops by ``excess`` beyond repose; no more than lies there."""
    wanted = exchanging(R, K.saturation) * (K.exchange * excess)
    if base is None:
        return wanted
    return least(wanted, h - base)


@inner
def changed(
    h: Any, R: Any, along: Any, across: Any, erosion: Any, K: Coefficients
) -> tuple[Any, Any]:
    """The new h and R of a cell from the net flux into it along and across, and its erosion."""
    layers: tuple[Any, Any] = deposit_thin(
        h - erosion, R + ((along + across) + erosion), R, K.dry, K.emptying
    )
    return layers
