"""One stretch of time with one of py-pde's solvers: the one place that calls them."""

from __future__ import annotations

import logging
import math
import sys
from functools import partial
from typing import Any

import numpy as np
from pde import FieldCollection
from pde.solvers import ScipySolver
from scipy import sparse

from bcre_pde.bounded import BoundedRungeKutta, layer_scale
from bcre_pde.explicit import FEHLBERG
from bcre_pde.failure import SolveError, failed
from bcre_pde.marched import Marched
from bcre_pde.problem import Method

# Its warnings on the time that trackers take would hide an error message.
logging.getLogger("pde").setLevel(logging.ERROR)


def advance(
    equation: Marched,
    state: FieldCollection,
    span: tuple[float, float],
    method: Method,
    tolerance: float,
) -> tuple[FieldCollection, int]:
    """The state at the end of ``span``, and the steps counted (for SciPy's solvers, evaluations).

    Raises
    ------
    SolveError
        where the solver gave up, or would need more evaluations than the equation allows.
    """
    largest_R = layer_scale(state[1].data)
    if method == "runge-kutta":
        bound = _bounded_step(equation, largest_R, span)
        least = max(min(1e-10, 1e-10 * bound), 4 * math.ulp(span[1]))
        if not least < bound:
            raise SolveError(
                f"{method}: the stable step {bound:.3g} at t = {span[0]:.6g} is too small to be "
                f"taken, with R up to {largest_R:.3g} in cell {_thickest(equation, state)}",
                span[0],
                _thickest(equation, state),
            )
        solver = partial(BoundedRungeKutta, dt_max=bound, dt_min=least, tolerance=tolerance)
        first = min(bound, span[1] - span[0])
    else:
        absolute = max(tolerance * largest_R, sys.float_info.min)  # 0 would divide 0 by 0
        options: dict[str, Any] = {"rtol": tolerance, "atol": absolute}
        if method == "BDF":
            options["jac_sparsity"] = _jacobian_pattern(state.grid.shape[0])
        solver = partial(ScipySolver, method=method, **options)
        first = None
    try:
        with np.errstate(**_silenced()):
            end, info = equation.solve(
                state, span, dt=first, tracker=None, solver=solver, backend="numpy", ret_info=True
            )
    except (RuntimeError, ValueError) as failure:
        raise failed(equation, method, str(failure)) from failure
    if not info["controller"]["successful"]:
        # py-pde returns quietly where it was interrupted.
        raise KeyboardInterrupt
    if not np.isfinite(end.data).all():
        equation.last_time = span[1]
        equation.last_layers = end.data
        raise failed(equation, method)
    return end, info["solver"]["steps"]


def _bounded_step(equation: Marched, largest_R: float, span: tuple[float, float]) -> float:
    """The longest stable step; refused where the evaluations left cannot suffice."""
    bound = equation.largest_explicit_step(largest_R)
    needed = FEHLBERG.weights.size * (span[1] - span[0]) / bound
    if needed > equation.most_evaluations - equation.evaluations:
        raise SolveError(
            f"runge-kutta: steps of at most {bound:.3g}, the stable step with R up to "
            f"{largest_R:.3g}, evaluate the right-hand side {needed:.3g} times from t = "
            f"{span[0]:.6g} to {span[1]:.6g}; {equation.most_evaluations:.6g} are allowed",
            span[0],
        )
    return bound


def _thickest(equation: Marched, state: FieldCollection) -> int | tuple[int, ...]:
    return equation.cell(int(np.argmax(np.abs(state[1].data))))


def _silenced() -> dict[str, Any]:
    """NumPy's settings for overflow and the like, without warnings: the end is checked instead.

    Where the caller asked for an error, it stays one.
    """
    return {kind: "ignore" if how == "warn" else how for kind, how in np.geterr().items()}


def _jacobian_pattern(cells: int) -> sparse.csc_array:
    """Which rates depend on which values: each field on all three, up to three cells away."""
    offsets = [*range(-3, 4), *range(cells - 3, cells), *range(1 - cells, 4 - cells)]
    near = sparse.diags_array([np.ones(cells - abs(offset)) for offset in offsets], offsets=offsets)
    return sparse.kron(np.ones((3, 3)), near, format="csc")


def advance_with_noise(
    equation: Marched, state: FieldCollection, span: tuple[float, float], dt: float
) -> FieldCollection:
    """The state at the end of ``span``, by Euler-Maruyama steps that divide it, about ``dt`` long.

    Raises
    ------
    SolveError
        where the state is no longer finite.
    """
    steps = max(math.ceil((span[1] - span[0]) / dt), 1)
    end: FieldCollection = equation.solve(
        state,
        span,
        dt=(span[1] - span[0]) / steps,
        tracker=None,
        solver="euler",
        adaptive=False,
        backend="numpy",
    )
    if not np.isfinite(end.data).all():
        raise SolveError(f"euler: the surface outgrew all numbers with dt = {dt!r}", span[1])
    return end
