"""The table that a command prints of a run: names on the left, numbers in columns."""

from __future__ import annotations

from collections.abc import Sequence

from rich.table import Table

BOLD = "apart"
"""The column that readers look for."""


def headed(heads: Sequence[str]) -> Table:
    """An empty table with a column of names and one under each of these heads."""
    table = Table(box=None, pad_edge=False, header_style="bold", padding=(0, 2, 0, 0))
    table.add_column("")
    for head in heads:
        table.add_column(head, justify="right", style="bold" if head == BOLD else None)
    return table
