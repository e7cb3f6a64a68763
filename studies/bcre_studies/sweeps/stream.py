"""The cases of a sweep through its workers, in chunks, each measured whatever becomes of others.

A chunk is as long as makes its way to the worker and back a small part of the time, and no longer,
so that little is lost with a worker. Where nobody knows whether a chunk was the cause that its
worker died, it is measured again alone; one that is the cause is measured case by case.
"""

from __future__ import annotations

import itertools
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, CancelledError, Future, wait
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from bcre_studies.sweeps.workers import ClusterError, Workers
from bcre_studies.system.one_line import one_line

Row = dict[str, Any]
Measure = Callable[[Any], Row]

CHUNK_S = 0.25
"""Seconds that a chunk takes at least: 5 % is 12 ms, a task's way through Dask takes 1.4 ms."""

CHUNK_S_PER_WORKER = 0.005
"""More workers need longer chunks: a scheduler takes 0.8 ms of its own a task."""

MOST_TOGETHER = 10_000
AHEAD = 2
"""Chunks under way a worker: one that is measured and one that waits for it."""

POLL_S = 1.0

DIED = "its worker died: ended by a signal, or out of memory"


class Measured(NamedTuple):
    """A case's row, or the reason why there is none."""

    number: int
    row: Row
    failure: str


class Outcome(NamedTuple):
    """What a worker returns of a chunk: its cases, the seconds they took, its own version."""

    measured: list[Measured]
    seconds: float
    version: str


@dataclass(frozen=True)
class Chunk:
    """Cases by their numbers; ``alone`` where they are measured again with nothing beside them."""

    cases: tuple[tuple[int, Any], ...]
    alone: bool = False


@dataclass
class Stream:
    """Measures cases on workers; ``repeated`` counts those that a dead worker had under way.

    ``tasks`` counts the chunks sent out.

    Parameters
    ----------
    measure: returns the row of a case; its exceptions are the reasons of failed ones.
    version: of the sources here, which every worker's must be.
    version_of: what a worker tells its own by.
    """

    workers: Workers
    measure: Measure
    version: str
    version_of: Callable[[], str]
    cases: int = 0
    seconds: float = 0.0
    tasks: int = 0
    repeated: int = 0
    _flying: dict[Future[Outcome], Chunk] = field(default_factory=dict)
    _suspects: deque[Chunk] = field(default_factory=deque)

    @property
    def case_s(self) -> float:
        """Mean seconds of a case so far; infinite before the first."""
        return self.seconds / self.cases if self.cases else float("inf")

    def run(self, cases: Iterable[tuple[int, Any]], left: int) -> Iterator[list[Measured]]:
        """The cases as they are finished, in no order.

        Parameters
        ----------
        left: how many there are.
        """
        todo = iter(cases)
        self._launch(todo, left)
        while self._flying:
            done, _ = wait(self._flying, POLL_S, FIRST_COMPLETED)
            if not done:
                self.workers.require_alive()
            for future in done:
                measured = self._outcome(future, self._flying.pop(future))
                left -= len(measured)
                if measured:
                    yield measured
            self._launch(todo, left)

    def _launch(self, todo: Iterator[tuple[int, Any]], left: int) -> None:
        if self._suspects:
            if not self._flying:
                self._submit(self._suspects.popleft())
            return
        workers = self.workers.count()
        while len(self._flying) < AHEAD * workers:
            chunk = Chunk(tuple(itertools.islice(todo, self._together(left, workers))))
            if not chunk.cases:
                return
            self._submit(chunk)

    def _together(self, left: int, workers: int) -> int:
        """Cases of the next chunk; towards the end they are shared out evenly."""
        wanted = max(CHUNK_S, CHUNK_S_PER_WORKER * workers) / self.case_s
        return int(max(1, min(wanted, MOST_TOGETHER, left / (AHEAD * workers))))

    def _submit(self, chunk: Chunk) -> None:
        future = self.workers.submit(measure_chunk, self.measure, chunk.cases, self.version_of)
        self._flying[future] = chunk
        self.tasks += 1

    def _outcome(self, future: Future[Outcome], chunk: Chunk) -> list[Measured]:
        try:
            outcome = future.result()
        except self.workers.died:
            return self._died(chunk)
        except CancelledError:
            self.workers.require_alive()
            raise ClusterError(
                "--scheduler: work was cancelled there; run again to go on"
            ) from None
        if outcome.version != self.version:
            raise ClusterError(
                f"--scheduler: a worker runs version {outcome.version}; must be this one's, "
                f"{self.version}"
            )
        self.cases += len(chunk.cases)
        self.seconds += outcome.seconds
        return outcome.measured

    def _died(self, chunk: Chunk) -> list[Measured]:
        guilty = chunk.alone or self.workers.blames
        if guilty and len(chunk.cases) == 1:
            return [Measured(number, {}, DIED) for number, _ in chunk.cases]
        self.repeated += len(chunk.cases)
        if guilty:
            self._suspects.extend(Chunk((case,), alone=True) for case in chunk.cases)
        else:
            self._suspects.append(Chunk(chunk.cases, alone=True))
        return []


def measure_chunk(
    measure: Measure, cases: Iterable[tuple[int, Any]], version_of: Callable[[], str]
) -> Outcome:
    """What a worker does: every case in turn, a failure for those that fail."""
    version = version_of()
    _warm(measure)
    began = time.perf_counter()
    measured = [_measured(measure, number, case) for number, case in cases]
    return Outcome(measured, time.perf_counter() - began, version)


def _measured(measure: Measure, number: int, case: Any) -> Measured:
    try:
        return Measured(number, measure(case), "")
    except Exception as failure:  # whatever it is, it is the row's reason
        return Measured(number, {}, one_line(f"{type(failure).__name__}: {failure}"))


_warmed: set[type] = set()


def _warm(measure: Measure) -> None:
    """Compile outside the clock, once a process; what fails here fails again as a case."""
    warm = getattr(measure, "warm", None)
    if warm is not None and type(measure) not in _warmed:
        _warmed.add(type(measure))
        _measured(lambda _: warm() or {}, 0, None)
