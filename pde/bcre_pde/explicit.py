r"""Explicit Runge-Kutta methods by their coefficients, and their stages without allocation.

    k_i = dt f(t + c_i dt, y + sum_j a_ij k_j)        y(t + dt) = y + sum_i b_i k_i

Every sum runs from its first term to its last, as in the formulae of py-pde, so that the compiled
ones of :mod:`bcre_pde.sums` give the same numbers to the bit.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple, get_args

import numpy as np

from bcre_pde.problem import Array

if TYPE_CHECKING:
    from bcre_pde.marched import Marched

ExplicitMethod = Literal["runge-kutta", "RK45", "DOP853"]


class Tableau(NamedTuple):
    """a_ij (s, s), strictly lower; b_i (s,), of the solution that is kept; c_i (s,)."""

    increments: Array
    weights: Array
    nodes: Array


FEHLBERG = Tableau(
    np.array(
        [
            [0, 0, 0, 0, 0, 0],
            [1 / 4, 0, 0, 0, 0, 0],
            [3 / 32, 9 / 32, 0, 0, 0, 0],
            [1932 / 2197, -7200 / 2197, 7296 / 2197, 0, 0, 0],
            [439 / 216, -8.0, 3680 / 513, -845 / 4104, 0, 0],
            [-8 / 27, 2.0, -3544 / 2565, 1859 / 4104, -11 / 40, 0],
        ]
    ),
    np.array([25 / 216, 0, 1408 / 2565, 2197 / 4104, -1 / 5, 0]),
    np.array([0, 1 / 4, 3 / 8, 12 / 13, 1, 1 / 2]),
)
"""Fehlberg's fourth-order formula, which py-pde's adaptive solver keeps (formula 2, Table III)."""

FEHLBERG_ERROR = np.array([1 / 360, 0, -128 / 4275, -2197 / 75240, 1 / 50, 2 / 55])
"""Weights of its error estimate, the fifth-order formula less the fourth-order one."""


def tableau(method: ExplicitMethod) -> Tableau:
    """The coefficients of a method of :func:`bcre_pde.solve`; SciPy's from its own classes.

    Raises
    ------
    ValueError
        naming the methods that are explicit and so have a bound on their step.
    """
    if method not in get_args(ExplicitMethod):
        raise ValueError(f"method = {method!r}: must be explicit, {get_args(ExplicitMethod)}")
    if method == "runge-kutta":
        return FEHLBERG
    from scipy import integrate  # late: slow to import

    solver = getattr(integrate, method)
    stages = solver.n_stages
    increments = np.zeros((stages, stages))
    known = solver.A[:stages, :stages]
    increments[:, : known.shape[1]] = known
    return Tableau(increments, np.asarray(solver.B), np.asarray(solver.C[:stages]))


class Step:
    """One step of fixed length, in memory that is allocated once.

    Parameters
    ----------
    equation: whose right-hand side is evaluated.
    method: the coefficients.
    """

    def __init__(self, equation: Marched, method: Tableau) -> None:
        shape = equation.last_layers.shape
        self._equation = equation
        self._method = method
        self._stage = np.zeros(shape)
        self.increments = np.zeros((method.weights.size, *shape))

    def __call__(self, layers: Array, t: float, dt: float, new: Array) -> None:
        """Write y(t + dt) into ``new``; ``layers`` and ``new`` have shape (3, ...)."""
        increments, weights, nodes = self._method
        add = self._equation.weighted_sum
        for i in range(weights.size):
            add(layers, self.increments, increments[i], i, dt, self._stage)
            self._equation.write_rate(self._stage, self.increments[i], t + nodes[i] * dt)
        add(layers, self.increments, weights, weights.size, dt, new)
