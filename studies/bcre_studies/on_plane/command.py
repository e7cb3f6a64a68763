"""``bcre run`` for a scene on a plane."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from bcre_studies.models.registry import AUTOMATON, BCRE
from bcre_studies.running.done import Done
from bcre_studies.running.place import SUMMARY, Origin, admitted
from bcre_studies.scenes.doubts import doubts
from bcre_studies.scenes.refusal import SceneError
from bcre_studies.scenes.toml_file import is_on_plane, read
from bcre_studies.system import memory
from bcre_studies.system.files import replace_bytes, replace_file, replace_text

if TYPE_CHECKING:
    from bcre_studies.models.plane.run import PlaneRun
    from bcre_studies.scenes.plane.scene import PlaneScene

FRAMES, PICTURE, ANIMATION = "frames.nc", "picture.png", "animation.gif"
FILES = FRAMES, SUMMARY, PICTURE, ANIMATION
"""What a run writes, the last only where asked for."""

FRAME_BYTES = 40
"""Memory that a frame takes a cell and model: both layers, and copies of them on the way."""

MODELS = (AUTOMATON.name, BCRE.name)


def takes(source: str) -> bool:
    """Whether this is a scene on a plane."""
    return is_on_plane(read(source, (), {})[0])


def run(
    origin: Origin,
    choice: str | None,
    frames: int,
    folder: Path,
    is_own_folder: bool,
    animate: bool,
) -> Done:
    """Run the scene and write its files into ``folder``.

    Parameters
    ----------
    choice: ``"ca"``, ``"pde"`` or ``"both"``; left out, the automaton, because BCRE takes minutes.
    frames: from t = 0 to the end.
    is_own_folder: nobody asked for the folder, so that it must not hold another scene's results.

    Raises
    ------
    ValueError
        naming the key, its value and what is allowed; then nothing is written.
    """
    from bcre_studies.scenes.plane.scene import load

    names = {None: (AUTOMATON.name,), "both": MODELS}.get(choice, (choice,))
    if not set(names) <= set(MODELS):
        raise ValueError(f"--model = {choice!r}: must be 'ca', 'pde' or 'both' on a plane")
    scene = admitted(origin, load, folder, FILES, is_own_folder)
    with failures_name_their_key(scene):
        require_memory(scene, frames, len(names))
        times = [float(t) for t in np.linspace(0.0, scene.time.until, frames)]
        runs = _runs(scene, names, times)
    return write(runs, folder, origin, animate)


def _runs(scene: PlaneScene, names: Sequence[str | None], times: list[float]) -> list[PlaneRun]:
    from bcre_studies.models.plane import automaton

    if BCRE.name not in names:
        return [automaton.run(scene, times)]
    from bcre_studies.models.plane import bcre

    bcre.require_taken(scene)
    return [automaton.run(scene, times)] * (AUTOMATON.name in names) + [bcre.run(scene, times)]


def write(runs: Sequence[PlaneRun], folder: Path, origin: Origin, animate: bool) -> Done:
    """Write the files of these runs of one scene."""
    from bcre_studies.on_plane import netcdf, picture, said

    summary = {run.model: run.summary() | origin.record(run.scene, folder) for run in runs}
    replace_bytes(folder / FRAMES, netcdf.content(runs))
    replace_text(folder / SUMMARY, json.dumps(summary, indent=2) + "\n")
    written = [FRAMES, SUMMARY, PICTURE]
    replace_file(folder / PICTURE, lambda path: picture.write(runs, path))
    if animate:
        from bcre_studies.on_plane import animation

        replace_bytes(folder / ANIMATION, animation.content(runs))
        written.append(ANIMATION)
    files = tuple(folder / name for name in written)
    picture_of = folder / (ANIMATION if animate else PICTURE)
    return Done(
        files=files,
        picture=picture_of,
        record={"models": summary, "quantities": said.record(runs)},
        said=tuple(said.said(runs)),
        notes=list(doubts(runs[0].scene)),
    )


def memory_of(scene: PlaneScene, frames: int, models: int) -> int:
    """Bytes that a run of so many models takes, beyond its libraries."""
    domain = scene.domain
    return domain.cells * domain.cells_across * (frames * models * FRAME_BYTES + 200)


def require_memory(scene: PlaneScene, frames: int, models: int) -> None:
    """Refuse a run that would not fit."""
    domain = scene.domain
    memory.require(
        f"domain.cells = {domain.cells} by {domain.cells_across} with --frames = {frames}",
        memory_of(scene, frames, models),
    )


@contextmanager
def failures_name_their_key(scene: PlaneScene) -> Iterator[None]:
    """Turn what numbers that are too large end in into a line that names a key."""
    cells = f"domain.cells = {scene.domain.cells} by {scene.domain.cells_across}"
    try:
        with np.errstate(over="raise", divide="raise", invalid="raise"):
            yield
    except MemoryError as failure:
        raise SceneError(f"{cells}: {failure or 'took all memory there is'}") from None
    except ArithmeticError as failure:
        raise SceneError(
            f"time.until = {scene.time.until!r}, {cells}: numbers of this scene are too large or "
            f"too small to compute with ({failure})"
        ) from None
