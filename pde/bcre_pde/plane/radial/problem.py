"""What is solved about an axis, and what a solution holds; needs neither py-pde nor numba."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from bcre_pde.gate import initial_layers, is_number, require_kind, require_positive
from bcre_pde.material import Material
from bcre_pde.problem import Array

Rim = Literal["open", "closed"]


@dataclass(frozen=True)
class Source:
    """Sand that falls onto a disc about the axis from t = 0 on.

    Parameters
    ----------
    rate: volume/time, > 0.
    radius: of the disc, > 0.
    until: when it ends, > 0; infinite where it does not.
    """

    rate: float
    radius: float
    until: float = math.inf

    def __post_init__(self) -> None:
        for name in ("rate", "radius"):
            require_positive(f"source {name}", getattr(self, name))
        if not (is_number(self.until) and self.until > 0):
            raise ValueError(f"source until = {self.until!r}: must be > 0")


@dataclass(frozen=True)
class Problem:
    """An initial value problem for radially symmetric BCRE.

    Parameters
    ----------
    initial: function of radii r, shape (M,), that returns h and R there.
    material: the coefficients; kappa must be 0.
    radius: the disc is 0 <= r <= radius; finite, > 0.
    rim: ``"open"`` (sand goes over it) or ``"closed"`` (a wall).
    source: what falls onto it, if anything does.
    turning: slope s against which grains have turned back, > 0; steps shorten as sqrt(s).
    """

    initial: Callable[[Array], tuple[Array, Array]]
    material: Material
    radius: float
    rim: Rim = "open"
    source: Source | None = None
    turning: float = 0.05

    def __post_init__(self) -> None:
        require_positive("radius", self.radius)
        require_kind("material", self.material, Material)
        if not callable(self.initial):
            raise ValueError(f"initial = {self.initial!r}: must be a function of r")
        require_positive("turning", self.turning)
        if self.rim not in get_args(Rim):
            raise ValueError(f"rim = {self.rim!r}: must be one of {get_args(Rim)}")
        if self.material.kappa != 0:
            raise ValueError(f"kappa = {self.material.kappa!r}: must be 0 about an axis")
        if self.source is not None and self.source.radius > self.radius:
            raise ValueError(
                f"source radius = {self.source.radius!r}: must be at most that of the disc, "
                f"{self.radius!r}"
            )


@dataclass(frozen=True, eq=False)
class Solution:
    """Means of ``h`` and ``R`` over rings, shape (T, N), about the radii ``r``, at the times ``t``.

    ``supplied`` and ``outflow`` (T,) are volumes, so that ``mass() + outflow - supplied`` does not
    change; ``evaluations`` counts right-hand sides.
    """

    problem: Problem
    r: Array
    t: Array
    h: Array
    R: Array
    supplied: Array
    outflow: Array
    steps: int
    evaluations: int
    wall_s: float

    @property
    def dr(self) -> float:
        """Width of a ring."""
        return self.problem.radius / self.r.size

    def mass(self) -> Array:
        """Volume of sand on the disc at every time, shape (T,)."""
        ring = 2 * math.pi * self.dr * self.r
        frames = zip(self.h, self.R, strict=True)
        return np.array([math.fsum(ring * h) + math.fsum(ring * R) for h, R in frames])


def ring_means(
    layers: Callable[[Array], tuple[Array, Array]], radius: float, cells: int
) -> tuple[Array, Array]:
    """Means of two functions of r over each of the rings, by five Gaussian points in each."""
    nodes, weights = np.polynomial.legendre.leggauss(5)
    r = radius / cells * (np.arange(cells)[:, None] + (nodes + 1) / 2)
    pair = initial_layers(layers(r.ravel()), (r.size,))
    h, R = (layer.reshape(r.shape) for layer in pair)
    weights = r * weights / (r * weights).sum(axis=1, keepdims=True)
    return np.asarray((h * weights).sum(axis=1)), np.asarray((R * weights).sum(axis=1))
