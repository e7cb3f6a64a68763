"""``bcre run``: one scene in one or more models, the profiles and a summary as files."""

from __future__ import annotations

import csv
import json
import math
import sys
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from itertools import repeat
from pathlib import Path
from typing import Any

import numpy as np

from bcre_studies.models.registry import Model, chosen
from bcre_studies.models.run import Run, frame_times
from bcre_studies.running.place import PROFILES, SUMMARY, Origin
from bcre_studies.scenes.doubts import doubts
from bcre_studies.scenes.scene import Scene, SceneError
from bcre_studies.system import memory
from bcre_studies.system.compiling import compiling
from bcre_studies.system.files import replace_file, replace_text


def run_scene(scene: Scene, choice: str, frames: int) -> list[Run]:
    """The scene in the models asked for, recorded at equally spaced times from 0 to its end.

    Parameters
    ----------
    choice: one of ``registry.CHOICES``.

    Raises
    ------
    SceneError
        where :func:`require_runnable` refuses it, or a model fails on the way.
    """
    runs: list[Run] = []
    times = frame_times(scene, frames)
    with compiling() as compiled_s:
        require_runnable(scene, choice, frames)
        with failures_name_their_key(scene):
            for model in chosen(choice):
                with _progress(scene, model) as show:
                    run = model.answer(scene, times, runs, show)
                before = sum(run.compile_s for run in runs)
                runs.append(replace(run, compile_s=compiled_s() - before))
    return runs


def require_runnable(scene: Scene, choice: str, frames: int) -> None:
    """Refuse what can be known to fail before a run is started.

    Raises
    ------
    SceneError
        where the run would not fit into memory, or not end; where numbers are too large or too
        small to compute with.
    """
    adapters = [model.adapter() for model in chosen(choice)]
    with failures_name_their_key(scene):
        needed = sum(adapter.memory(scene, frames) for adapter in adapters)
        memory.require(f"{_grids(scene)} with --frames = {frames}", needed)
        for adapter in adapters:
            adapter.require_admitted(scene)
            adapter.require_runnable(scene)


def notes(scene: Scene, choice: str) -> list[str]:
    """What a user should know of this scene, and of the models on it."""
    of_models = (model.adapter().note(scene) for model in chosen(choice))
    return [*doubts(scene), *filter(None, of_models)]


@contextmanager
def failures_name_their_key(scene: Scene) -> Iterator[None]:
    """Raise floating-point errors; what a run can fail of names a key of the scene."""
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
    except SceneError:
        raise
    except (ArithmeticError, ValueError) as failure:
        raise SceneError(
            f"{_most_extreme(scene)}: must be nearer to 1, it cannot be computed with ({failure})"
        ) from None


@contextmanager
def _progress(scene: Scene, model: Model) -> Iterator[Callable[[Run], bool]]:
    """Show how far a run has come, where somebody can see it."""
    if not sys.stderr.isatty():
        yield lambda _: False
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task(model.text, total=scene.time.until)

        def show(run: Run) -> bool:
            text = f"{model.text}, {run.x.size} cells"
            progress.update(task, description=text, completed=float(run.t[-1]))
            return False

        yield show


def _grids(scene: Scene) -> str:
    own = "" if scene.solver.cells is None else f" and solver.cells = {scene.solver.cells!r}"
    return f"domain.cells = {scene.domain.cells!r}{own}"


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


def write_run(runs: Sequence[Run], folder: Path, origin: Origin) -> dict[str, Any]:
    """Write ``profiles.csv`` and ``summary.json``; return the summary."""
    summary = {run.model: summarise(run) | origin.record(run.scene, folder) for run in runs}

    def write(path: Path) -> None:
        with path.open("w", encoding="utf-8", newline="") as file:
            table = csv.writer(file, lineterminator="\n")
            table.writerow(("model", "t", "x", "h", "R"))
            for run in runs:
                x = run.x.tolist()
                for t, h, R in zip(run.t.tolist(), run.h, run.R, strict=True):
                    columns = x, h.tolist(), R.tolist()
                    table.writerows(zip(repeat(run.model), repeat(t), *columns, strict=False))

    replace_file(folder / PROFILES, write)
    replace_text(folder / SUMMARY, json.dumps(summary, indent=2) + "\n")
    return summary


def summarise(run: Run) -> dict[str, Any]:
    """What happened, in numbers: cells, steps, time taken, the balance of mass, the range of R."""
    mass = run.mass()
    return {
        "cells": run.x.size,
        "steps": run.steps,
        "wall_s": run.wall_s,
        "compile_s": run.compile_s,
        "mass_initial": float(mass[0]),
        "mass_final": float(mass[-1]),
        "outflow": float(run.outflow[-1]),
        **({"inflow": float(run.inflow()[-1])} if run.scene.source else {}),
        "mass_error": run.mass_error(),
        "R_min": float(run.R.min()),
        "R_max": float(run.R.max()),
        **run.facts,
    }
