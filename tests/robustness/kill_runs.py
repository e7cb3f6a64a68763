"""Kill runs of `bcre study` at random times and report what they leave.

    python tests/robustness/kill_runs.py --kills 100 [--seed 1] [--out kills.csv]

Works in a temporary copy of the project; the project's own reports and store are not touched.
Ends with exit code 1 where a file was half or lost, a worker outlived its run, a finished case was
measured again, or the last run did not write what an undisturbed one writes.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from dataclasses import asdict
from pathlib import Path

import pandas as pd

from kills import Copy, Series, kill_in_turn, two_at_once

STUDIES = ("one_variable", "printed_rule")
"""Studies of a few seconds, with some cases each."""

BAD = ["half", "lost", "workers_alive", "damaged", "redone"]


def table_of(series: Series) -> pd.DataFrame:
    """One row a signal and target: the number of kills, and what they left."""
    rows = [
        {"signal": sent.name, "sent to": "group" if whole_group else "run alone", "kills": 1}
        | asdict(found)
        for sent, whole_group, found in series.rows
    ]
    return pd.DataFrame(rows).groupby(["signal", "sent to"], sort=False).sum().reset_index()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, help="write the table as CSV")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        copy = Copy.make(Path(folder))
        copy.run(STUDIES)
        series = kill_in_turn(copy, STUDIES, given.kills, given.seed)
        together = two_at_once(copy, STUDIES)
    table = table_of(series)
    print(table.to_string(index=False))
    print(f"undisturbed run and run after {given.kills} kills write the same: {series.equal}")
    print(f"temporary files after it: {series.leftovers}")
    print(f"two runs at once write the same as one: {together}")
    if given.out is not None:
        table.to_csv(given.out, index=False)
    good = not table[BAD].to_numpy().any() and series.equal and not series.leftovers and together
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
