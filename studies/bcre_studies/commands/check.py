"""``bcre check``: do all verdicts still stand?"""

from __future__ import annotations

import sys

import click

from bcre_studies.commands.options import examples


@click.command(epilog=examples("bcre check"))
def check() -> None:
    """Judge all claims again; exit 1 where a verdict differs from the recorded one."""
    from bcre_studies.catalog import STUDIES
    from bcre_studies.publishing.finding import find
    from bcre_studies.publishing.write import recorded_verdicts, verdict_table
    from bcre_studies.system.sources import require_records

    recorded = recorded_verdicts()
    for entry in STUDIES.values():
        require_records(f"bcre_studies.{entry.module}")
    verdicts = verdict_table([find(name) for name in STUDIES])
    both = verdicts.merge(
        recorded, how="outer", on=["study", "claim"], suffixes=("", "_recorded")
    ).fillna("(none)")
    differs = both["verdict"] != both["verdict_recorded"]
    for row, differing in zip(both.itertuples(), differs, strict=True):
        before = f", recorded as: {row.verdict_recorded}" if differing else ""
        click.echo(f"{row.study}: {row.claim}: {row.verdict}{before}")
    click.echo(f"{len(both)} claims, {differs.sum()} differ from the recorded ones")
    if differs.any():
        sys.exit(1)
