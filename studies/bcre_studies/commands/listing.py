"""``bcre list``: the built-in scenes and the studies."""

from __future__ import annotations

import click

from bcre_studies.commands.options import examples


@click.command("list", epilog=examples("bcre list"))
def list_all() -> None:
    """List the built-in scenes and the studies."""
    from bcre_studies.catalog import STUDIES
    from bcre_studies.scenes.listing import built_in_title, line_and_plane_names

    click.echo("Scenes (bcre run SCENE):")
    for name in line_and_plane_names():
        click.echo(f"  {name:24}{built_in_title(name)}")
    click.echo("Studies (bcre study NAME):")
    for name, entry in STUDIES.items():
        click.echo(f"  {name:24}{entry.title}")
