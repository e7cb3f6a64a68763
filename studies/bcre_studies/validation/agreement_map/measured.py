"""One pulse in the automaton, in BCRE and in effective BCRE: differences, errors, the verdict."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from bcre_pde import SolveError
from bcre_studies.comparison.compare import Comparison
from bcre_studies.comparison.error import allowed_error, relative_error
from bcre_studies.models.bcre import problem_of, run_of
from bcre_studies.models.effective import effective
from bcre_studies.models.registry import AUTOMATON
from bcre_studies.models.run import Run
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.scene import Scene
from bcre_studies.validation.agreement_map.pulses import Pulse, scene_of

TOLERANCE = 0.05
WHY = "of R: what a twentieth of the layer is worth, as in the paper's figures"

CELLS_A_WIDTH = 1
"""Of BCRE's coarsest grid; each pulse gets three grids at least, and more until they suffice."""

FINEST = 32
"""Cells of BCRE's finest grid on one of its coarsest."""

LOCAL_ERROR = 1e-4
"""Of BCRE's steps in time, relative to the largest R; a thirtieth of the error asked for."""

FAILED = "failed"
"""Stands for a verdict where the automaton refused its step, or outgrew it."""

Row = dict[str, Any]

COLUMNS: dict[str, type] = {
    "difference_R": float,
    "error_R": float,
    "difference_R_effective": float,
    "difference_h": float,
    "difference_h_effective": float,
    "verdict": str,
}


def measure(pulse: Pulse) -> Row:
    """The groups of the pulse and what :data:`COLUMNS` names; ``failure`` where there is none."""
    try:
        return asdict(pulse) | compared(pulse) | {"failure": ""}
    except (ValueError, ArithmeticError, SolveError) as failure:
        return asdict(pulse) | {"verdict": FAILED, "failure": str(failure)}


def compared(pulse: Pulse) -> Row:
    """Relative L1 differences at the end, of R and of the change in h.

    BCRE is refined until its error in R is small; that in h comes with it.

    Raises
    ------
    ValueError
        where the automaton's step cannot be stable; FloatingPointError where it was outgrown.
    """
    scene = scene_of(pulse)
    automaton = _layers(AUTOMATON.run(scene, [0.0, scene.time.until]), scene.centres())
    coarsest = math.ceil(CELLS_A_WIDTH * scene.domain.length / pulse.cells_a_width)
    in_both = [
        _refined(solved, scene.centres(), automaton, coarsest)
        for solved in (scene, effective(scene))
    ]
    R, h = (
        Comparison(own, nominal, with_own, TOLERANCE)
        for own, nominal, with_own in zip(automaton, *in_both, strict=True)
    )
    return {
        "difference_R": R.difference,
        "error_R": relative_error(R.pde),
        "difference_R_effective": R.difference_effective,
        "difference_h": h.difference,
        "difference_h_effective": h.difference_effective,
        "verdict": str(R.verdict),
    }


def _refined(scene: Scene, x: Array, automaton: Sequence[Array], coarsest: int) -> list[Any]:
    from bcre_pde import solve_refined_each

    def allowed(layers: Sequence[Array]) -> list[float]:
        return [allowed_error(automaton[0], layers[0], TOLERANCE), math.inf]

    return solve_refined_each(
        problem_of(scene),
        [0.0, scene.time.until],
        lambda solution: _layers(run_of(scene, solution), x),
        allowed,
        coarsest=coarsest,
        finest=FINEST * coarsest,
        tolerance=LOCAL_ERROR,
    )


def _layers(run: Run, x: Array) -> list[Array]:
    """R and the change of h at the end, at positions x."""
    return [run.sample(x), run.sample(x, "u") - run.sample(x, "u", frame=0)]
