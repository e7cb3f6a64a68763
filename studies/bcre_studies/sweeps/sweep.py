"""A sweep from its first point to its table: estimated, measured, kept, taken up again."""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache, partial
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from bcre_studies.sweeps.points import spread
from bcre_studies.sweeps.progress import progress, span
from bcre_studies.sweeps.stream import Measure, Measured, Stream
from bcre_studies.sweeps.table import FAILURE, POINT, VERSION, Results
from bcre_studies.sweeps.workers import Workers, workers_of
from bcre_studies.system import sources
from bcre_studies.system.files import alone
from bcre_studies.system.release import release

PILOT = 8
"""Points measured to estimate the cost of all."""

PILOT_S = 30.0
"""Seconds after which a dry run makes do with fewer."""

PART_S = 1.0
PART_SHARE = 0.01
"""Finished points are written every second, later every hundredth of the time since the start:
a kill costs no more than that, and the parts stay few."""


class Cases(Protocol):
    """Cases by their numbers, each a mapping of what its row says of it."""

    def __len__(self) -> int: ...

    def __getitem__(self, number: int, /) -> Mapping[str, Any]: ...


@dataclass(frozen=True)
class Sweep:
    """What is measured, and where its rows go.

    Parameters
    ----------
    label: what progress and estimate call it.
    measure: the row of a point, a function or object that another process can import; where it has
        a method ``warm``, that compiles what the points need.
    columns: names and types of a row's values, those of points and constants included.
    about: what makes it this sweep and no other, as JSON takes it.
    module: whose sources, with all that they import, are the version of the rows.
    constants: values that every row has.
    """

    label: str
    measure: Measure
    points: Cases
    columns: Mapping[str, type]
    about: Mapping[str, Any]
    module: str
    constants: Mapping[str, Any] = field(default_factory=dict)


@dataclass
class Account:
    """What a run of a sweep came to.

    Parameters
    ----------
    measured, failed, repeated: points of this run; ``repeated`` are those of dead workers.
    found: points that were there before; ``damaged`` files were thrown away.
    tasks: chunks of points sent to workers.
    seconds: from first to last point; ``busy_s`` is what the points took, over all workers.
    """

    points: int
    workers: int = 0
    found: int = 0
    damaged: int = 0
    measured: int = 0
    failed: int = 0
    repeated: int = 0
    tasks: int = 0
    seconds: float = 0.0
    busy_s: float = 0.0

    @property
    def busy(self) -> float:
        """Part of the workers' time that went into points."""
        return self.busy_s / (self.seconds * self.workers) if self.seconds else 1.0


def run(sweep: Sweep, folder: Path, scheduler: str | None, say: Callable[[str], None]) -> Account:
    """Measure the points that ``folder`` does not have yet, and finish its table.

    Raises
    ------
    OtherSweepError
        where the folder holds another sweep, or this one of other sources; ClusterError where the
        scheduler or its workers are lost. What was measured before is kept.
    """
    about = {**sweep.about, "version": version_of(sweep.module), "points": len(sweep.points)}
    results = Results(folder, sweep.columns, about)
    with alone(folder / ".lock", f"bcre: waiting for another run that writes {folder}"):
        there = results.begin().column(POINT).to_numpy()
        account = Account(len(sweep.points), found=there.size, damaged=len(results.damaged))
        if account.found or account.damaged:
            say(f"{account.found} points are there{_of_damaged(results.damaged)}")
        todo = np.ones(len(sweep.points), dtype=bool)
        todo[there] = False
        numbers = [number for number in spread(todo.size) if todo[number]]
        if numbers:
            _measure(sweep, numbers, results, scheduler, say, account)
        results.finish()
    return account


def estimate(sweep: Sweep, scheduler: str | None) -> str:
    """What the sweep would take, in words, from a few of its points; writes nothing."""
    few = list(itertools.islice(spread(len(sweep.points)), PILOT))
    with workers_of(scheduler) as workers:
        stream, began = _stream(sweep, workers), time.monotonic()
        for _ in stream.run(_cases(sweep, few), len(few)):
            if time.monotonic() - began > PILOT_S:
                break
        return _estimated(stream, len(sweep.points), workers.count())


def version_of(module: str) -> str:
    """The release, and a digest of the sources that the module's results depend on."""
    return f"{release()}+{sources.digest(module)[:16]}"


@cache
def _version_there(module: str) -> str:
    """A worker's, which imports its modules once; to read all sources takes a tenth of a chunk."""
    return version_of(module)


@dataclass
class _Writer:
    """Gathers rows and writes them as parts."""

    sweep: Sweep
    results: Results
    account: Account
    version: str
    _rows: list[dict[str, Any]] = field(default_factory=list)
    _began: float = field(default_factory=time.monotonic)
    _written: float = field(default_factory=time.monotonic)

    def add(self, measured: Iterable[Measured]) -> None:
        for number, row, failure in measured:
            known = {POINT: number, **self.sweep.points[number], **self.sweep.constants}
            self._rows.append({**known, **row, VERSION: self.version, FAILURE: failure})
            self.account.measured += 1
            self.account.failed += bool(failure)
        now = time.monotonic()
        if now - self._written >= max(PART_S, PART_SHARE * (now - self._began)):
            self.write()

    def write(self) -> None:
        if self._rows:
            self.results.add(self._rows)
        self._rows = []
        self._written = time.monotonic()


def _measure(
    sweep: Sweep,
    numbers: Sequence[int],
    results: Results,
    scheduler: str | None,
    say: Callable[[str], None],
    account: Account,
) -> None:
    with workers_of(scheduler) as workers:
        stream = _stream(sweep, workers)
        writer = _Writer(sweep, results, account, stream.version)
        account.workers, began = workers.count(), time.monotonic()
        try:
            with progress(sweep.label, account.found, account.points) as finished:
                for stage in (numbers[:PILOT], numbers[PILOT:]):
                    for measured in stream.run(_cases(sweep, stage), len(stage)):
                        writer.add(measured)
                        finished(len(measured))
                    if account.measured < len(numbers):
                        say(_estimated(stream, len(numbers) - account.measured, account.workers))
        finally:
            writer.write()
            account.seconds = time.monotonic() - began
            account.busy_s, account.tasks = stream.seconds, stream.tasks
            account.repeated = stream.repeated


def _stream(sweep: Sweep, workers: Workers) -> Stream:
    there = partial(_version_there, sweep.module)
    return Stream(workers, sweep.measure, version_of(sweep.module), there)


def _cases(sweep: Sweep, numbers: Sequence[int]) -> Iterator[tuple[int, Any]]:
    return ((number, sweep.points[number]) for number in numbers)


def _estimated(stream: Stream, left: int, workers: int) -> str:
    whole, each = span(left * stream.case_s / workers), span(stream.case_s)
    return (
        f"{left} points: about {whole} on {workers} workers, {each} a point in {stream.cases} of "
        "them"
    )


def _of_damaged(paths: Sequence[Path]) -> str:
    names = ", ".join(path.name for path in paths)
    return f"; damaged was {names}, whose points are measured again" if paths else ""
