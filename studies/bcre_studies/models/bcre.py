"""BCRE as ``bcre_pde`` solves it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

import bcre_pde
from bcre_pde.source import Source
from bcre_studies.models.adapter import (
    Adapter,
    Stop,
    noise_bytes,
    refuse_endless,
    thickest_layer,
)
from bcre_studies.models.run import Run
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.scene import Scene, SceneError

if TYPE_CHECKING:
    from bcre_pde.line.marched import MarchedOnLine

SHARE = 0.1
"""BCRE's own error may be this part of the difference that is reported."""

ALONE = 1e-3
"""Relative error that BCRE is refined to where there is no other model to compare it with."""

COARSEST, FINEST = 100, 1600
"""Cells of the grids that :meth:`Bcre.answer` goes through, at least."""

MOST_STEPS = 10**8
"""A run that would take more is refused: it would not end within a working day."""

FRAME_BYTES = 70
"""Memory a frame and cell: as for every model, with the coarser grids."""

WORK_BYTES = {"runge-kutta": 200, "RK45": 800, "DOP853": 1300, "LSODA": 800, "BDF": 7500}
"""Memory a cell that the solver works with; LSODA has a full Jacobian besides."""


class Bcre(Adapter):
    """BCRE with the scene's own coefficients, or with those of ``of(scene)``.

    A further model on py-pde has its own :attr:`equation` and :meth:`problem`.
    """

    refined = True
    equation: type[MarchedOnLine] | None = None
    """What :func:`bcre_pde.solve` solves; None is BCRE."""

    def __init__(self, of: Callable[[Scene], Scene] | None = None) -> None:
        self._of = of or (lambda scene: scene)

    def problem(self, scene: Scene) -> bcre_pde.Problem:
        """The scene as an initial value problem of this model."""
        return problem_of(self._of(scene))

    def _options(self, scene: Scene, stop: Stop | None) -> dict[str, Any]:
        options = solver_options(scene, stop)
        return options if self.equation is None else options | {"equation": self.equation}

    def on(self, scene: Scene, cells: int) -> Scene:
        return scene.with_changes(**{"solver.cells": cells})

    def run(
        self,
        scene: Scene,
        times: Sequence[float],
        cells: int | None = None,
        stop: Stop | None = None,
    ) -> Run:
        """As :meth:`Adapter.run`, by the method and to the tolerance of ``[solver]``.

        Raises
        ------
        bcre_pde.SolveError
            where the solver gives up.
        SceneError
            where the grid cannot hold the start.
        """
        if cells is not None:
            scene.require_held(cells, "solver.cells")
        problem, options = self.problem(scene), self._options(scene, stop)
        return run_of(scene, bcre_pde.solve(problem, times, cells or finest(scene), **options))

    def answer(
        self, scene: Scene, times: Sequence[float], earlier: Sequence[Run], stop: Stop
    ) -> Run:
        """On the scene's grid, or refined until its errors in R and h, over all frames, are small.

        Small is a tenth of the difference from the first earlier run, or a thousandth of the mean
        rolling layer.
        """
        x = scene.centres()
        grids: list[Run] = []

        def measure(run: Run) -> list[Array]:
            grids.append(run)
            frames = range(run.t.size)
            return [np.array([run.sample(x, field, frame) for frame in frames]) for field in "Ru"]

        def allowed(values: Sequence[Array]) -> list[float]:
            least = ALONE * float(np.mean(np.abs(values[0])))
            if not earlier:
                return [least, least]
            others = earlier[0].R, earlier[0].u
            gaps = [np.mean(np.abs(a - b)) for a, b in zip(values, others, strict=True)]
            return [max(SHARE * float(gap), SHARE * least) for gap in gaps]

        try:
            found = self.measured(scene, times, measure, allowed, stop)
        except bcre_pde.SolveError as failure:
            raise SceneError(
                f"solver.method = {scene.solver.method!r}: {failure}; must be a method that can "
                f"solve this scene to solver.tolerance = {scene.solver.tolerance!r}"
            ) from None
        finest = run_of(scene, found[0].solution, found)
        return replace(finest, coarser=tuple(grids[-bcre_pde.LEAST_GRIDS : -1]))

    def measured(
        self,
        scene: Scene,
        times: Sequence[float],
        measure: Callable[[Run], Sequence[Any]],
        allowed: Callable[[Sequence[Any]], Iterable[float]],
        stop: Stop | None = None,
    ) -> list[bcre_pde.Measured]:
        """As :meth:`Adapter.measured`; the grid of ``[solver]`` is kept where the scene names one.

        Raises
        ------
        bcre_pde.SolveError
            where the solver gives up.
        """
        problem, options = self.problem(scene), self._options(scene, stop)

        def on_solution(solution: bcre_pde.Solution) -> Sequence[Any]:
            return measure(run_of(scene, solution))

        def on_cells(cells: int) -> tuple[bcre_pde.Solution, Sequence[Any]]:
            solution = bcre_pde.solve(problem, times, cells, **options)
            return solution, on_solution(solution)

        asked = allowed if scene.solver.cells is None else None
        return bcre_pde.measure_refined(on_cells, grids_of(scene), asked)

    def require_runnable(self, scene: Scene) -> None:
        grid = scene.solver.cells or COARSEST
        bound = bcre_pde.largest_explicit_step(
            problem_of(scene).material, scene.domain.length / grid, thickest_layer(scene)
        )
        refuse_endless(scene, "PDE", scene.time.until / bound, MOST_STEPS)

    def memory(self, scene: Scene, frames: int) -> int:
        cells, method = finest(scene), scene.solver.method
        jacobian = 8 * (3 * cells) ** 2 if method == "LSODA" else 0
        return jacobian + cells * (frames * FRAME_BYTES + noise_bytes(scene) + WORK_BYTES[method])


def problem_of(scene: Scene) -> bcre_pde.Problem:
    """The scene as an initial value problem of BCRE."""
    material = scene.material
    return bcre_pde.Problem(
        initial=scene.initial,
        material=bcre_pde.Material(
            v=material.v,
            D=material.D,
            gamma=material.gamma,
            Sc=material.Sc,
            kappa=material.kappa,
            v_up=math.inf if material.v_up is None else material.v_up,
            Gamma=material.Gamma,
        ),
        length=scene.domain.length,
        ends=scene.domain.ends,
        sources=sources_of(scene),
    )


def sources_of(scene: Scene) -> tuple[Source, ...]:
    """The scene's sources as ``bcre_pde`` takes them."""
    return tuple(
        Source(source.rate, source.place, source.width, source.start, source.until)
        for source in scene.source
    )


def solver_options(scene: Scene, stop: Stop | None = None) -> dict[str, Any]:
    """Method and tolerance of ``[solver]`` as :func:`bcre_pde.solve` takes them."""
    options: dict[str, Any] = {
        "method": scene.solver.method,
        "tolerance": scene.solver.tolerance,
    }
    if stop is not None:
        options["stop"] = lambda solution: stop(run_of(scene, solution))
    return options


def run_of(
    scene: Scene, solution: bcre_pde.Solution, measured: Sequence[bcre_pde.Measured] = ()
) -> Run:
    """A solution as the record of the scene, with the errors of R and of h where they are known.

    They are mean absolute values over all frames, relative to the mean rolling layer: what the grid
    adds by its convergence, and what the steps in time add by the sum of theirs.
    """
    facts: dict[str, Any] = {}
    if measured:
        R, u = measured
        layer = float(np.mean(np.abs(solution.R))) or 1.0
        steps = solution.step_error * float(np.abs(solution.R).max()) / layer
        facts = {
            "error_estimate": _finite(R.error / layer),
            "error_estimate_h": _finite(u.error / layer),
            "error_estimate_time": _finite(steps),
            "observed_order": _finite(R.order),
            "observed_order_h": _finite(u.order),
        }
    return Run(
        scene=scene,
        x=solution.x,
        t=solution.t,
        h=solution.h,
        R=solution.R,
        outflow=solution.outflow,
        steps=solution.steps,
        evaluations=solution.evaluations,
        wall_s=solution.wall_s,
        facts=facts,
    )


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def grids_of(scene: Scene) -> Iterable[int]:
    """The grids that BCRE goes through on this scene, coarsest first."""
    return _refined_grids(scene) if scene.solver.cells is None else _given_grids(scene)


def _refined_grids(scene: Scene) -> Iterator[int]:
    """Ever finer grids, from half of the automaton's cells where those can hold the start."""
    cells = max(scene.domain.cells, COARSEST)
    if cells % 2 == 0 and scene.holds(cells // 2):
        yield cells // 2
    while cells <= finest(scene):
        yield cells
        cells *= 2


def _given_grids(scene: Scene) -> list[int]:
    """The scene's own PDE grid, and for its error three that are two to eight times coarser.

    Those that cannot hold the start tell nothing of the error and are left out.
    """
    cells = scene.solver.cells or 0
    grids = (cells // 8, cells // 4, cells // 2, cells)
    return [grid for grid in grids if grid >= bcre_pde.SMALLEST_GRID and scene.holds(grid)]


def finest(scene: Scene) -> int:
    """Cells of the scene's own PDE grid, or of the finest that it may be refined to."""
    return scene.solver.cells or max(FINEST, 4 * max(scene.domain.cells, COARSEST))
