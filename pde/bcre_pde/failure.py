"""A solver that fails says where: in which cell, when, and by which quantity."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from bcre_pde.problem import Array

if TYPE_CHECKING:
    from bcre_pde.marched import Marched


class SolveError(RuntimeError):
    """A solver that gave up.

    ``time`` is when it gave up and ``cell`` the number of the cell concerned, counted from 0 at the
    top (two numbers on a plane); None where the failure has none.
    """

    def __init__(
        self, message: str, time: float | None = None, cell: int | tuple[int, ...] | None = None
    ) -> None:
        super().__init__(message)
        self.time = time
        self.cell = cell


def failed(equation: Marched, method: str, reason: str = "") -> SolveError:
    """The error of a method that gave up after the last evaluation of the right-hand side.

    It names the first cell where a layer or its rate of change is not finite, or else the one that
    changes fastest.
    """
    layers, rates = equation.last_layers, np.zeros_like(equation.last_layers)
    equation.rate(layers, rates)
    names = equation.fields
    changes = tuple(f"d{name}/dt" for name in names)
    cell, what = (
        _not_finite(layers, names) or _not_finite(rates, changes) or _fastest(rates, changes)
    )
    number, place = equation.cell(cell), equation.place(cell)
    where = f"{what} in cell {number} ({place}) at t = {equation.last_time:.6g}"
    because = f"{reason.rstrip('.')}: " if reason else ""
    return SolveError(f"{method} gave up: {because}{where}", equation.last_time, number)


def _not_finite(rows: Array, names: tuple[str, ...]) -> tuple[int, str] | None:
    bad = ~np.isfinite(rows)
    bad[0, -1] |= bad[2].any(axis=0)  # u on the foot and the outflow belong to the last cell
    surface, layer = bad[0].ravel(), bad[1].ravel()
    cells = np.flatnonzero(surface | layer)
    if cells.size == 0:
        return None
    cell = int(cells[0])
    return cell, f"{names[0] if surface[cell] else names[1]} is not finite"


def _fastest(rates: Array, names: tuple[str, ...]) -> tuple[int, str]:
    flat = rates[:2].reshape(2, -1)
    row, cell = np.unravel_index(np.argmax(np.abs(flat)), flat.shape)
    return int(cell), f"the layers change fastest, {names[row]} = {flat[row, cell]:.3g},"
