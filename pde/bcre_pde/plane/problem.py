"""What is solved on a plane, and what a solution holds; needs neither py-pde nor compiled code."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np

from bcre_pde.gate import is_finite, is_number, require_kind, require_positive, whole
from bcre_pde.plane.material import Material
from bcre_pde.problem import SMALLEST_GRID, Array, Ends

Sides = Literal["periodic", "closed"]

SMALLEST_ALONG, SMALLEST_ACROSS = SMALLEST_GRID, 3
"""Fewer cells do not hold the stencils."""


@dataclass(frozen=True)
class Problem:
    """An initial value problem for BCRE on a tilted plane.

    Parameters
    ----------
    initial: function of positions x and y, two arrays of one shape, that returns h and R there.
    material: the coefficients.
    length, width: the plane is 0 <= x <= length, x running downhill, and 0 <= y <= width across;
        finite, > 0.
    ends: ``"open"`` (closed top, open foot) or ``"periodic"`` (in h + Sc x and R).
    sides: ``"periodic"`` or ``"closed"``: mirrors, through which nothing passes.
    thickness: of the erodible layer on a rigid base, a length > 0; infinite without one.
    grain: the last part of a finite layer, which is eroded the slower the less is left of it (see
        :mod:`bcre_pde.plane.bed`); left out, a tenth of the thickness.

    Raises
    ------
    ValueError
        naming the parameter, its value and what is allowed.
    """

    initial: Callable[[Array, Array], tuple[Array, Array]]
    material: Material
    length: float
    width: float
    ends: Ends = "open"
    sides: Sides = "periodic"
    thickness: float = math.inf
    grain: float | None = None

    def __post_init__(self) -> None:
        for name in ("length", "width"):
            require_positive(name, getattr(self, name))
        if not callable(self.initial):
            raise ValueError(f"initial = {self.initial!r}: must be a function of x and y")
        require_kind("material", self.material, Material)
        if not (is_number(self.thickness) and self.thickness > 0):
            raise ValueError(f"thickness = {self.thickness!r}: must be > 0")
        if self.grain is not None and not (
            is_finite(self.grain) and 0 < self.grain <= self.thickness
        ):
            raise ValueError(f"grain = {self.grain!r}: must be > 0 and at most the thickness")
        for name, allowed in (("ends", get_args(Ends)), ("sides", get_args(Sides))):
            value = getattr(self, name)
            if value not in allowed:
                raise ValueError(f"{name} = {value!r}: must be one of {allowed}")


@dataclass(frozen=True, eq=False)
class Frame:
    """Layers ``h``, ``R`` (Nx, Ny) at the time ``t``; ``outflow``: the volume that has left."""

    t: float
    h: Array
    R: Array
    outflow: float


@dataclass(frozen=True, eq=False)
class Solution:
    """Layers at the cell centres ``x`` (Nx,), ``y`` (Ny,) and the times ``t`` (T,).

    ``h`` and ``R`` have the shape (T, Nx, Ny). ``outflow`` (T,) is the volume that has left through
    the foot, so that ``dx dy sum(h + R) + outflow`` does not change; ``evaluations`` counts
    right-hand sides.
    """

    problem: Problem
    x: Array
    y: Array
    t: Array
    h: Array
    R: Array
    outflow: Array
    steps: int
    evaluations: int
    wall_s: float

    @property
    def dx(self) -> float:
        """Cell length along."""
        return self.problem.length / self.x.size

    @property
    def dy(self) -> float:
        """Cell length across."""
        return self.problem.width / self.y.size

    @property
    def u(self) -> Array:
        """Height above the repose plane, h + Sc x, shape (T, Nx, Ny)."""
        return self.h + self.problem.material.Sc * self.x[:, None]

    def mass(self) -> Array:
        """Volume of sand on the plane at every time, shape (T,)."""
        cell = self.dx * self.dy
        frames = zip(self.h, self.R, strict=True)
        return np.array([cell * (math.fsum(h.flat) + math.fsum(R.flat)) for h, R in frames])


def checked_cells(cells: Any) -> tuple[int, int]:
    """A grid that holds the stencils; ValueError where it does not."""
    try:
        along, across = cells
    except (TypeError, ValueError):
        raise ValueError(f"cells = {cells!r}: must be two numbers, along and across") from None
    return (
        whole("cells along", along, SMALLEST_ALONG),
        whole("cells across", across, SMALLEST_ACROSS),
    )
