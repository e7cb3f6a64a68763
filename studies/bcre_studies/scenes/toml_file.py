"""Scene files as tables of values: read strictly, overridden key by key, refused in one line.

Nothing here knows what a scene is made of: which sections and kinds of terms it may have is passed
in by the scene's own module.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, get_args

from pydantic import ValidationError

from bcre_studies.scenes.domain import StrictTable
from bcre_studies.scenes.listing import line_and_plane_names, path_of
from bcre_studies.system.one_line import one_line

Sections = Mapping[str, type[StrictTable]]

LONGEST = 100_000
"""Bytes of a scene file; it is a page of text, long profiles belong into tables."""

WIDEST = 1_000
"""Characters of one of its lines; keys of very many parts would take hours to be read."""


class SceneError(ValueError):
    """A scene that cannot be run; its text is one line naming key, value and what is allowed."""

    def __init__(self, message: str) -> None:
        super().__init__(one_line(message))


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
        data = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError, ValueError) as error:
        raise SceneError(f"{source}: not a TOML file: {error}") from None
    for assignment in overrides:
        key, separator, value = assignment.partition("=")
        if not separator:
            raise SceneError(f"--set {assignment!r}: must be key=value")
        assign(data, key.strip(), _toml_value(value.strip()), sections)
    return data, path.parent


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
        parsed = tomllib.loads(f"value = {text}")
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
        text = path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        raise SceneError(f"{path}: must be UTF-8 text") from None
    except OSError as error:
        raise SceneError(f"{path}: cannot be read: {error.strerror}") from None
    if max(map(len, text.splitlines()), default=0) > WIDEST:
        raise SceneError(f"{path}: must be a TOML file with at most {WIDEST} characters a line")
    return text


def refuse_long_integers(data: dict[str, Any]) -> None:
    """Integers are of 64 bits in TOML; longer ones cannot even be shown."""
    todo: list[tuple[str, Any]] = [("", data)]
    while todo:
        key, value = todo.pop()
        if isinstance(value, dict):
            todo += [(f"{key}.{name}", part) for name, part in value.items()]
        elif isinstance(value, list):
            todo += [(f"{key}.{index}", part) for index, part in enumerate(value)]
        elif isinstance(value, int) and value.bit_length() > 63:
            raise SceneError(
                f"{key[1:]} = an integer of {value.bit_length()} bits: must be one of at most 63"
            )


def is_on_plane(data: Mapping[str, Any]) -> bool:
    """Whether these are the values of a scene on a plane: it has a width, or a grid as surface."""
    domain, terms = data.get("domain"), data.get("surface")
    files = [
        str(term.get("file", ""))
        for term in (terms if isinstance(terms, list) else [])
        if isinstance(term, dict)
    ]
    is_wide = isinstance(domain, dict) and "width" in domain
    return is_wide or any(file.lower().endswith((".asc", ".npy")) for file in files)


def kinds_of(union: Any) -> tuple[str, ...]:
    """The kinds that a union of terms is discriminated by."""
    members = get_args(get_args(union)[0])
    return tuple(get_args(member.model_fields["kind"].annotation)[0] for member in members)


def first_of(failure: ValidationError, kinds: Mapping[str, tuple[str, ...]]) -> str:
    """The first of the errors in one line; ``kinds`` of each list of terms."""
    errors = failure.errors()
    # Of a choice (a number or "auto") every alternative reports; the first one speaks for all.
    error = errors[0]
    message = " ".join(error["msg"].removeprefix("Value error, ").split())
    if error["type"] == "value_error":
        return message
    variants = {kind for names in kinds.values() for kind in names}
    key = ".".join(str(part) for part in error["loc"] if part not in variants)
    if error["loc"][-1:] == ("constrained-float",) or "literal" in str(error["loc"][-1]):
        key = ".".join(str(part) for part in error["loc"][:-1])
        message += " (or be 'auto')" if key.endswith("step") else ""
    if error["type"] == "missing":
        return f"{key}: missing; this key is required"
    if error["type"].startswith("union_tag"):
        kind = error["input"].get("kind") if isinstance(error["input"], dict) else error["input"]
        expected = ", ".join(map(repr, kinds[str(error["loc"][0])]))
        return f"{key}.kind = {_short(kind)}: must be one of {expected}"
    if error["type"] == "extra_forbidden":
        return f"{key} = {_short(error['input'])}: no such key is allowed here"
    if error["type"] == "tuple_type":
        return f"{key} = {_short(error['input'])}: must be a list of tables, [[{key}]]"
    allowed = message.replace("Input should be", "must be")
    return f"{key} = {_short(error['input'])}: {allowed}"


def _short(value: object) -> str:
    try:
        text = repr(value)
    except (RecursionError, ValueError):
        return f"({type(value).__name__} too long or too deep to be shown)"
    return text if len(text) <= 80 else f"{text[:77]}..."
