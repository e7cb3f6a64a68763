"""``bcre advise``: the cheapest model that answers a scene."""

from __future__ import annotations

from pathlib import Path

import click

from bcre_studies.commands import options


@click.command(
    epilog=options.examples(
        "bcre advise figure2 --tolerance 0.01",
        "bcre advise my_scene.toml --observable front --budget 16ms",
    )
)
@options.scene
@click.option("--tolerance", type=float, default=0.05, show_default=True, help="Relative error.")
@click.option(
    "--observable",
    default="R",
    show_default=True,
    help="R, h, slope, roughness, front, eroded, reach or top.",
)
@click.option("--budget", metavar="TIME", help="Time per frame, e.g. 16ms: asks for accuracy.")
@options.frames
@options.assignments
@click.option(
    "--out",
    type=click.Path(dir_okay=False, path_type=Path),
    help="Scene to be run  [default: out/SCENE-advice.toml]",
)
def advise(
    scene: str,
    tolerance: float,
    observable: str,
    budget: str | None,
    frames: int,
    assignments: tuple[str, ...],
    out: Path | None,
) -> None:
    """Say which model and cells answer SCENE to a tolerance at the least cost.

    Short runs of every model find it, each against a refined solution of BCRE.
    """
    from bcre_studies.advisor.advice_text import advised_of, answer
    from bcre_studies.advisor.question import Question, seconds_of
    from bcre_studies.running.place import Origin, require_apart, require_own
    from bcre_studies.scenes.scene import load

    origin = Origin(scene, assignments)
    path = Path("out") / f"{origin.name}-advice.toml" if out is None else out
    seconds = None if budget is None else seconds_of(budget)
    question = Question(load(scene, assignments), tolerance, observable, seconds, frames)
    require_apart("--out", [path], origin.inputs(question.scene))
    if out is None:
        require_own(path, advised_of(path), origin)
    click.echo(answer(question, origin, path))
