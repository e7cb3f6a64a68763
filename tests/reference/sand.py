"""What the plain integrations are told of the sand; nothing here comes from the packages tested."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Sand:
    """The coefficients of BCRE: u = h + Sc x, X(R) = R/(1 + gamma R/v_up)."""

    v: float
    D: float
    gamma: float
    Sc: float
    kappa: float = 0.0
    v_up: float = math.inf

    def exchanging(self, R):
        """X(R), the part of a layer that exchanges: all of it, if v_up is infinite."""
        return R / (1.0 + self.gamma * R / self.v_up)
