"""``bcre sweep``: many scenes, on this machine or on a cluster."""

from __future__ import annotations

from pathlib import Path

import click

from bcre_studies.commands import options


@click.command(
    epilog=options.examples("bcre sweep my_sweep.toml --dry-run", "bcre sweep my_sweep.toml")
)
@click.argument("spec", type=click.Path(dir_okay=False, path_type=Path), metavar="SPEC.toml")
@click.option(
    "--out", type=click.Path(file_okay=False, path_type=Path), help="Folder  [default: out/SPEC]"
)
@click.option("--dry-run", is_flag=True, help="Say what it would take; write nothing.")
@options.scheduler
def sweep(spec: Path, out: Path | None, dry_run: bool, scheduler: str | None) -> None:
    """Measure every point of SPEC.toml; write points.parquet. Run again, a stopped one goes on."""
    from bcre_studies.sweeps import sweep as engine
    from bcre_studies.sweeps.of_spec import sweep_of
    from bcre_studies.sweeps.progress import span
    from bcre_studies.sweeps.spec import load_spec
    from bcre_studies.sweeps.table import TABLE
    from bcre_studies.system.files import require_writable

    folder = Path("out") / spec.stem if out is None else out
    require_writable("--out", folder, (TABLE,))
    wanted = sweep_of(load_spec(spec))
    if dry_run:
        click.echo(engine.estimate(wanted, scheduler))
        return
    done = engine.run(wanted, folder, scheduler, lambda line: click.echo(line, err=True))
    if done.measured:
        click.echo(
            f"measured {done.measured} points in {span(done.seconds)} on {done.workers} workers, "
            f"busy {done.busy:.0%} of the time; {done.failed} failed, {done.repeated} repeated"
        )
    click.echo(f"wrote {folder / TABLE}, {done.points} points")
