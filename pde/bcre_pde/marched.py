"""What the solvers need of an equation: it is counted, bounded, and can name its cells."""

from __future__ import annotations

import math
from abc import abstractmethod

import numpy as np
from pde import FieldCollection, PDEBase

from bcre_pde import sums
from bcre_pde.problem import Array

DOUBLE = np.dtype(np.float64)
"""The one object that every array of native double precision has as its type."""


class Marched(PDEBase):  # type: ignore[misc]
    """An equation for three fields: the surface u, the rolling layer R, and "ends".

    The third field is an account of the ends of the domain. As part of the state it is integrated
    by the same solver, so that mass is conserved to rounding.

    Parameters
    ----------
    state: any state; gives the grid and the names of the fields.
    most_evaluations: how often the right-hand side may be evaluated.
    """

    explicit_time_dependence = False
    fields = ("u", "R")
    """What the first two are called."""
    weighted_sum = staticmethod(sums.weighted_sum)
    """How the stages of a Runge-Kutta step are summed."""

    def __init__(self, state: FieldCollection, most_evaluations: float = math.inf) -> None:
        super().__init__()
        self.evaluations = 0
        self.most_evaluations = most_evaluations
        self.last_time = 0.0
        self.step_error = math.nan
        self._layers = np.zeros(state.data.shape)
        self.last_layers = self._layers
        self._rates = state.copy()
        # The data of a field leave gaps for ghost cells: compiled code would be compiled once more.
        self._without_gaps = np.zeros(state.data.shape)

    @abstractmethod
    def rate(self, layers: Array, out: Array) -> None:
        """Write the time derivative of the fields, shape (3, ...), into ``out``."""

    @abstractmethod
    def largest_explicit_step(self, largest_R: float) -> float:
        """Step at which an explicit Runge-Kutta method of order 4 is still stable."""

    @abstractmethod
    def place(self, cell: int) -> str:
        """Where a cell lies, in words; ``cell`` is its number in memory."""

    def cell(self, cell: int) -> int | tuple[int, ...]:
        """What a user calls that cell."""
        return cell

    def evolution_rate(self, state: FieldCollection, t: float = 0) -> FieldCollection:
        """The right-hand side, in one field that every call overwrites (py-pde copies it)."""
        # A copy: SciPy may reuse its memory before a failure is reported.
        np.copyto(self._layers, state.data)
        self.write_rate(self._layers, self._without_gaps, t)
        np.copyto(self._rates.data, self._without_gaps)
        return self._rates

    def write_rate(self, layers: Array, out: Array, t: float = 0) -> None:
        """:meth:`rate`, counted.

        Raises
        ------
        RuntimeError
            at the first call after ``most_evaluations``.
        ValueError
            for arrays of another shape or type than the state's, which compiled code would take
            for it.
        """
        shape = self._layers.shape
        if layers.shape != shape or layers.dtype is not DOUBLE:
            raise _not_a_state("layers", layers, shape)
        if out.shape != shape or out.dtype is not DOUBLE:
            raise _not_a_state("out", out, shape)
        self.evaluations += 1
        self.last_time = t
        self.last_layers = layers
        if self.evaluations > self.most_evaluations:
            raise RuntimeError(
                f"the right-hand side was evaluated {self.most_evaluations:.6g} times, the most "
                "that is allowed"
            )
        self.rate(layers, out)


def _not_a_state(name: str, array: Array, shape: tuple[int, ...]) -> ValueError:
    return ValueError(
        f"{name} has the shape {array.shape} and the type {array.dtype}: must be {shape} "
        "and float64"
    )
