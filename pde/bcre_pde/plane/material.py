"""What the sand on a plane is: the coefficients of BCRE, along the flow and across it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from bcre_pde.gate import require_not_negative
from bcre_pde.material import Material as Line


@dataclass(frozen=True)
class Material:
    """The coefficients of BCRE on a tilted plane, x downhill and y across.

    Parameters
    ----------
    v: drift speed of the rolling layer, length/time, >= 0.
    D_x, D_y: diffusion of the rolling layer along and across the flow, length^2/time, >= 0.
    gamma: exchange rate, 1/time, >= 0.
    Sc: repose slope, tangent of the angle of repose, >= 0.
    kappa_x, kappa_y: curvature terms of the exchange along and across, length/time, >= 0; equal
        ones make kappa R lap h.
    v_up: largest speed of the climbing wave, as in :class:`bcre_pde.Material`.

    Raises
    ------
    ValueError
        naming the parameter, its value and what is allowed.
    """

    v: float
    D_x: float
    D_y: float
    gamma: float
    Sc: float
    kappa_x: float = 0.0
    kappa_y: float = 0.0
    v_up: float = math.inf

    def __post_init__(self) -> None:
        for name in ("D_x", "D_y", "kappa_x", "kappa_y"):
            require_not_negative(name, getattr(self, name))
        self.along  # noqa: B018  what is left is refused there

    @property
    def along(self) -> Line:
        """The material of a column, which is a line."""
        return Line(self.v, self.D_x, self.gamma, self.Sc, self.kappa_x, self.v_up)

    @classmethod
    def isotropic(cls, line: Line) -> Material:
        """Equal diffusion and curvature terms along and across."""
        return cls(line.v, line.D, line.D, line.gamma, line.Sc, line.kappa, line.kappa, line.v_up)
