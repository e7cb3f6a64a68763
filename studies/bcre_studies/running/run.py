"""``bcre run``: one scene, one or both models, the profiles and a summary as files."""

from __future__ import annotations

import json
import math
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal

import numpy as np
from rich.console import Console
from rich.progress import Progress

import bcre_ca
import bcre_pde
from bcre_studies.comparison.difference import sample
from bcre_studies.comparison.error import SHARE
from bcre_studies.models.simulate import (
    Run,
    as_run,
    frame_times,
    problem_of,
    profiles,
    rule_of,
    run_automaton,
)
from bcre_studies.running.memory_needed import estimate
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.scene import Scene, SceneError
from bcre_studies.system import memory
from bcre_studies.system.files import replace_file, replace_text

Which = Literal["ca", "pde", "both"]

ALONE = 1e-3
"""Relative error that the PDE is refined to where there is no automaton to compare it with."""

COARSEST = 100
FINEST = 1600

MOST_STEPS = {"ca": 10**9, "pde": 10**8}
"""A run that would take more is refused: it would not end within a working day."""


def run_scene(scene: Scene, model: Which, frames: int) -> list[Run]:
    """The scene in the models asked for, recorded at equally spaced times from 0 to its end.

    Raises
    ------
    SceneError
        where :func:`require_runnable` refuses it; where the scene's step is not stable, or not for
        as long as the scene lasts; where the PDE's solver gives up.
    """
    require_runnable(scene, model, frames)
    runs: list[Run] = []
    with _failures_told_by_key(scene):
        times = frame_times(scene, frames)
        if model in ("ca", "both"):
            runs.append(_run_ca(scene, times))
        if model in ("pde", "both"):
            runs.append(_run_pde(scene, times, runs[0] if runs else None))
    return runs


def require_runnable(scene: Scene, model: Which, frames: int) -> None:
    """What can be known before a run is started.

    Raises
    ------
    SceneError
        where the run would not fit into memory, or not end; where numbers are too large or too
        small to compute with.
    """
    with _failures_told_by_key(scene):
        needed = estimate(scene, model, frames, _finest(scene))
        memory.require(f"{_grids(scene)} with --frames = {frames}", needed)
        R = _largest_layer(scene)  # tells an overflow from an unstable step
        if model in ("ca", "both"):
            steps = scene.time.until / rule_of(scene).dt
            if scene.time.step == "auto":
                steps = max(steps, scene.time.until * scene.material.gamma * R / scene.d)
            else:
                _run_ca(scene, [0.0])  # refuses a step that cannot be stable
            _refuse_endless(scene, "ca", steps)
        if model in ("pde", "both"):
            grid = scene.solver.cells or COARSEST
            bound = bcre_pde.largest_explicit_step(
                problem_of(scene).material, scene.domain.length / grid, R
            )
            _refuse_endless(scene, "pde", scene.time.until / bound)


@contextmanager
def _failures_told_by_key(scene: Scene) -> Iterator[None]:
    """Floating-point errors are raised; what a run can fail of names a key of the scene."""
    try:
        with (
            np.errstate(over="raise", divide="raise", invalid="raise"),
            warnings.catch_warnings(action="ignore", category=UserWarning),  # SciPy's, on tolerance
        ):
            yield
    except memory.NotEnoughMemoryError as failure:
        raise SceneError(str(failure)) from None
    except MemoryError as failure:  # what was free has been taken by another meanwhile
        raise SceneError(f"{_grids(scene)}: {failure or 'took all memory there is'}") from None
    except bcre_pde.SolveError as failure:
        raise SceneError(
            f"solver.method = {scene.solver.method!r}: {failure}; must be a method that can solve "
            f"this scene to solver.tolerance = {scene.solver.tolerance!r}"
        ) from None
    except SceneError:
        raise
    except (ArithmeticError, ValueError) as failure:
        raise SceneError(
            f"{_most_extreme(scene)}: must be nearer to 1, it cannot be computed with ({failure})"
        ) from None


def _run_ca(scene: Scene, times: Sequence[float]) -> Run:
    try:
        return run_automaton(scene, times)
    except (bcre_ca.UnstableStep, FloatingPointError) as failure:
        step = scene.time.step
        raise SceneError(f"time.step = {step!r}: {failure}, or be 'auto'") from None


def _largest_layer(scene: Scene) -> float:
    """What R may come to: R0 e^(gamma (S - Sc) t), but no more than what lies above repose."""
    x = scene.centres()
    h, R = scene.initial(x)
    u, thickest = h + scene.material.Sc * x, float(R.max())
    if x.size < 2:
        return thickest
    excess = max(float(-np.diff(u).min() / scene.d), 0.0)
    growth = min(scene.material.gamma * excess * scene.time.until, 700.0)
    return min(thickest * math.exp(growth), thickest + float(np.ptp(u)))


def _grids(scene: Scene) -> str:
    own = "" if scene.solver.cells is None else f" and solver.cells = {scene.solver.cells!r}"
    return f"domain.cells = {scene.domain.cells!r}{own}"


def _coarsest(scene: Scene) -> int:
    return max(scene.domain.cells, COARSEST)


def _finest(scene: Scene) -> int:
    return scene.solver.cells or max(FINEST, 4 * _coarsest(scene))


def _refuse_endless(scene: Scene, model: str, steps: float) -> None:
    if steps > MOST_STEPS[model]:
        until, step = scene.time.until, scene.time.step
        raise SceneError(
            f"time.until = {until!r} with time.step = {step!r}: would take {steps:.1g} steps of "
            f"the {model} with this material and grid; must take at most {MOST_STEPS[model]:.0g}"
        )


def _most_extreme(scene: Scene) -> str:
    """``key = value`` of the number farthest from 1, the likely cause of an overflow."""
    numbers: dict[str, float] = {}

    def gather(key: str, value: Any) -> None:
        if isinstance(value, dict):
            for name, part in value.items():
                gather(f"{key}.{name}", part)
        elif isinstance(value, list):
            for index, part in enumerate(value):
                gather(f"{key}.{index}", part)
        elif isinstance(value, float) and value != 0:
            numbers[key.removeprefix(".")] = value

    gather("", scene.model_dump(mode="json"))
    key = max(numbers, key=lambda name: abs(math.log10(abs(numbers[name]))))
    return f"{key} = {numbers[key]!r}"


def _run_pde(scene: Scene, times: Sequence[float], automaton: Run | None) -> Run:
    """BCRE on the scene's grid, or refined until its error in R, over all frames, is small.

    Small is a tenth of the difference from the automaton, or a thousandth of R without one.
    """
    x = scene.centres()

    def measure(solution: bcre_pde.Solution) -> Array:
        run = as_run(scene, solution)
        return np.array([sample(run, x, frame=frame) for frame in range(run.t.size)])

    def allowed(R: Array) -> float:
        relative = ALONE * float(np.mean(np.abs(R)))
        if automaton is None:
            return relative
        return SHARE * max(float(np.mean(np.abs(R - automaton.R))), relative)

    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task("BCRE", total=scene.time.until)

        def show(solution: bcre_pde.Solution) -> bool:
            cells = f"BCRE, {solution.x.size} cells"
            progress.update(task, description=cells, completed=float(solution.t[-1]))
            return False

        options: dict[str, Any] = {
            "method": scene.solver.method,
            "tolerance": scene.solver.tolerance,
            "stop": show,
        }
        problem = problem_of(scene)
        if scene.solver.cells is None:
            refined = bcre_pde.solve_refined(
                problem,
                times,
                measure,
                allowed,
                coarsest=_coarsest(scene),
                finest=_finest(scene),
                **options,
            )
        else:

            def measure_on(cells: int) -> tuple[bcre_pde.Solution, list[Array]]:
                solution = bcre_pde.solve(problem, times, cells, **options)
                return solution, [measure(solution)]

            (refined,) = bcre_pde.measure_refined(measure_on, _given_grids(scene.solver.cells))
    return as_run(scene, refined.solution, refined.error)


def _given_grids(cells: int) -> list[int]:
    """The scene's own PDE grid, and for its error two that are two and four times coarser."""
    return [grid for grid in (cells // 4, cells // 2, cells) if grid >= bcre_pde.SMALLEST_GRID]


def write_run(runs: Sequence[Run], folder: Path) -> dict[str, Any]:
    """Write ``profiles.csv`` and ``summary.json``; return the summary."""
    summary: dict[str, Any] = {run.model: summarise(run) for run in runs}

    def write(path: Path) -> None:
        with path.open("w", encoding="utf-8", newline="") as file:
            for run in runs:  # one after the other: the text of both is large
                table = profiles(run, model=run.model)
                table.to_csv(file, index=False, header=run is runs[0], lineterminator="\n")

    replace_file(folder / "profiles.csv", write)
    replace_text(folder / "summary.json", json.dumps(summary, indent=2) + "\n")
    return summary


def summarise(run: Run) -> dict[str, Any]:
    """What happened, in numbers: cells, steps, time taken, the balance of mass, the range of R."""
    mass = run.mass()
    summary: dict[str, Any] = {
        "cells": run.x.size,
        "steps": run.steps,
        "wall_s": run.wall_s,
        "mass_initial": float(mass[0]),
        "mass_final": float(mass[-1]),
        "outflow": float(run.outflow[-1]),
        "mass_error": run.mass_error(),
        "R_min": float(run.R.min()),
        "R_max": float(run.R.max()),
        **(run.adapted or {}),
    }
    if run.model == "pde":
        scale = float(np.mean(np.abs(run.R)))
        error = math.inf if run.error is None else run.error / (scale or 1.0)
        summary["error_estimate"] = error if math.isfinite(error) else None
    return summary
