"""How far apart two numbers or profiles are."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from bcre_studies.models.run import Run
from bcre_studies.scenes.domain import Array


def size(value: ArrayLike) -> float:
    """mean|value|: of a profile the area under it, divided by its length."""
    return float(np.mean(np.abs(value)))


def difference(one: ArrayLike, other: ArrayLike) -> float:
    """mean|one - other|: of profiles the L1 difference, divided by their length."""
    return size(np.asarray(one) - np.asarray(other))


def relative_difference(automaton: ArrayLike, pde: ArrayLike, scale: float | None = None) -> float:
    """mean|automaton - pde| / mean|pde|: for profiles the relative L1 difference.

    Numbers that may vanish are compared relative to ``scale`` instead.
    """
    whole = size(pde) if scale is None else scale
    gap = difference(automaton, pde)
    return gap / whole if whole > 0 else (0.0 if gap == 0 else math.inf)


def sample(run: Run, x: Array, field: str = "R", frame: int = -1) -> Array:
    """``run.R`` or ``run.u`` of one frame at positions x, by a quintic spline between cells."""
    from scipy.interpolate import make_interp_spline  # late: slow to import

    values = getattr(run, field)[frame]
    if values.size == x.size and np.allclose(run.x, x, rtol=0, atol=1e-9 * run.d):
        return np.asarray(values)
    positions = run.x
    if run.scene.domain.ends == "periodic":
        length, wrap = run.scene.domain.length, 4
        positions = np.concatenate(
            [positions[-wrap:] - length, positions, positions[:wrap] + length]
        )
        values = np.concatenate([values[-wrap:], values, values[:wrap]])
    return np.asarray(make_interp_spline(positions, values, k=5)(x))
