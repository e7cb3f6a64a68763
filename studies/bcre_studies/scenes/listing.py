"""The built-in scenes by name and title, without reading what they describe."""

from __future__ import annotations

import tomllib
from pathlib import Path

BUILT_IN = Path(__file__).parent / "built_in"


def built_in_names() -> list[str]:
    """Names of the built-in scenes."""
    return sorted(path.stem for path in BUILT_IN.glob("*.toml"))


def built_in_title(name: str) -> str:
    """Title of a built-in scene."""
    text = (BUILT_IN / f"{name}.toml").read_text(encoding="utf-8")
    return str(tomllib.loads(text)["title"])
