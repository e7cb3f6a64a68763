"""Arguments and options that several commands share."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import click
from click.shell_completion import CompletionItem

from bcre_studies.scenes.listing import line_and_plane_names


class SceneName(click.ParamType[str]):
    """A built-in name or a TOML file; a shell completes both."""

    name = "scene"

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        names = [name for name in line_and_plane_names() if name.startswith(incomplete)]
        return [*map(CompletionItem, names), CompletionItem(incomplete, type="file")]


def examples(*lines: str) -> str:
    """The end of a command's help; ``lines`` are what a user would type."""
    return "\b\nExamples:\n" + "\n".join(f"  {line}" for line in lines)


def complete_from(names: Sequence[str]) -> Any:
    """A ``shell_complete`` that offers these names."""
    return lambda _context, _parameter, typed: [name for name in names if name.startswith(typed)]


scene = click.argument("scene", type=SceneName())

assignments = click.option(
    "--set",
    "assignments",
    multiple=True,
    metavar="KEY=VALUE",
    help="Override a value, e.g. v=0.2 or rolling.0.width=1; may be repeated.",
)

frames = click.option(
    "--frames",
    type=click.IntRange(2, 10_000),
    default=11,
    show_default=True,
    help="Frames, from t = 0 to the end.",
)

scheduler = click.option(
    "--scheduler",
    metavar="ADDRESS",
    help="Dask scheduler, tcp://host:port  [default: all cores]",
)
