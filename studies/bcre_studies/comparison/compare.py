"""The comparison that every study makes: automaton, BCRE, and BCRE with the automaton's diffusion.

The PDE is refined until the grid convergence index of what is measured is a tenth of the
difference from the automaton (or of the tolerance, where the difference is smaller still).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

import bcre_pde
from bcre_studies.comparison.claim import Verdict, verdict_of
from bcre_studies.models.bcre import SHARE, problem_of, run_of
from bcre_studies.models.effective import effective
from bcre_studies.models.registry import AUTOMATON, BCRE, EFFECTIVE
from bcre_studies.models.run import Run
from bcre_studies.scenes.scene import Scene

Measure = Callable[[Run], ArrayLike]


@dataclass(frozen=True)
class Comparison:
    """One measured quantity in the automaton, in BCRE and in BCRE with D_eff and kappa_eff.

    The values are numbers or profiles; errors are grid convergence indices in the unit of the
    value (mean absolute value of a profile), differences relative to the mean absolute PDE value.
    """

    automaton: Any
    pde: bcre_pde.Refined
    effective: bcre_pde.Refined
    tolerance: float

    @property
    def difference(self) -> float:
        """Relative difference of the automaton from BCRE as it stands."""
        return relative_difference(self.automaton, self.pde.measured)

    @property
    def difference_effective(self) -> float:
        """Relative difference of the automaton from BCRE with D_eff and kappa_eff."""
        return relative_difference(self.automaton, self.effective.measured)

    @property
    def verdict(self) -> Verdict:
        """See :func:`bcre_studies.comparison.claim.verdict_of`."""
        return verdict_of(
            self.difference,
            self.pde.resolved,
            self.difference_effective,
            self.effective.resolved,
            self.tolerance,
        )

    def row(self) -> dict[str, Any]:
        """The comparison as the columns that all tables share, rounded as its errors justify."""
        row: dict[str, Any] = {}
        if np.ndim(self.automaton) == 0:
            row[AUTOMATON.column] = significant(float(self.automaton), 5)
            for model, found in ((BCRE, self.pde), (EFFECTIVE, self.effective)):
                row[model.column] = to_error(float(found.measured), found.error)
                row[f"{model.column}_error"] = significant(found.error, 1)
        row["difference"] = significant(self.difference, 3)
        row["difference_error"] = significant(relative_error(self.pde), 1)
        row["difference_effective"] = significant(self.difference_effective, 3)
        row["difference_effective_error"] = significant(relative_error(self.effective), 1)
        row["pde_cells"] = self.pde.cells[-1]
        row["verdict"] = str(self.verdict)
        return row


def compare(
    scene: Scene,
    times: Sequence[float],
    measure: Measure,
    tolerance: float,
    **refinement: Any,
) -> Comparison:
    """Measure the same thing on the automaton's run and on refined solutions of BCRE.

    Parameters
    ----------
    scene: what both models run, from the same initial condition.
    times: when they are recorded; ``measure`` sees all of them.
    measure: a number, or a profile at positions that do not depend on the run's grid.
    tolerance: largest relative difference that counts as agreement.
    refinement: options of :func:`bcre_pde.solve_refined`.
    """
    automaton = measure(AUTOMATON.run(scene, times))
    pde, own = (
        refine(changed, times, measure, automaton, tolerance, **refinement)
        for changed in (scene, effective(scene))
    )
    return Comparison(automaton, pde, own, tolerance)


def refine(
    scene: Scene,
    times: Sequence[float],
    measure: Measure,
    automaton: ArrayLike,
    tolerance: float,
    **refinement: Any,
) -> bcre_pde.Refined:
    """Solve BCRE until the error is :data:`SHARE` of the difference from the automaton's value."""

    def allowed(value: Any) -> float:
        difference = float(np.mean(np.abs(np.asarray(value) - np.asarray(automaton))))
        return SHARE * max(difference, tolerance * float(np.mean(np.abs(value))))

    return bcre_pde.solve_refined(
        problem_of(scene),
        times,
        lambda solution: measure(run_of(scene, solution)),
        allowed,
        **refinement,
    )


def relative_difference(automaton: ArrayLike, pde: ArrayLike) -> float:
    """mean|automaton - pde| / mean|pde|: for profiles the relative L1 difference."""
    scale = float(np.mean(np.abs(pde)))
    gap = float(np.mean(np.abs(np.asarray(automaton) - np.asarray(pde))))
    return gap / scale if scale > 0 else (0.0 if gap == 0 else math.inf)


def relative_error(refined: bcre_pde.Refined) -> float:
    """The PDE's own error relative to its mean absolute value."""
    scale = float(np.mean(np.abs(refined.measured)))
    return refined.error / scale if scale > 0 else math.inf


def significant(value: float, digits: int) -> float:
    """Rounded to so many significant digits."""
    return float(f"{value:.{digits - 1}e}") if math.isfinite(value) else value


def to_error(value: float, error: float, most: int = 5) -> float:
    """Rounded to the place of its error's first digit, ``most`` significant digits at the most."""
    if not (math.isfinite(error) and error > 0 and math.isfinite(value) and value):
        return significant(value, most)
    digits = math.floor(math.log10(abs(value))) - math.floor(math.log10(error)) + 1
    return significant(value, min(max(digits, 1), most))
