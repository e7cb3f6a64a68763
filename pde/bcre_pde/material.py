"""What the sand is: the coefficients of BCRE, on a line as on a plane."""

from __future__ import annotations

import math
from dataclasses import dataclass

from bcre_pde.gate import is_number, require_not_negative


@dataclass(frozen=True)
class Material:
    """The coefficients of BCRE.

    Parameters
    ----------
    v: drift speed of the rolling layer, length/time, >= 0.
    D: diffusion of the rolling layer, length^2/time, >= 0.
    gamma: exchange rate, 1/time, >= 0.
    Sc: repose slope, tangent of the angle of repose, >= 0.
    kappa: curvature term of the exchange, length/time, >= 0.
    v_up: largest speed of the climbing wave, length/time, > 0: for thick flows, in which only the
        grains next to the static layer exchange, gamma R becomes gamma R/(1 + gamma R/v_up)
        (Boutreux, Raphaël and de Gennes 1998). Infinite, the default, is the linear law.
    Gamma: velocity gradient of a thick rolling layer, 1/time, >= 0: it carries v R + Gamma R^2/2
        (see :mod:`bcre_pde.line.aradian`).

    Raises
    ------
    ValueError
        naming the parameter, its value and what is allowed.
    """

    v: float
    D: float
    gamma: float
    Sc: float
    kappa: float = 0.0
    v_up: float = math.inf
    Gamma: float = 0.0

    @property
    def saturation(self) -> float | None:
        """gamma/v_up, or None for the linear exchange law."""
        return None if math.isinf(self.v_up) else self.gamma / self.v_up

    def __post_init__(self) -> None:
        for name in ("v", "D", "gamma", "Sc", "kappa", "Gamma"):
            require_not_negative(name, getattr(self, name))
        if not (is_number(self.v_up) and self.v_up > 0):
            raise ValueError(f"v_up = {self.v_up!r}: must be > 0")
