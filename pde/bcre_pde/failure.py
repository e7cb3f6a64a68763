"""A solver that fails says where: in which cell, when, and by which quantity."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bcre_pde.equation import BCRE

Array = NDArray[np.float64]


class SolveError(RuntimeError):
    """A solver that gave up.

    ``time`` is when it stood there and ``cell`` the number of the cell concerned, counted from 0 at
    the top; None where the failure has none.
    """

    def __init__(self, message: str, time: float | None = None, cell: int | None = None) -> None:
        super().__init__(message)
        self.time = time
        self.cell = cell


def failed(equation: BCRE, method: str, reason: str = "") -> SolveError:
    """The error of a method that gave up after the last evaluation of the right-hand side.

    It names the first cell where a layer or its rate of change is not finite, or else the one that
    changes fastest.
    """
    layers, rates = equation.last_layers, np.zeros_like(equation.last_layers)
    equation.rate(layers, rates)
    cell, what = (
        _not_finite(layers, ("u", "R"))
        or _not_finite(rates, ("du/dt", "dR/dt"))
        or (_fastest(rates))
    )
    x = (cell + 0.5) * equation.dx
    where = f"{what} in cell {cell} (x = {x:.6g}) at t = {equation.last_time:.6g}"
    because = f"{reason.rstrip('.')}: " if reason else ""
    return SolveError(f"{method} gave up: {because}{where}", equation.last_time, cell)


def _not_finite(rows: Array, names: tuple[str, str]) -> tuple[int, str] | None:
    bad = ~np.isfinite(rows)
    bad[0, -1] |= bad[2].any()  # u on the foot and the outflow belong to the last cell
    cells = np.flatnonzero(bad[:2].any(axis=0))
    if cells.size == 0:
        return None
    cell = int(cells[0])
    return cell, f"{names[0] if bad[0, cell] else names[1]} is not finite"


def _fastest(rates: Array) -> tuple[int, str]:
    row, cell = np.unravel_index(np.argmax(np.abs(rates[:2])), rates[:2].shape)
    name = ("du/dt", "dR/dt")[row]
    return int(cell), f"the layers change fastest, {name} = {rates[row, cell]:.3g},"
