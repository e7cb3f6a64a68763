"""The command ``bcre``. Heavy modules are imported when a command needs them."""

from __future__ import annotations

import signal
import sys
import threading
from pathlib import Path

import click

from bcre_studies.commands.sweep import sweep
from bcre_studies.models.registry import BOTH, CHOICES
from bcre_studies.system.one_line import one_line


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
def app() -> None:
    """Does a two-layer cellular automaton of sandpiles do what the BCRE equations do?"""


app.add_command(sweep)


@app.command("list")
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


@app.command()
@click.argument("scene")
@click.option(
    "--model",
    type=click.Choice(CHOICES),
    help=f"[default: {BOTH}; on a plane ca]",
)
@click.option(
    "--set",
    "assignments",
    multiple=True,
    metavar="KEY=VALUE",
    help="Override a value, e.g. v=0.2 or rolling.0.width=1; may be repeated.",
)
@click.option(
    "--frames",
    type=click.IntRange(2, 10_000),
    default=11,
    show_default=True,
    help="Frames, from t = 0 to the end.",
)
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

    On a plane: frames.nc, summary.json and picture.png.
    """
    from bcre_studies.on_plane import command as plane
    from bcre_studies.scenes.scene import load
    from bcre_studies.system.files import require_writable

    folder = Path("out") / Path(scene).stem if out is None else out
    if plane.takes(scene):
        for line in plane.run(scene, assignments, model, frames, folder, animate):
            click.echo(line)
        return
    if animate:
        raise click.UsageError("--animate: must be left out for a scene on a line")
    model = model or BOTH
    require_writable("--out", folder, ("profiles.csv", "summary.json"))
    loaded = load(scene, assignments)  # what is refused here need not wait for the solvers
    from bcre_studies.running.run import notes, run_scene, write_run

    summary = write_run(run_scene(loaded, model, frames), folder)
    for note in notes(loaded, model):
        click.echo(f"note: {note}", err=True)
    for name, numbers in summary.items():
        facts = ", ".join(f"{key} {_short(value)}" for key, value in numbers.items())
        click.echo(f"{name}: {facts}")
    click.echo(f"wrote {folder / 'profiles.csv'} and {folder / 'summary.json'}")


@app.command()
@click.argument("scene")
@click.option("--tolerance", type=float, default=0.05, show_default=True, help="Relative error.")
@click.option(
    "--observable",
    default="R",
    show_default=True,
    help="R, h, slope, roughness, front, eroded, reach or top.",
)
@click.option("--budget", metavar="TIME", help="Time per frame, e.g. 16ms: as accurate as it lets.")
@click.option("--frames", type=click.IntRange(2, 10_000), default=11, show_default=True)
@click.option("--set", "assignments", multiple=True, metavar="KEY=VALUE", help="As for bcre run.")
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
    """Which model and cells answer SCENE to a tolerance at the least cost; by short pilots."""
    from bcre_studies.advisor.advice_text import answer
    from bcre_studies.advisor.question import Question, seconds_of
    from bcre_studies.scenes.scene import load

    seconds = None if budget is None else seconds_of(budget)
    question = Question(load(scene, assignments), tolerance, observable, seconds, frames)
    path = Path("out") / f"{Path(scene).stem}-advice.toml" if out is None else out
    click.echo(answer(question, Path(scene).stem, path))


scheduler_option = click.option(
    "--scheduler", metavar="ADDRESS", help="Dask scheduler, tcp://host:port  [default: all cores]"
)


@app.command("study")
@click.argument("names", nargs=-1, required=True, metavar="NAME...")
@scheduler_option
def run_studies(names: tuple[str, ...], scheduler: str | None) -> None:
    """Run studies (see bcre list), write their reports and print their conclusions."""
    from bcre_studies.catalog import STUDIES

    for name in names:
        if name not in STUDIES:
            allowed = ", ".join(STUDIES)
            raise click.UsageError(f"NAME = {name!r}: must be one of {allowed}")
    from bcre_studies.publishing.write import write_studies
    from bcre_studies.sweeps import parallel

    with parallel.on(scheduler):
        findings = write_studies(names)
    for finding in findings:
        for claim in finding.claims:
            click.echo(f"{finding.name}: {claim.statement} {claim.verdict}: {claim.evidence}.")


@app.command()
@scheduler_option
def report(scheduler: str | None) -> None:
    """Run all studies and write reports/ with its index."""
    from bcre_studies.publishing.write import write_all
    from bcre_studies.sweeps import parallel
    from bcre_studies.system.files import REPORTS

    with parallel.on(scheduler):
        findings = write_all()
    claims = [claim for finding in findings for claim in finding.claims]
    click.echo(f"{len(claims)} claims judged; read {REPORTS / 'README.md'}")


@app.command()
@click.option(
    "--record", is_flag=True, help="Renew the committed record in reports/speed (some minutes)."
)
def speed(record: bool) -> None:
    """Measure speed on this machine into reports/local (a minute)."""
    from bcre_studies.performance.record.page import write
    from bcre_studies.performance.record.record import LOCAL, RECORD, measure_local, measure_record
    from bcre_studies.performance.rivals import fipy_solver

    if record and not fipy_solver.available():
        click.echo("FiPy is not installed and takes no part (make bench installs it)", err=True)
    folder = RECORD if record else LOCAL
    write(folder, measure_record() if record else measure_local())
    click.echo(f"wrote {folder / 'README.md'}")


@app.command()
def check() -> None:
    """Judge all claims again; exit 1 where a verdict differs from the recorded one."""
    from bcre_studies.catalog import STUDIES
    from bcre_studies.publishing.finding import find
    from bcre_studies.publishing.write import recorded_verdicts, verdict_table

    recorded = recorded_verdicts()
    verdicts = verdict_table([find(name) for name in STUDIES])
    both = verdicts.merge(
        recorded, how="outer", on=["study", "claim"], suffixes=("", "_recorded")
    ).fillna("(none)")
    differs = both["verdict"] != both["verdict_recorded"]
    for row, differing in zip(both.itertuples(), differs, strict=True):
        before = f", recorded as: {row.verdict_recorded}" if differing else ""
        click.echo(f"{row.study}: {row.claim}: {row.verdict}{before}")
    click.echo(f"{len(both)} claims, {differs.sum()} differ from reports/verdicts.csv")
    if differs.any():
        sys.exit(1)


def _short(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def main() -> None:
    """Run the command; bad input ends in one line on standard error and exit 2."""
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGTERM, signal.default_int_handler)  # ends the workers too
    try:
        app(standalone_mode=False)
    except click.exceptions.NoArgsIsHelpError as error:
        click.echo(error.format_message())
    except click.ClickException as error:
        _refuse(error.format_message())
    except (click.Abort, KeyboardInterrupt):
        click.echo("bcre: interrupted; every file written before is whole", err=True)
        sys.exit(130)
    except (ValueError, OSError, ArithmeticError) as error:
        _refuse(str(error))
    except MemoryError as error:
        _refuse(f"not enough memory: {error}")


def _refuse(message: str) -> None:
    click.echo(f"bcre: {one_line(message)}", err=True)
    sys.exit(2)
