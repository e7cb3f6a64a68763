"""The comparison that every study makes: automaton, BCRE, and BCRE with the automaton's diffusion.

The PDE is refined until its own error in what is measured is a tenth of the difference from the
automaton (or of the tolerance, where the difference is smaller still).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

import bcre_pde
from bcre_pde import Measured
from bcre_studies.comparison.difference import relative_difference
from bcre_studies.comparison.error import allowed_error, relative_error
from bcre_studies.comparison.rounding import DIGITS, finest_of, shown, significant
from bcre_studies.comparison.verdict import Verdict, verdict_of
from bcre_studies.models.bcre import problem_of, run_of
from bcre_studies.models.effective import effective
from bcre_studies.models.registry import AUTOMATON, BCRE, EFFECTIVE
from bcre_studies.models.run import Run
from bcre_studies.scenes.scene import Scene

Measure = Callable[[Run], ArrayLike]
MeasureEach = Callable[[Run], Sequence[Any]]
Scales = Sequence[float | None]


@dataclass(frozen=True)
class Comparison:
    """One measured quantity in the automaton, in BCRE and in BCRE with D_eff and kappa_eff.

    Parameters
    ----------
    automaton: a number or a profile.
    pde, effective: the same in BCRE, with the error in the unit of the value.
    tolerance: largest relative difference that counts as agreement.
    scale: for numbers that may vanish, what differences are relative to, > 0; it also sets the last
        digit that is shown. Left out, the PDE's own mean absolute value.
    """

    automaton: Any
    pde: Measured
    effective: Measured
    tolerance: float
    scale: float | None = None

    @property
    def difference(self) -> float:
        """Relative difference of the automaton from BCRE as it stands."""
        return relative_difference(self.automaton, self.pde.value, self.scale)

    @property
    def difference_effective(self) -> float:
        """Relative difference of the automaton from BCRE with D_eff and kappa_eff."""
        return relative_difference(self.automaton, self.effective.value, self.scale)

    def is_resolved(self, pde: Measured) -> bool:
        """Whether the error of one of the two is small against its difference."""
        return pde.error <= allowed_error(self.automaton, pde.value, self.tolerance, self.scale)

    @property
    def verdict(self) -> Verdict:
        """See :func:`bcre_studies.comparison.verdict.verdict_of`."""
        return verdict_of(
            self.difference,
            self.is_resolved(self.pde),
            self.difference_effective,
            self.is_resolved(self.effective),
            self.tolerance,
        )

    def row(
        self, automaton_theory: float | None = None, pde_theory: float | None = None
    ) -> dict[str, Any]:
        """The comparison as the columns that all tables share, rounded as its errors justify.

        Closed forms have a column where they are given. Numbers of cells and relative errors have
        one where BCRE was solved on a series of grids, and single values where no profile is
        compared.
        """
        finest = finest_of(self.scale)
        on_grids = bool(self.pde.cells)
        row: dict[str, Any] = {}
        if np.ndim(self.automaton) == 0:
            row[AUTOMATON.column] = shown(float(self.automaton), finest)
            if automaton_theory is not None:
                row[f"{AUTOMATON.column}_theory"] = shown(automaton_theory, finest)
            row |= _with_error(BCRE.column, self.pde, finest)
            if pde_theory is not None:
                row[f"{BCRE.column}_theory"] = shown(pde_theory, finest)
            row |= _with_error(EFFECTIVE.column, self.effective, finest)
        row["difference"] = significant(round(self.difference, DIGITS), 3)
        if on_grids:
            row["difference_error"] = significant(relative_error(self.pde, self.scale), 1)
        row["difference_effective"] = significant(round(self.difference_effective, DIGITS), 3)
        if on_grids:
            own_error = relative_error(self.effective, self.scale)
            row["difference_effective_error"] = significant(own_error, 1)
            row["pde_cells"] = self.pde.cells[-1]
        return row | {"verdict": str(self.verdict)}


def _with_error(name: str, pde: Measured, finest: float) -> dict[str, float]:
    error = max(pde.error, finest)
    return {
        name: shown(float(pde.value), finest, error),
        f"{name}_error": significant(error, 1),
    }


def compare(
    scene: Scene, times: Sequence[float], measure: Measure, tolerance: float, /, **refinement: Any
) -> Comparison:
    """Measure the same thing on the automaton's run and on refined solutions of BCRE.

    Parameters
    ----------
    scene: what both models run, from the same initial condition.
    times: when they are recorded; ``measure`` sees all of them.
    measure: a number, or a profile at positions that do not depend on the run's grid.
    tolerance: largest relative difference that counts as agreement.
    refinement: options of :func:`bcre_pde.solve_refined`, among them the solver's ``tolerance``.
    """
    (comparison,) = compare_each(
        scene, times, lambda run: [measure(run)], [None], tolerance, **refinement
    )
    return comparison


def compare_each(
    scene: Scene,
    times: Sequence[float],
    measure: MeasureEach,
    scales: Scales,
    tolerance: float,
    /,
    **refinement: Any,
) -> list[Comparison]:
    """Compare several numbers or profiles, measured on the same runs, each by itself.

    Parameters
    ----------
    scene, times, tolerance, refinement: as for :func:`compare`.
    measure: the quantities of a run.
    scales: what the difference of each is relative to, see :class:`Comparison`.
    """
    automaton = measure(AUTOMATON.run(scene, times))
    in_both = [
        refine_each(solved, times, measure, automaton, scales, tolerance, **refinement)
        for solved in (scene, effective(scene))
    ]
    return [
        Comparison(value, nominal, with_own, tolerance, scale)
        for value, nominal, with_own, scale in zip(automaton, *in_both, scales, strict=True)
    ]


def refine_each(
    scene: Scene,
    times: Sequence[float],
    measure: MeasureEach,
    automaton: Sequence[Any],
    scales: Scales,
    tolerance: float,
    /,
    **refinement: Any,
) -> list[Measured]:
    """Solve until each error is :data:`SHARE` of the difference from the automaton's value.

    Of the grids the coarsest is the first that can hold the start of the scene.
    """
    coarsest = refinement.pop("coarsest", bcre_pde.COARSEST)
    while not scene.holds(coarsest):
        coarsest *= 2

    def allowed(values: Sequence[Any]) -> list[float]:
        return [
            allowed_error(own, value, tolerance, scale)
            for own, value, scale in zip(automaton, values, scales, strict=True)
        ]

    return bcre_pde.solve_refined_each(
        problem_of(scene),
        times,
        lambda solution: measure(run_of(scene, solution)),
        allowed,
        coarsest,
        **refinement,
    )


def refine(
    scene: Scene,
    times: Sequence[float],
    measure: Measure,
    automaton: ArrayLike,
    tolerance: float,
    /,
    **refinement: Any,
) -> Measured:
    """:func:`refine_each` of a single quantity, compared by its own size."""
    (measured,) = refine_each(
        scene,
        times,
        lambda run: [measure(run)],
        [automaton],
        [None],
        tolerance,
        **refinement,
    )
    return measured
