"""``bcre run``: one scene in one model or more."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext, redirect_stderr
from pathlib import Path
from typing import TYPE_CHECKING

import click

from bcre_studies.commands import options
from bcre_studies.models.registry import BOTH, CHOICES

if TYPE_CHECKING:
    from bcre_studies.running.done import Done


@click.command(
    epilog=options.examples(
        "bcre run figure2",
        "bcre run figure1 --set v=0.2 --set cells=200 --model ca --frames 21",
        "bcre run my_scene.toml --out results --open",
        "bcre run figure3 --frames 41 --animate",
        "bcre run figure2 --json > figure2.json",
        "bcre run triangular_avalanche --animate",
    )
)
@options.scene
@click.option("--model", type=click.Choice(CHOICES), help=f"[default: {BOTH}; on a plane ca]")
@options.assignments
@options.frames
@click.option(
    "--out", type=click.Path(file_okay=False, path_type=Path), help="Folder  [default: out/SCENE]"
)
@click.option("--animate", is_flag=True, help="Write animation.gif too.")
@click.option("--open", "show", is_flag=True, help="Open the figure, or the animation.")
@click.option("--json", "as_json", is_flag=True, help="Print numbers for machines, as JSON.")
@click.option("--quiet", is_flag=True, help="Print nothing but refusals.")
def run(
    scene: str,
    model: str | None,
    assignments: tuple[str, ...],
    frames: int,
    out: Path | None,
    animate: bool,
    show: bool,
    as_json: bool,
    quiet: bool,
) -> None:
    """Run SCENE, a built-in name or a TOML file, and print what came out.

    Writes profiles.csv, summary.json and figure.svg; of a scene on a plane frames.nc, summary.json
    and picture.png.
    """
    from bcre_studies.on_line import command as on_line
    from bcre_studies.on_plane import command as on_plane
    from bcre_studies.running.place import Origin

    if as_json and quiet:
        raise click.UsageError("--quiet: must be left out where --json is given")
    origin = Origin(scene, assignments)
    folder = out or Path("out") / origin.name
    command = on_plane if on_plane.takes(scene) else on_line
    with _without_bars() if quiet else nullcontext():
        done = command.run(origin, model, frames, folder, out is None, animate)
    if as_json:
        files = [path.as_posix() for path in done.files]
        click.echo(json.dumps(done.record | {"notes": list(done.notes), "files": files}, indent=2))
    elif not quiet:
        _say(done)
    if show:
        click.launch(str(done.picture))


@contextmanager
def _without_bars() -> Iterator[None]:
    """Show no progress; a refusal is raised through it and printed afterwards."""
    with Path(os.devnull).open("w", encoding="utf-8") as nowhere, redirect_stderr(nowhere):
        yield


def _say(done: Done) -> None:
    from rich.console import Console

    for note in done.notes:
        click.echo(f"note: {note}", err=True)
    console = Console(markup=False, highlight=False)
    for part in done.said:
        console.print(part, soft_wrap=True)
    names = ", ".join(path.name for path in done.files)
    console.print(f"wrote {names} in {done.files[0].parent}", soft_wrap=True)
