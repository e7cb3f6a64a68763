"""``bcre speed``: how fast this machine is."""

from __future__ import annotations

import click

from bcre_studies.commands.options import examples


@click.command(epilog=examples("bcre speed", "bcre speed --record"))
@click.option(
    "--record", is_flag=True, help="Renew the committed record in reports/speed (some minutes)."
)
def speed(record: bool) -> None:
    """Measure speed on this machine into reports/local (a minute)."""
    from bcre_studies.performance.record.page import write
    from bcre_studies.performance.record.record import LOCAL, RECORD, measure_local, measure_record
    from bcre_studies.performance.rivals import fipy_solver
    from bcre_studies.system.files import require_writable

    if record and not fipy_solver.available():
        click.echo("FiPy is not installed and takes no part (make bench installs it)", err=True)
    folder = RECORD if record else LOCAL
    require_writable(f"reports/{folder.name}", folder, ("README.md",))
    write(folder, measure_record() if record else measure_local())
    click.echo(f"wrote {folder / 'README.md'}")
