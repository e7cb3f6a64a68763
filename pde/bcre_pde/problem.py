"""What is solved, and what a solution holds; needs neither py-pde nor compiled code."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from bcre_pde.gate import require_positive
from bcre_pde.material import Material
from bcre_pde.source import Source, require_on_line

if TYPE_CHECKING:
    from pde import FieldCollection, MemoryStorage

Array = NDArray[np.float64]
Ends = Literal["open", "wall", "periodic"]
Method = Literal["runge-kutta", "RK45", "DOP853", "LSODA", "BDF"]

SMALLEST_GRID = 8
"""Fewer cells do not hold the stencils next to both ends."""


@dataclass(frozen=True)
class Problem:
    """An initial value problem.

    Parameters
    ----------
    initial: function of positions x, shape (N,), that returns h and R there, lengths.
    material: the coefficients; of a further model its own, which have an Sc.
    length: the domain is 0 <= x <= length, x running downhill; finite, > 0.
    ends: ``"open"`` (closed top, open foot), ``"wall"`` (closed top, a wall at the foot) or
        ``"periodic"`` (in h + Sc x and R).
    sources: sand that is poured on the way.

    Raises
    ------
    ValueError
        naming the parameter, its value and what is allowed.
    """

    initial: Callable[[Array], tuple[Array, Array]]
    material: Material | Any
    length: float
    ends: Ends = "open"
    sources: tuple[Source, ...] = ()

    def __post_init__(self) -> None:
        if not callable(self.initial):
            raise ValueError(f"initial = {self.initial!r}: must be a function of x")
        require_positive("length", self.length)
        if self.ends not in get_args(Ends):
            raise ValueError(f"ends = {self.ends!r}: must be one of {get_args(Ends)}")
        require_on_line(self.sources, self.length)


@dataclass(frozen=True, eq=False)
class Solution:
    """Layers at the cell centres ``x`` (N,) and times ``t`` (T,): ``h``, ``R`` of shape (T, N).

    ``outflow`` (T,) is the area that has left through the foot, so that
    ``dx sum(h + R) + outflow - inflow`` does not change; ``evaluations`` counts right-hand sides.
    ``step_error`` is the sum of the largest local errors of all steps in time, each relative to the
    thickest layer then: times the layer at the end, it bounds what the steps add to the mean errors
    of R and of h. It is not a number for SciPy's methods, which do not tell theirs.
    """

    problem: Problem
    x: Array
    t: Array
    h: Array
    R: Array
    outflow: Array
    steps: int
    evaluations: int
    wall_s: float
    step_error: float = math.nan

    @property
    def dx(self) -> float:
        """Cell length."""
        return self.problem.length / self.x.size

    @property
    def inflow(self) -> Array:
        """Area that the sources have poured by every time, shape (T,)."""
        return np.array([math.fsum(s.poured(t) for s in self.problem.sources) for t in self.t])

    @property
    def u(self) -> Array:
        """Height above the repose line, h + Sc x, shape (T, N)."""
        return self.h + self.problem.material.Sc * self.x

    def field(self, frame: int = -1) -> FieldCollection:
        """h and R of one frame as py-pde's fields of these names on a Cartesian grid.

        >>> import numpy as np, bcre_pde
        >>> still = lambda x: (-0.5 * x, np.zeros_like(x))
        >>> material = bcre_pde.Material(v=1.0, D=0.1, gamma=0.1, Sc=0.5)
        >>> problem = bcre_pde.Problem(still, material, length=10.0)
        >>> solution = bcre_pde.solve(problem, times=[0, 1], cells=8)
        >>> solution.field().labels, solution.field()["R"].grid.shape
        (['h', 'R'], (8,))
        """
        from pde import CartesianGrid, FieldCollection, ScalarField

        periodic = self.problem.ends == "periodic"
        grid = CartesianGrid([[0, self.problem.length]], self.x.size, periodic=periodic)
        layers = {"h": self.h[frame], "R": self.R[frame]}
        return FieldCollection([ScalarField(grid, row, label=name) for name, row in layers.items()])

    def storage(self) -> MemoryStorage:
        """All frames as py-pde's storage, for its plots, films and files."""
        from pde import MemoryStorage

        return MemoryStorage.from_fields(self.t, [self.field(k) for k in range(self.t.size)])

    def mass(self) -> Array:
        """Area of sand in the domain at every time, shape (T,)."""
        rows = zip(self.h, self.R, strict=True)
        return np.array([self.dx * (math.fsum(h) + math.fsum(R)) for h, R in rows])
