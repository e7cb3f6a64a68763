"""How far a sweep has come and what time is left, where somebody can see it."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

EVERY_S = 60.0
"""Seconds between two lines where standard error is a file, as a batch system has it."""


@contextmanager
def progress(label: str, done: int, total: int) -> Iterator[Callable[[int], None]]:
    """A function to be told of each number of points that is finished.

    On a terminal it moves a bar, elsewhere it prints a line from time to time.

    Parameters
    ----------
    done: points that were finished before.
    """
    if not sys.stderr.isatty():
        yield _Lines(label, done, total)
        return
    from rich.console import Console
    from rich.markup import escape
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TimeRemainingColumn

    columns = ("{task.description}", BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(escape(label), completed=done, total=total)
        yield lambda count: bar.advance(task, count)


class _Lines:
    def __init__(self, label: str, done: int, total: int) -> None:
        self._label, self._before, self._done, self._total = label, done, done, total
        self._began = self._last = time.monotonic()

    def __call__(self, count: int) -> None:
        self._done += count
        now = time.monotonic()
        if now - self._last >= EVERY_S:
            self._last = now
            rate = (self._done - self._before) / (now - self._began)
            left = span((self._total - self._done) / rate)
            print(
                f"{self._label}: {self._done} of {self._total} points, {left} left",
                file=sys.stderr,
                flush=True,
            )


def span(seconds: float) -> str:
    """A time as a person says it: 12 s, 3.5 min, 20 h."""
    for unit, length, most in (("s", 1.0, 120.0), ("min", 60.0, 7200.0), ("h", 3600.0, 172800.0)):
        if seconds < most:
            return f"{seconds / length:.3g} {unit}"
    return f"{seconds / 86400:.3g} days"
