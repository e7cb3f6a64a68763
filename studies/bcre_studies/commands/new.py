"""``bcre new``: a scene file to start from."""

from __future__ import annotations

import shlex
from pathlib import Path

import click

from bcre_studies.commands import options


@click.command(epilog=options.examples("bcre new my_scene", "bcre new gully --survey transect.csv"))
@click.argument("name", type=click.Path(path_type=Path))
@click.option(
    "--survey",
    type=click.Path(dir_okay=False, path_type=Path),
    help="CSV with the columns x,h: the surface at the start.",
)
def new(name: Path, survey: Path | None) -> None:
    """Write NAME.toml, a commented scene that runs as it stands; a file is never overwritten."""
    from bcre_studies.preview.draft import draft
    from bcre_studies.scenes.listing import path_of
    from bcre_studies.system.files import require_writable

    if not name.name:
        raise click.UsageError(f"NAME = {str(name)!r}: must be the name of a new file")
    path = name if name.suffix == ".toml" else name.with_name(f"{name.name}.toml")
    if path.exists() or path.is_symlink():
        raise click.UsageError(f"NAME = {str(name)!r}: {path} exists; must be a new file")
    if path_of(path.stem) is not None:
        raise click.UsageError(
            f"NAME = {str(name)!r}: is a built-in scene's; must be another (see bcre list)"
        )
    require_writable("NAME", path.parent)
    text = draft(path, survey)
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("x", encoding="utf-8") as file:  # another may have written it meanwhile
        file.write(text)
    quoted = shlex.quote(str(path))
    click.echo(
        f"wrote:    {path}\nsee it:   bcre show {quoted}\nrun it:   bcre run {quoted} --open"
    )
