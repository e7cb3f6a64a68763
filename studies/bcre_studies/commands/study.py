"""``bcre study``: some of the studies."""

from __future__ import annotations

import click

from bcre_studies import catalog
from bcre_studies.commands import options


@click.command(
    "study",
    epilog=options.examples(
        "bcre study second_critical_angle", "bcre study stability printed_rule"
    ),
)
@click.argument(
    "names",
    nargs=-1,
    required=True,
    metavar="NAME...",
    shell_complete=options.complete_from([*catalog.STUDIES]),
)
@options.scheduler
def run_studies(names: tuple[str, ...], scheduler: str | None) -> None:
    """Run studies (see bcre list), write their reports and print their conclusions."""
    for name in names:
        if name not in catalog.STUDIES:
            allowed = ", ".join(catalog.STUDIES)
            raise click.UsageError(f"NAME = {name!r}: must be one of {allowed}")
    from bcre_studies.publishing.write import write_studies
    from bcre_studies.sweeps import parallel

    with parallel.on(scheduler):
        findings = write_studies(names)
    for finding in findings:
        for claim in finding.claims:
            click.echo(f"{finding.name}: {claim.statement} {claim.verdict}: {claim.evidence}.")
