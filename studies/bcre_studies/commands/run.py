"""``bcre run``: one scene in one model or more."""

from __future__ import annotations

from pathlib import Path

import click

from bcre_studies.commands import options
from bcre_studies.models.registry import BOTH, CHOICES


@click.command(
    epilog=options.examples(
        "bcre run figure2",
        "bcre run figure1 --set v=0.2 --set cells=200 --model ca --frames 21",
        "bcre run my_scene.toml --out results",
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
@click.option("--animate", is_flag=True, help="Write animation.gif too, of a scene on a plane.")
def run(
    scene: str,
    model: str | None,
    assignments: tuple[str, ...],
    frames: int,
    out: Path | None,
    animate: bool,
) -> None:
    """Run SCENE, a built-in name or a TOML file; write profiles.csv and summary.json.

    Of a scene on a plane: frames.nc, summary.json and picture.png.
    """
    from bcre_studies.on_plane import command as on_plane
    from bcre_studies.running.place import (
        FILES,
        SUMMARY,
        Origin,
        require_apart,
        require_own,
        scenes_of,
    )
    from bcre_studies.scenes.scene import load
    from bcre_studies.system.files import require_writable

    origin = Origin(scene, assignments)
    folder = out or Path("out") / origin.name
    if on_plane.takes(scene):
        for line in on_plane.run(origin, model, frames, folder, out is None, animate):
            click.echo(line)
        return
    if animate:
        raise click.UsageError("--animate: must be left out for a scene on a line")
    model = model or BOTH
    require_writable("--out", folder, FILES)
    loaded = load(scene, assignments)  # what is refused here need not wait for the solvers
    require_apart("--out", [folder / name for name in FILES], origin.inputs(loaded))
    if out is None:
        require_own(folder / SUMMARY, scenes_of(folder / SUMMARY), origin)
    from bcre_studies.running.run import notes, run_scene, write_run

    summary = write_run(run_scene(loaded, model, frames), folder, origin)
    for note in notes(loaded, model):
        click.echo(f"note: {note}", err=True)
    for name, numbers in summary.items():
        facts = ", ".join(f"{key} {_short(value)}" for key, value in numbers.items())
        click.echo(f"{name}: {facts}")
    click.echo(f"wrote {folder / 'profiles.csv'} and {folder / 'summary.json'}")


def _short(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)
