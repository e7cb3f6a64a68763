"""py-pde's adaptive Runge-Kutta-Fehlberg solver, bounded as BCRE needs it."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from pde import FieldCollection
from pde.solvers import RungeKuttaSolver

from bcre_pde.explicit import FEHLBERG, FEHLBERG_ERROR, Step
from bcre_pde.marched import Marched
from bcre_pde.problem import Array


def layer_scale(R: Array) -> float:
    """Largest |R|, or 1 where there is no layer at all: what errors are relative to."""
    return float(np.abs(R).max()) or 1.0


class BoundedRungeKutta(RungeKuttaSolver):  # type: ignore[misc]
    """py-pde's adaptive Runge-Kutta-Fehlberg solver with five changes.

    * Its error is relative to the largest rolling layer of the moment, which may grow from 1e-150.
    * Its step never exceeds ``dt_max``. Otherwise the step would grow fourfold wherever nothing
      happens, until rounding errors have been amplified to the size of the tolerance.
    * It adds the errors of its steps up, in the ``step_error`` of the equation.
    * It gives up below ``dt_min``: py-pde's 1e-10 would be a long step where times are short.
    * Its stages are those of :class:`bcre_pde.explicit.Step`: the same numbers in less time.
    """

    name = "bounded runge-kutta"

    def __init__(self, pde: Marched, *, dt_max: float, dt_min: float, **options: Any) -> None:
        super().__init__(pde, adaptive=True, **options)
        self.dt_max = dt_max
        self.dt_min = dt_min

    def _make_single_step_error_estimate(self, state: FieldCollection) -> Callable[..., Any]:
        step = Step(self.pde, FEHLBERG)
        start, new, error, nothing = (np.zeros(state.data.shape) for _ in range(4))
        add = self.pde.weighted_sum
        errors = _AddedUp(self.pde)

        def relative_single_step(data: Array, t: float, dt: float) -> tuple[Array, float]:
            np.copyto(start, data)  # py-pde's data lie between ghost cells, with gaps
            step(start, t, dt, new)
            add(nothing, step.increments, FEHLBERG_ERROR, FEHLBERG_ERROR.size, 1.0, error)
            relative = float(np.abs(error, out=error).max()) / layer_scale(new[1])
            errors.tried(t, relative)
            return new, relative

        return relative_single_step


class _AddedUp:
    """Adds the errors of accepted steps up: a step is tried again at the same time until it is."""

    def __init__(self, equation: Marched) -> None:
        self._equation = equation
        self._before = 0.0 if math.isnan(equation.step_error) else equation.step_error
        self._time = math.nan
        self._last = 0.0

    def tried(self, t: float, error: float) -> None:
        if t != self._time:
            self._before += self._last
        self._time, self._last = t, error
        self._equation.step_error = self._before + error
