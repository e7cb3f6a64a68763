r"""What the pilots of a model predict: its error, its steps and how many cells it needs.

Between two pilots the error and the steps are interpolated, log in log of the cells N. Beyond the
last of them

    error(N) = e (N/N_last)^-p       p the order observed last, at most the model's own
    steps(N) = a + b N + c N^2       a, b, c >= 0: exchange, drift and climb, diffusion
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import nnls

from bcre_studies.models.registry import CANDIDATES
from bcre_studies.scenes.domain import Array

ORDER = dict(zip(CANDIDATES, (1.0, 2.0, 2.0, 5.0), strict=True))
"""The order that a model can reach where the layers are smooth."""

LEAST_ORDER = 0.3
"""A model that shows less does not converge as far as the pilots can see."""

FARTHEST = 16.0
"""Errors are extrapolated to grids at most this many times finer than a pilot."""

HALF = 0.5
"""Nor from pilots that are more than half wrong: the error does not fall as a power of d yet."""

SAFETY, FEW_SAFETY = 1.25, 3.0
"""By what a predicted error is multiplied: the second beyond the pilots, unless two pairs of them
show one order (Roache 1994, for three grids and for two)."""

SAME_ORDER = 0.5
"""Orders that differ by no more are one."""

SMALLEST = 1e-12
"""Stands for an error of zero where logarithms are taken."""


@dataclass(frozen=True)
class Pilot:
    """One short run: its cells, steps and seconds, and its error against the reference."""

    cells: int
    steps: int
    wall_s: float
    error: float


@dataclass(frozen=True)
class Candidate:
    """A model with at least two pilots, coarsest first.

    ``converges``: whether finer cells bring it to BCRE with the scene's own material at all.
    """

    model: str
    pilots: tuple[Pilot, ...]
    converges: bool = True

    @property
    def finest(self) -> int:
        """Cells of the finest pilot."""
        return self.pilots[-1].cells

    @property
    def order(self) -> float:
        """Order to be expected of finer cells: that of the last two pilots, at most its own.

        0 where their error does not fall, or is more than :data:`HALF`.
        """
        coarse, fine = self.pilots[-2:]
        if not self.converges or not fine.error < coarse.error <= HALF:
            return 0.0
        return min(_order(coarse, fine), ORDER[self.model])

    def safety(self, cells: int) -> float:
        """By what the predicted error is to be multiplied."""
        if cells <= self.finest:
            return SAFETY
        pairs = itertools.pairwise(self.pilots[-3:])
        orders = [_order(coarse, fine) for coarse, fine in pairs]
        one = len(orders) == 2 and abs(orders[0] - orders[1]) <= SAME_ORDER
        return SAFETY if one else FEW_SAFETY

    def with_pilot(self, pilot: Pilot) -> Candidate:
        """With one more pilot, in its place."""
        return replace(self, pilots=tuple(sorted((*self.pilots, pilot), key=lambda p: p.cells)))

    def has_pilot(self, cells: int) -> bool:
        """Whether it was run on just so many cells."""
        return any(pilot.cells == cells for pilot in self.pilots)

    def error(self, cells: int) -> float:
        """Predicted error; on fewer cells than the coarsest pilot has, that of the coarsest."""
        if cells > self.finest:
            return self.pilots[-1].error * math.pow(cells / self.finest, -self.order)
        return self._between([max(pilot.error, SMALLEST) for pilot in self.pilots], cells)

    def steps(self, cells: int) -> float:
        """Predicted steps."""
        steps = [float(max(pilot.steps, 1)) for pilot in self.pilots]
        if cells <= self.finest:
            return self._between(steps, cells)
        powers = _powers([pilot.cells for pilot in self.pilots]) / np.array(steps)[:, None]
        terms, _ = nnls(powers, np.ones(len(steps)))
        return float(_powers([cells])[0] @ terms)

    def _between(self, values: Sequence[float], cells: int) -> float:
        grids = [pilot.cells for pilot in self.pilots]
        if not np.isfinite(values).all():
            return values[int(np.searchsorted(grids, cells))]
        return float(np.exp(np.interp(math.log(cells), np.log(grids), np.log(values))))

    def cells_for(self, allowed: float) -> int | None:
        """Fewest cells, rounded up to two digits, from which on safety error <= ``allowed``.

        None where it comes there nowhere, or beyond :data:`FARTHEST` times the finest pilot only.
        """
        within = allowed / SAFETY
        above = [i for i, pilot in enumerate(self.pilots) if not pilot.error <= within]
        if not above:
            return self.pilots[0].cells
        if above[-1] + 1 < len(self.pilots):
            coarse, fine = self.pilots[above[-1] : above[-1] + 2]
            return min(_rounded_up(_crossing(coarse, fine, within)), fine.cells)
        if self.order < LEAST_ORDER:
            return None
        beyond = self.safety(self.finest + 1) * self.pilots[-1].error / allowed
        ratio = math.pow(beyond, 1 / self.order)
        return _rounded_up(self.finest * ratio) if ratio <= FARTHEST else None


def _order(coarse: Pilot, fine: Pilot) -> float:
    """Order by which the error falls from one pilot to the next."""
    fall = math.log(max(coarse.error, SMALLEST) / max(fine.error, SMALLEST))
    return fall / math.log(fine.cells / coarse.cells)


def _powers(cells: Sequence[int]) -> Array:
    N = np.array(cells, dtype=float)
    return np.stack([np.ones_like(N), N, N**2], axis=1)


def _crossing(coarse: Pilot, fine: Pilot, allowed: float) -> float:
    """Cells between two pilots at which the error passes ``allowed``."""
    if not math.isfinite(coarse.error) or fine.error < SMALLEST:  # nothing to interpolate in
        return float(fine.cells)
    part = math.log(coarse.error / allowed) / math.log(coarse.error / fine.error)
    return float(coarse.cells * (fine.cells / coarse.cells) ** part)


def _rounded_up(cells: float) -> int:
    unit: int = 10 ** max(math.floor(math.log10(cells)) - 1, 0)
    return math.ceil(cells / unit * (1 - 1e-9)) * unit
