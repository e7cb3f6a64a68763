"""What is wrong with a scene file, in one line: the key, the value and what is allowed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, get_args

from bcre_studies.system.one_line import one_line

if TYPE_CHECKING:
    from pydantic import ValidationError


class SceneError(ValueError):
    """A scene that cannot be run; its text is one line naming key, value and what is allowed."""

    def __init__(self, message: str) -> None:
        super().__init__(one_line(message))


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


def kinds_of(union: Any) -> tuple[str, ...]:
    """The kinds that tell the terms of a union from one another."""
    members = get_args(get_args(union)[0])
    return tuple(get_args(member.model_fields["kind"].annotation)[0] for member in members)


def first_of(failure: ValidationError, kinds: Mapping[str, tuple[str, ...]]) -> str:
    """The first thing that pydantic found; ``kinds`` of each list of terms."""
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
