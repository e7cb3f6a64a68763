"""What stays the same during a run on a plane: the rule, the flow, ends, walls, base, sources."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from bcre_ca.gate import is_finite, require_kind, require_not_negative
from bcre_ca.plane.coefficients import Coefficients, fold
from bcre_ca.plane.sources import Source
from bcre_ca.rule import Rule

Array = NDArray[np.float64]
Flows = Literal["tilted", "split4", "facet8", "d8"]
Ends = Literal["open", "closed", "periodic"]
Sides = Literal["closed", "periodic"]


ON_PLANE = {"order": "synchronous", "scheme": "upwind", "kappa": 0.0, "Gamma": 0.0, "beta": 0.0}
"""What a rule must have on a plane."""


@dataclass(frozen=True, eq=False)
class Plane:
    """Cells (i, j) of side d: i counts along x, downhill on a tilted plane, and j across.

    Parameters
    ----------
    rule: the automaton's parameters, as on a line: synchronous, upwind, without curvature.
    flow: ``"tilted"``: sand flows along x and diffuses across. On a free surface it takes the
        steepest descent: ``"split4"`` shares it out among the lower ones of four neighbours,
        ``"facet8"`` follows the steepest of eight triangular facets, ``"d8"`` goes straight to one
        of eight neighbours. ``"d8"`` does not converge as d goes to 0: its heaps are octagons.
    D_across: diffusion across x, length^2/time, >= 0; left out, ``rule.D``.
    ends: of x. ``"open"`` has a closed top and an open foot, beyond which the surface goes on at
        the repose slope; ``"closed"`` closes the foot too; ``"periodic"`` joins them.
    sides: ``"closed"`` or ``"periodic"`` across.
    walls: cells that hold no sand, True or False, of the layers' shape. A wall and a closed side
        mirror the surface: it does not drop towards them, and nothing flows through.
    base: rigid ground, a length or an array of the layers' shape: no sand is eroded below it.
    sources: where sand is poured.
    fall: by how much h falls over one period where the ends are periodic, a length; left out, that
        of the repose line on a tilted plane and 0 on a free surface.
    """

    rule: Rule
    flow: Flows = "tilted"
    D_across: float | None = None
    ends: Ends = "open"
    sides: Sides = "closed"
    walls: NDArray[np.bool_] | None = None
    base: Array | float | None = None
    sources: tuple[Source, ...] = ()
    fall: float | None = None

    def __post_init__(self) -> None:
        for name, allowed in (("flow", Flows), ("ends", Ends), ("sides", Sides)):
            value = getattr(self, name)
            if value not in get_args(allowed):
                raise ValueError(f"{name} = {value!r}: must be one of {get_args(allowed)}")
        require_kind("rule", self.rule, Rule)
        for name, needed in ON_PLANE.items():
            value = getattr(self.rule, name)
            if value != needed:
                raise ValueError(f"{name} = {value!r}: must be {needed!r} on a plane")
        if self.D_across is not None:
            require_not_negative("D_across", self.D_across)
        if self.fall is not None and not is_finite(self.fall):
            raise ValueError(f"fall = {self.fall!r}: must be a finite number")
        self._require_arrays()
        object.__setattr__(self, "sources", tuple(self.sources))
        if not all(isinstance(source, Source) for source in self.sources):
            raise ValueError(f"sources = {self.sources!r}: must be of the kind Source")

    def _require_arrays(self) -> None:
        if self.walls is not None:
            walls = np.asarray(self.walls)
            if walls.dtype != np.bool_ or walls.ndim != 2:
                raise ValueError(
                    f"walls has the type {walls.dtype} and the shape {walls.shape}: must be True "
                    "or False for each cell"
                )
        if self.base is not None:
            base = np.asarray(self.base)
            if base.dtype.kind not in "fiu" or base.ndim not in (0, 2) or np.isnan(base).any():
                raise ValueError(
                    f"base has the type {base.dtype} and the shape {base.shape}: must be a number, "
                    "or one for each cell"
                )

    @property
    def across(self) -> float:
        """Diffusion across x."""
        return self.rule.D if self.D_across is None else float(self.D_across)

    def coefficients(self, dtype: Any = np.float64, dt: float | None = None) -> Coefficients:
        """The constants of a step of ``rule.dt``, or of another one."""
        return fold(self.rule, self.across, self.flow, dtype, self.rule.dt if dt is None else dt)

    def fall_of(self, rows: int) -> float:
        """By how much h falls over a period of so many rows."""
        if self.fall is not None:
            return float(self.fall)
        return self.rule.Sc * self.rule.d * rows if self.flow == "tilted" else 0.0

    def free(self, shape: tuple[int, ...]) -> NDArray[np.bool_]:
        """Which cells can hold sand."""
        return np.ones(shape, bool) if self.walls is None else ~np.asarray(self.walls)
