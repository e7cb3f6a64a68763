"""``bcre show``: what will be run, before anything is."""

from __future__ import annotations

import click

from bcre_studies.commands import options

WIDTH = 18
"""Of the names on the left."""


@click.command(
    epilog=options.examples(
        "bcre show figure1", "bcre show my_scene.toml --set cells=400 --frames 101"
    )
)
@options.scene
@options.assignments
@options.frames
def show(scene: str, assignments: tuple[str, ...], frames: int) -> None:
    """Say what a run of SCENE would be: equations, numbers, stable steps, regime, cost.

    Nothing is run.
    """
    from bcre_studies.scenes.scene import load

    loaded = load(scene, assignments)
    from rich.console import Console
    from rich.text import Text

    from bcre_studies.preview.text import lines
    from bcre_studies.running.run import failures_name_their_key

    with failures_name_their_key(loaded):
        rows = list(lines(loaded, frames, scene))
    console = Console(markup=False, highlight=False)
    for name, text in rows:
        line = Text(f"{name}:" if name else "", style="bold")
        line.pad_right(WIDTH - len(line))
        console.print(line.append(text, style="not bold"), soft_wrap=True)
