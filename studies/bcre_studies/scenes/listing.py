"""The built-in scenes by name and title, without reading what they describe."""

from __future__ import annotations

import tomllib
from pathlib import Path

BUILT_IN = Path(__file__).parent / "built_in"
ON_A_PLANE = Path(__file__).parent / "plane" / "built_in"


def built_in_names() -> list[str]:
    """Names of the built-in scenes on a line."""
    return _names(BUILT_IN)


def plane_names() -> list[str]:
    """Names of the built-in scenes on a plane."""
    return _names(ON_A_PLANE)


def line_and_plane_names() -> list[str]:
    """Names of all built-in scenes."""
    return built_in_names() + plane_names()


def path_of(name: str) -> Path | None:
    """The file of a built-in scene; None for any other name."""
    if name in built_in_names():
        return BUILT_IN / f"{name}.toml"
    return ON_A_PLANE / f"{name}.toml" if name in plane_names() else None


RESCALED = ("figure1_sand",)
"""Those that are another one in another unit of height, and so have nothing new for a study."""


def studied_names() -> list[str]:
    """Names of the built-in scenes that a study of all scenes runs."""
    return [name for name in built_in_names() if name not in RESCALED]


def built_in_title(name: str) -> str:
    """Title of a built-in scene."""
    path = path_of(name)
    assert path is not None
    return str(tomllib.loads(path.read_text(encoding="utf-8"))["title"])


def _names(folder: Path) -> list[str]:
    return sorted(path.stem for path in folder.glob("*.toml"))
