"""``bcre play``: a scene on a plane, live in a browser."""

from __future__ import annotations

import click

from bcre_studies.commands import options


@click.command(
    epilog=options.examples(
        "bcre play pouring_a_heap", "bcre play terrain --set surface.0.file=my_terrain.asc --open"
    )
)
@options.scene
@options.assignments
@click.option(
    "--port", type=click.IntRange(0, 65535), default=0, help="[default: any that is free]"
)
@click.option("--open", "show", is_flag=True, help="Open a browser.")
def play(scene: str, assignments: tuple[str, ...], port: int, show: bool) -> None:
    """Show SCENE, one on a plane, live on a page of this machine; Ctrl-C ends it.

    The page has sliders for v, D, gamma and Sc. The pointer pours sand.
    """
    import asyncio
    from contextlib import suppress

    from bcre_studies.on_plane import command as on_plane
    from bcre_studies.scenes.plane.scene import load

    if not on_plane.takes(scene):
        raise ValueError(f"SCENE = {scene!r}: must be a scene on a plane; bcre list names them")
    loaded = load(scene, assignments)

    from bcre_studies.playing.server import serve

    def started(address: str) -> None:
        click.echo(f"{loaded.title}: {address} (Ctrl-C ends it)")
        if show:
            click.launch(address)

    with suppress(KeyboardInterrupt):
        asyncio.run(serve(loaded, port, started))
