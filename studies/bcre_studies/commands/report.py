"""``bcre report``: all studies and the pages that show them."""

from __future__ import annotations

import click

from bcre_studies.commands import options


@click.command(epilog=options.examples("bcre report", "bcre report --scheduler tcp://node1:8786"))
@options.scheduler
def report(scheduler: str | None) -> None:
    """Run all studies and write reports/ with its index."""
    from bcre_studies.publishing.write import write_all
    from bcre_studies.sweeps import parallel
    from bcre_studies.system.files import REPORTS

    with parallel.on(scheduler):
        findings = write_all()
    claims = [claim for finding in findings for claim in finding.claims]
    click.echo(f"{len(claims)} claims judged; read {REPORTS / 'README.md'}")
