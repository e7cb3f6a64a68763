"""Where the results of a scene go: never over what they are made from, nor over another scene's."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from bcre_studies.scenes.listing import path_of
from bcre_studies.scenes.plane.scene import PlaneScene
from bcre_studies.scenes.refusal import SceneError
from bcre_studies.scenes.scene import Scene
from bcre_studies.system.files import require_writable
from bcre_studies.system.release import release

AnyScene = TypeVar("AnyScene", Scene, PlaneScene)

PROFILES, SUMMARY = "profiles.csv", "summary.json"
"""What a run writes of its numbers."""


@dataclass(frozen=True)
class Origin:
    """Where a scene came from.

    Parameters
    ----------
    scene: a built-in name, or the path of a TOML file.
    changes: ``key=value``, as they were asked for.
    """

    scene: str
    changes: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """What results are called after."""
        return Path(self.scene).stem

    def inputs(self, scene: Scene | PlaneScene) -> list[Path]:
        """The scene's own file, if it is not built in, and its tables."""
        own = [] if path_of(self.scene) else [Path(self.scene)]
        return own + scene.tables()

    def seen_from(self, folder: Path) -> str:
        """The built-in name, or the path of the file from ``folder``: it moves with the project."""
        if path_of(self.scene):
            return self.scene
        path = Path(self.scene).absolute()
        try:
            return Path(os.path.relpath(path, folder.absolute())).as_posix()
        except ValueError:  # on another drive
            return path.as_posix()

    def record(self, scene: Scene | PlaneScene, folder: Path) -> dict[str, Any]:
        """What it takes to repeat a run, for the summary that is kept in ``folder``."""
        seeds = [term.seed for term in scene.surface if term.kind == "noise"]
        return {
            "scene": self.seen_from(folder),
            "title": scene.title,
            "changes": list(self.changes),
            "version": release(),
            "seed": seeds[0] if len(seeds) == 1 else seeds or None,
        }


def admitted(
    origin: Origin,
    load: Callable[[str, tuple[str, ...]], AnyScene],
    folder: Path,
    files: Sequence[str],
    is_own_folder: bool,
) -> AnyScene:
    """The scene, once it is sure that its results may be written into ``folder``.

    Parameters
    ----------
    load: of a scene's source and its changes.
    files: names of what may be written.
    is_own_folder: nobody asked for the folder, so that it must not hold another scene's results.

    Raises
    ------
    ValueError
        naming the key, its value and what is allowed.
    """
    require_writable("--out", folder, files)
    scene = load(origin.scene, origin.changes)
    require_apart("--out", [folder / name for name in files], origin.inputs(scene))
    if is_own_folder:
        require_own(folder / SUMMARY, scenes_of(folder / SUMMARY), origin)
    return scene


def require_apart(key: str, outputs: Iterable[Path], inputs: Iterable[Path]) -> None:
    """Refuse to write over what is read.

    Raises
    ------
    SceneError
        naming ``key``, the file and what is allowed.
    """
    read = [path.resolve() for path in inputs]
    for output in outputs:
        real = output.resolve()
        for path in read:
            if real == path or (real.exists() and path.exists() and real.samefile(path)):
                raise SceneError(
                    f"{key} = {str(output)!r}: would overwrite what it is made from; "
                    "must be another place"
                )


def require_own(place: Path, held: Iterable[str], origin: Origin) -> None:
    """Refuse a place that nobody asked for where it holds what came of another scene.

    Parameters
    ----------
    place: a file in it says so.
    held: scenes, as :meth:`Origin.seen_from` the folder of ``place``.

    Raises
    ------
    SceneError
        naming the other scene.
    """
    for other in held:
        if other != origin.seen_from(place.parent):
            raise SceneError(
                f"--out: {place} is of another scene, {other}; must be given for {origin.scene}"
            )


def scenes_of(summary: Path) -> set[str]:
    """The scenes that a summary says it is of; none where it says nothing."""
    try:
        runs = json.loads(summary.read_text(encoding="utf-8")).values()
        return {str(run["scene"]) for run in runs}
    except (OSError, ValueError, LookupError, TypeError, AttributeError):
        return set()
