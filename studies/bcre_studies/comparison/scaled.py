"""Comparing several numbers of the same runs, each relative to a scale of its own.

For quantities that may vanish: the rate of a decay that fails, a front that stands still.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

import bcre_pde
from bcre_studies.comparison.compare import Comparison, significant, to_error
from bcre_studies.models.bcre import SHARE, problem_of, run_of
from bcre_studies.models.effective import effective
from bcre_studies.models.registry import AUTOMATON, BCRE, EFFECTIVE
from bcre_studies.models.run import Run
from bcre_studies.scenes.scene import Scene


@dataclass(frozen=True)
class ScaledComparison(Comparison):
    """A comparison of numbers with differences relative to ``scale`` instead of the PDE's value."""

    scale: float

    @property
    def difference(self) -> float:
        """|automaton - PDE|/scale."""
        return float(abs(self.automaton - self.pde.measured) / self.scale)

    @property
    def difference_effective(self) -> float:
        """|automaton - PDE with D_eff and kappa_eff|/scale."""
        return float(abs(self.automaton - self.effective.measured) / self.scale)

    def row(self, automaton_theory: float = np.nan, pde_theory: float = np.nan) -> dict[str, Any]:
        """The shared columns with the closed forms, no digit finer than 1e-5 of the scale."""
        digits = 4 - int(np.floor(np.log10(self.scale)))
        finest = 10.0**-digits

        def shown(value: float, error: float = 0.0) -> float:
            return round(to_error(float(value), max(error, finest), 6), digits) + 0.0

        errors = [max(refined.error, finest) for refined in (self.pde, self.effective)]
        return {
            AUTOMATON.column: shown(self.automaton),
            f"{AUTOMATON.column}_theory": shown(automaton_theory),
            BCRE.column: shown(self.pde.measured, self.pde.error),
            f"{BCRE.column}_error": significant(errors[0], 1),
            f"{BCRE.column}_theory": shown(pde_theory),
            EFFECTIVE.column: shown(self.effective.measured, self.effective.error),
            f"{EFFECTIVE.column}_error": significant(errors[1], 1),
            "difference": significant(round(self.difference, 5), 3),
            "difference_error": significant(errors[0] / self.scale, 1),
            "difference_effective": significant(round(self.difference_effective, 5), 3),
            "difference_effective_error": significant(errors[1] / self.scale, 1),
            "pde_cells": self.pde.cells[-1],
            "verdict": str(self.verdict),
        }


def compare_each(
    scene: Scene,
    times: Sequence[float],
    measure: Callable[[Run], ArrayLike],
    scale: ArrayLike,
    tolerance: float,
    coarsest: int = 100,
    finest: int = 800,
) -> list[ScaledComparison]:
    """Compare K numbers measured on the same runs, each by itself.

    Parameters
    ----------
    scene, times: what both models run, and when it is recorded.
    measure: K numbers of a run, shape (K,).
    scale: what their differences are relative to, shape (K,), > 0.
    tolerance: largest relative difference that counts as agreement.
    coarsest, finest: the grid is doubled until every number is resolved, or the finest was solved.
    """
    automaton = np.asarray(measure(AUTOMATON.run(scene, times)))
    scales = np.broadcast_to(np.asarray(scale, dtype=float), automaton.shape)

    def refined(changed: Scene) -> list[bcre_pde.Refined]:
        cells, values, result = [coarsest], [], []
        problem = problem_of(changed)
        while True:
            solution = bcre_pde.solve(problem, times, cells[-1])
            values.append(np.asarray(measure(run_of(scene, solution))))
            if len(values) >= 3:
                allowed = SHARE * np.maximum(abs(automaton - values[-1]), tolerance * scales)
                indices = [
                    bcre_pde.grid_convergence_index(*three)
                    for three in zip(*values[:-4:-1], strict=True)
                ]
                result = [
                    bcre_pde.Refined(solution, value, tuple(cells), *index, float(limit))
                    for value, index, limit in zip(values[-1], indices, allowed, strict=True)
                ]
                if 2 * cells[-1] > finest or all(each.resolved for each in result):
                    return result
            cells.append(2 * cells[-1])

    pde, own = refined(scene), refined(effective(scene))
    return [
        ScaledComparison(value, nominal, with_own, tolerance, float(size))
        for value, nominal, with_own, size in zip(automaton, pde, own, scales, strict=True)
    ]
