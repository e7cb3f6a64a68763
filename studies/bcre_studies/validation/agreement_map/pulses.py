"""One pulse on one slope by the dimensionless groups that decide what becomes of it.

Of v, D, gamma, S0 - Sc, the pulse's amplitude A and width w, d, dt and the time t, six groups are
left when the units are chosen: Sc merely tilts the picture.

    Pe = v d/D    c = v dt/d    G = gamma (S0 - Sc) t    a = gamma A/v    m = w/d    T = v t/w
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from bcre_studies.scenes.scene import Scene

LARGEST_WEIGHT = (0.2, 0.9)
"""Range of v dt/d + 2 D dt/d^2, of which R >= 0 needs that it is at most 1."""

MARGIN = 5.0
"""Standard deviations of the spread pulse between it and the ends of the slope."""


@dataclass(frozen=True)
class Pulse:
    """The groups of one scene; see the module.

    Parameters
    ----------
    peclet, courant, growth, thickness, cells_a_width, reach: Pe, c, G, a, m and T.
    """

    peclet: float
    courant: float
    growth: float
    thickness: float
    cells_a_width: float
    reach: float

    @property
    def duration(self) -> float:
        """v t/d, how many cells the pulse drifts through."""
        return self.reach * self.cells_a_width

    @property
    def steps(self) -> int:
        """Steps of the automaton, of which the last one ends at t."""
        return max(round(self.duration / self.courant), 1)

    @property
    def final_variance(self) -> float:
        """s^2 = w^2/2 + 2 D t of BCRE's thin pulse at the end, in d^2."""
        return self.cells_a_width**2 / 2 + 2 * self.duration / self.peclet

    @property
    def broadening(self) -> float:
        """r = v d (1 - c) t/s^2: what the automaton's own diffusion adds, in parts of s^2."""
        return (1 - self.duration / self.steps) * self.duration / self.final_variance

    @property
    def final_thickness(self) -> float:
        """a e^G where the pulse grows: how thick it becomes."""
        return self.thickness * math.exp(max(self.growth, 0.0))


RANGES = {
    "peclet": (0.05, 20.0, "log"),
    "cells_a_width": (2.0, 20.0, "log"),
    "reach": (0.5, 10.0, "log"),
    "thickness": (1e-4, 1.0, "log"),
    "growth": (-2.0, 4.0, "linear"),
    "largest_weight": (*LARGEST_WEIGHT, "linear"),
}


def drawn(count: int, seed: int) -> list[Pulse]:
    """So many pulses from a Latin hypercube of :data:`RANGES`."""
    from scipy.stats import qmc

    cube = qmc.LatinHypercube(len(RANGES), rng=np.random.default_rng(seed)).random(count)
    return [_pulse(dict(zip(RANGES, point, strict=True))) for point in cube.tolist()]


def _pulse(parts: dict[str, float]) -> Pulse:
    values = {name: _within(RANGES[name], part) for name, part in parts.items()}
    weight = values.pop("largest_weight")
    return Pulse(courant=weight / (1 + 2 / values["peclet"]), **values)


def _within(limits: tuple[float, float, str], part: float) -> float:
    low, high, scale = limits
    return low * (high / low) ** part if scale == "log" else low + (high - low) * part


def scene_of(pulse: Pulse) -> Scene:
    """The pulse in units of d = v = 1 with gamma = 1/w, on a slope that it does not leave."""
    w, t = pulse.cells_a_width, pulse.duration
    gamma, D = 1 / w, 1 / pulse.peclet
    excess = pulse.growth / (gamma * t)
    spread = MARGIN * math.sqrt(w**2 / 2 + (2 * D + 1) * t)
    # A growing packet's edges run ahead of its centre at 2 (D sigma)^(1/2).
    ahead = 2 * math.sqrt((D + 0.5) * max(pulse.growth, 0.0) * t)
    centre = spread + ahead
    cells = math.ceil(centre + t + spread + ahead)
    return Scene.model_validate(
        {
            "title": "A pulse by its dimensionless groups",
            "material": {"v": 1.0, "D": D, "gamma": gamma, "Sc": max(-excess, 0.0)},
            "domain": {"length": float(cells), "cells": cells, "ends": "open"},
            "time": {"until": t, "step": t / pulse.steps},
            "surface": [{"kind": "incline", "slope": max(excess, 0.0)}],
            "rolling": [
                {
                    "kind": "gaussian",
                    "amplitude": pulse.thickness / gamma,
                    "centre": centre,
                    "width": w,
                }
            ],
        }
    )
