"""A scene as the text of a TOML file that can be run from another folder."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

from bcre_studies.scenes.scene import Scene


def scene_text(scene: Scene, folder: Path, *comments: str) -> str:
    """The TOML text of a scene to be kept in ``folder``, as ``scenes.scene.load`` reads it.

    Tables keep their place: their paths are given relative to ``folder``.

    Parameters
    ----------
    comments: lines that stand at the top, each beginning with #.
    """
    data = scene.model_dump(exclude_unset=True, mode="json")
    for term in (*data.get("surface", ()), *data.get("rolling", ())):
        if "file" in term:
            path = (scene._folder / term["file"]).resolve()
            term["file"] = os.path.relpath(path, folder.resolve())
    lines = [*comments]
    lines += _pairs({key: value for key, value in data.items() if _is_plain(value)})
    for key, value in data.items():
        if isinstance(value, dict):
            lines += ["", f"[{key}]", *_pairs(value)]
        elif isinstance(value, list):
            for term in value:
                lines += ["", f"[[{key}]]", *_pairs(term)]
    return "\n".join(lines) + "\n"


def _is_plain(value: Any) -> bool:
    return not isinstance(value, dict | list)


def _pairs(table: dict[str, Any]) -> list[str]:
    return [f"{key} = {_toml(value)}" for key, value in table.items() if value is not None]


def _toml(value: Any) -> str:
    """Strings as in JSON, which TOML reads but for the character 127; numbers as in Python."""
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    return repr(value)
