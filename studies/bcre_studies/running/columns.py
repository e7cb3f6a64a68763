"""The table that a command prints of a run: names on the left, numbers in columns."""

from __future__ import annotations

from collections.abc import Sequence

from rich.table import Table

from bcre_studies.comparison.rounding import significant
from bcre_studies.models.plane.run import PlaneRun
from bcre_studies.models.run import Run

BOLD = "apart"
"""The column that readers look for."""


def headed(heads: Sequence[str]) -> Table:
    """An empty table with a column of names and one under each of these heads."""
    table = Table(box=None, pad_edge=False, header_style="bold", padding=(0, 2, 0, 0))
    table.add_column("")
    for head in heads:
        table.add_column(head, justify="right", style="bold" if head == BOLD else None)
    return table


def add_effort(table: Table, runs: Sequence[Run] | Sequence[PlaneRun]) -> None:
    """What each run took, and whether it kept its sand."""
    table.add_row("steps", *(f"{run.steps}" for run in runs))
    table.add_row("time of the run", *(f"{significant(run.wall_s, 2):g} s" for run in runs))
    table.add_row("balance of mass", *(f"{run.mass_error():.1e}" for run in runs))
