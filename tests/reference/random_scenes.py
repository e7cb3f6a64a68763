"""Hold random scenes against plain integrations: ``make reference``.

Prints, for every check, how many scenes it concerned, how many break it, and the worst of them;
before that the scenes that break a check, which ``--first N --scenes 1`` draws again. The exit code
is 1 if any does.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
import traceback
import warnings
from collections.abc import Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple

from tabulate import tabulate

from drawn_scenes import OPTIONS, Drawn, draw
from judged import CHECKS, Found, judge


class Row(NamedTuple):
    """A scene's checks, or the traceback of what broke off; and the seconds that it took."""

    index: int
    found: dict[str, Found]
    broke: str
    seconds: float

    @property
    def holds(self) -> bool:
        return not self.broke and all(found.holds for found in self.found.values())


def judged(index: int) -> Row:
    """One scene, whatever comes of it."""
    began = time.perf_counter()
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings(action="error"):
        try:
            found, broke = judge(draw(index), Path(folder)), ""
        except Exception:
            found, broke = {}, traceback.format_exc().strip()
    return Row(index, found, broke, time.perf_counter() - began)


def results(indices: Iterable[int], workers: int) -> Iterator[Row]:
    """The scenes in turn, shared out among so many processes."""
    if workers == 1:
        yield from map(judged, indices)
        return
    with ProcessPoolExecutor(workers) as pool:
        yield from pool.map(judged, indices)


def summary(rows: list[Row]) -> list[dict[str, Any]]:
    """A line for every check."""
    table = []
    for check in CHECKS:
        numbers = [(row.found[check], row.index) for row in rows if check in row.found]
        broken = [index for number, index in numbers if not number.holds]
        if not numbers:
            table.append({"check": check, "scenes": 0})
            continue
        worst, at = max(numbers, key=lambda pair: pair[0].value / (pair[0].allowed or 1e-300))
        table.append(
            {
                "check": check,
                "scenes": len(numbers),
                "broken": len(broken),
                "worst": f"{worst.value:.3g}",
                "allowed": f"{worst.allowed:.3g}",
                "scene": at,
            }
        )
    return table


def options_met(scenes: Iterable[Drawn]) -> str:
    """How many scenes had each option, and the rarest pair of two options."""
    drawn = [scene.options for scene in scenes]
    lines = []
    for name, (values, _) in OPTIONS.items():
        counts = (f"{value} {sum(row[name] == value for row in drawn)}" for value in values)
        lines.append(f"{name}: {', '.join(counts)}")
    pairs = {
        (a, value, b, other): sum(row[a] == value and row[b] == other for row in drawn)
        for a in OPTIONS
        for b in OPTIONS
        if a < b
        for value in OPTIONS[a][0]
        for other in OPTIONS[b][0]
    }
    missing = [pair for pair, count in pairs.items() if count == 0]
    lines.append(f"pairs of options: {len(pairs)}, of which {len(missing)} were never drawn")
    return "\n".join(lines)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenes", type=int, default=300)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--show", action="store_true", help="print every scene and its checks")
    arguments = parser.parse_args()
    indices = range(arguments.first, arguments.first + arguments.scenes)
    rows = []
    for row in results(indices, arguments.workers):
        rows.append(row)
        if not row.holds or arguments.show:
            shown = {n: f for n, f in row.found.items() if arguments.show or not f.holds}
            text = ", ".join(f"{n} {f.value:.3g} ({f.allowed:.3g})" for n, f in shown.items())
            print(f"scene {row.index} ({row.seconds:.1f} s): {row.broke or text}", flush=True)
    print(options_met(draw(index) for index in indices))
    print(tabulate(summary(rows), headers="keys", tablefmt="github"))
    for check, meaning in CHECKS.items():
        print(f"  {check}: {meaning}")
    broken = sum(not row.holds for row in rows)
    print(f"{len(rows)} scenes, {broken} break a check")
    return int(broken > 0)


if __name__ == "__main__":
    sys.exit(main())
