"""``bcre show``: what will be run, before anything is."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from bcre_studies.commands import options

if TYPE_CHECKING:
    from bcre_studies.preview.phrases import Line

WIDTH = 18
"""Of the names on the left."""


@click.command(
    epilog=options.examples(
        "bcre show figure1",
        "bcre show triangular_avalanche",
        "bcre show my_scene.toml --set cells=400 --frames 101",
    )
)
@options.scene
@options.assignments
@options.frames
def show(scene: str, assignments: tuple[str, ...], frames: int) -> None:
    """Say what a run of SCENE would be: equations, numbers, stable steps, regime, cost.

    Nothing is run.
    """
    from rich.console import Console
    from rich.text import Text

    from bcre_studies.on_plane import command as on_plane

    said = _on_plane if on_plane.takes(scene) else _on_line
    rows = said(scene, assignments, frames)
    console = Console(markup=False, highlight=False)
    for name, text in rows:
        line = Text(f"{name}:" if name else "", style="bold")
        line.pad_right(WIDTH - len(line))
        console.print(line.append(text, style="not bold"), soft_wrap=True)


def _on_line(scene: str, assignments: tuple[str, ...], frames: int) -> list[Line]:
    from bcre_studies.preview.text import lines
    from bcre_studies.running.run import failures_name_their_key
    from bcre_studies.scenes.scene import load

    loaded = load(scene, assignments)
    with failures_name_their_key(loaded):
        return list(lines(loaded, frames, scene))


def _on_plane(scene: str, assignments: tuple[str, ...], frames: int) -> list[Line]:
    from bcre_studies.on_plane.command import failures_name_their_key
    from bcre_studies.on_plane.preview import lines
    from bcre_studies.scenes.plane.scene import load

    loaded = load(scene, assignments)
    with failures_name_their_key(loaded):
        return list(lines(loaded, frames))
