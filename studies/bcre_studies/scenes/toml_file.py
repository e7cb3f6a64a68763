"""Scene files as tables of values: read strictly, overridden key by key, refused in one line.

Nothing here knows what a scene is made of: which sections and kinds of terms it may have is passed
in by the scene's own module.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from bcre_studies.scenes.domain import StrictTable
from bcre_studies.scenes.listing import line_and_plane_names, path_of
from bcre_studies.scenes.refusal import SceneError

Sections = Mapping[str, type[StrictTable]]

LONGEST = 100_000
"""Bytes of a scene file; it is a page of text, long profiles belong into tables."""

WIDEST = 1_000
"""Characters of one of its lines; keys of very many parts would take hours to be read."""


class AsWritten(float):
    """A number that is shown as it was written: 1e-3, not 0.001."""

    _text: str

    def __new__(cls, text: str) -> AsWritten:
        number = super().__new__(cls, text)
        number._text = str(text)
        return number

    def __repr__(self) -> str:
        return self._text


def read(source: str | Path, overrides: Sequence[str], sections: Sections) -> tuple[Any, Path]:
    """The values of a built-in scene or a TOML file, overridden, and the folder it lies in.

    Parameters
    ----------
    overrides: ``key=value``, the value as in TOML.
    sections: of the scene, where keys without a path are looked up.

    Raises
    ------
    SceneError
        where there is no such file, or it is not TOML.
    """
    path = path_of(str(source)) or Path(source)
    text = _text(path)
    try:
        data = tomllib.loads(text, parse_float=AsWritten)
    except (tomllib.TOMLDecodeError, RecursionError, ValueError) as error:
        raise SceneError(f"{source}: not a TOML file: {error}") from None
    for assignment in overrides:
        key, separator, value = assignment.partition("=")
        if not separator:
            raise SceneError(f"--set {assignment!r}: must be key=value")
        assign(data, key.strip(), _toml_value(value.strip()), sections)
    return data, _folder(path, data)


def _folder(path: Path, data: dict[str, Any]) -> Path:
    """Where the scene's tables lie: beside it, or beside the file that a link leads to."""
    lacks = any(not (path.parent / name).is_file() for name in _files(data))
    return path.resolve().parent if lacks and path.is_symlink() else path.parent


def _files(data: Mapping[str, Any]) -> list[str]:
    """The files that the scene's terms name."""
    layers = [data.get("surface"), data.get("rolling")]
    terms = [term for layer in layers if isinstance(layer, list) for term in layer]
    return [str(term["file"]) for term in terms if isinstance(term, dict) and "file" in term]


def assign(data: dict[str, Any], key: str, value: Any, sections: Sections) -> None:
    """Set ``material.v``, ``rolling.0.width`` or a bare ``v``; the first section with it wins."""
    parts = key.split(".")
    if len(parts) == 1 and key != "title":
        section = next(
            (name for name, model in sections.items() if key in model.model_fields), None
        )
        if section is None:
            allowed = dict.fromkeys(
                field for model in sections.values() for field in model.model_fields
            )
            raise SceneError(
                f"{key} = {value!r}: no such key; allowed are {', '.join(allowed)}, "
                "or a path such as rolling.0.width"
            )
        parts = [section, key]
    place: Any = data
    for part in parts[:-1]:
        if isinstance(place, list):
            if not (part.isascii() and part.isdigit()) or int(part) >= len(place):
                raise SceneError(f"{key} = {value!r}: {part} must be one of 0..{len(place) - 1}")
            place = place[int(part)]
        elif isinstance(place, dict):
            place = place.setdefault(part, {})
        else:
            raise SceneError(f"{key} = {value!r}: no such key")
    if not isinstance(place, dict):
        raise SceneError(f"{key} = {value!r}: no such key")
    place[parts[-1]] = value


def _toml_value(text: str) -> Any:
    try:
        parsed = tomllib.loads(f"value = {text}", parse_float=AsWritten)
    except (ValueError, RecursionError):
        return text
    return parsed["value"] if len(parsed) == 1 else text


def _text(path: Path) -> str:
    names = ", ".join(line_and_plane_names())
    try:
        if not path.is_file():
            raise SceneError(f"{path}: no such scene; must be a TOML file or one of {names}")
        if path.stat().st_size > LONGEST:
            raise SceneError(f"{path}: must be a TOML file of at most {LONGEST} bytes")
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise SceneError(f"{path}: must be UTF-8 text") from None
    except OSError as error:
        raise SceneError(f"{path}: cannot be read: {error.strerror}") from None
    if max(map(len, text.splitlines()), default=0) > WIDEST:
        raise SceneError(f"{path}: must be a TOML file with at most {WIDEST} characters a line")
    return text


def is_on_plane(data: Mapping[str, Any]) -> bool:
    """Whether these are the values of a scene on a plane: it has a width, or a grid as surface."""
    domain = data.get("domain")
    is_wide = isinstance(domain, dict) and "width" in domain
    return is_wide or any(file.lower().endswith((".asc", ".npy")) for file in _files(data))
