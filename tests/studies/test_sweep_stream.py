"""Cases through workers that fail and die: each ends in one row, whatever becomes of others."""

from concurrent.futures import CancelledError, Future
from concurrent.futures.process import BrokenProcessPool

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bcre_studies.sweeps import stream
from bcre_studies.sweeps.stream import DIED, Stream
from bcre_studies.sweeps.workers import ClusterError


class Here:
    """Workers that are this process; those that meet a deadly case die, with all beside them.

    Parameters
    ----------
    deadly: cases that kill their worker each time; once: those that do so the first time only.
    """

    died = (BrokenProcessPool,)
    blames = False

    def __init__(self, count=2, deadly=(), once=()):
        self._count, self._deadly, self._once = count, set(deadly), set(once)
        self._flying = []
        self.chunks = []

    def count(self):
        return self._count

    def submit(self, function, measure, cases, version_of):
        future = Future()
        self._flying.append((future, function, measure, cases, version_of))
        if len(self._flying) >= stream.AHEAD * self._count:
            self._work()
        return future

    def require_alive(self):
        self._work()

    def _work(self):
        """All chunks at hand; the first death takes the others' workers with it."""
        flying, self._flying = self._flying, []
        dead = sum(self._kills(case) for *_, cases, _ in flying for _, case in cases) > 0
        for future, function, measure, cases, version_of in flying:
            if dead:
                future.set_exception(BrokenProcessPool("killed"))
            else:
                self.chunks.append(len(cases))
                future.set_result(function(measure, cases, version_of))

    def _kills(self, case):
        if case in self._once:
            self._once.remove(case)
            return True
        return case in self._deadly


def squared(case):
    if case % 7 == 3:
        raise ValueError(f"{case} cannot be\nsquared")
    return {"square": case * case}


def version():
    return "1"


@pytest.fixture(autouse=True)
def short_polls(monkeypatch):
    monkeypatch.setattr(stream, "POLL_S", 0.0)


def measured(workers, cases):
    run = Stream(workers, squared, "1", version)
    found = [case for some in run.run(enumerate(cases), len(cases)) for case in some]
    return run, {case.number: case for case in found}, len(found)


@given(
    st.integers(0, 60),
    st.sets(st.integers(0, 59), max_size=4),
    st.sets(st.integers(0, 59), max_size=4),
    st.integers(1, 5),
)
def test_every_case_ends_in_one_row_whoever_dies(count, deadly, once, workers):
    here = Here(workers, deadly, once)
    _, rows, found = measured(here, range(count))
    assert found == len(rows) == count
    for number in range(count):
        if number in deadly:
            assert rows[number].failure == DIED
        elif number % 7 == 3:
            assert rows[number].failure == f"ValueError: {number} cannot be squared"
        else:
            assert rows[number] == (number, {"square": number**2}, "")


def test_a_dead_worker_costs_what_was_under_way_once_more_and_no_more():
    run, rows, _ = measured(Here(2, once={20}), range(40))
    assert not [row for row in rows.values() if row.failure == DIED]
    assert 1 <= run.repeated <= stream.AHEAD * 2 * max(run.workers.chunks)


def test_chunks_grow_until_the_way_to_the_worker_is_a_small_part_of_them(monkeypatch):
    clock = iter(range(10**6))
    monkeypatch.setattr(stream.time, "perf_counter", lambda: next(clock) * 0.01)
    here = Here(1)
    measured(here, [1] * 2000)
    assert here.chunks[:2] == [1, 1]
    assert max(here.chunks) >= stream.CHUNK_S / 0.01 / 2


def test_the_last_cases_are_shared_out_among_the_workers():
    here = Here(4)
    measured(here, [1] * 1000)
    assert max(here.chunks) <= 1000 / (stream.AHEAD * 4)


def test_workers_with_other_sources_are_refused():
    run = Stream(Here(), squared, "2", version)
    with pytest.raises(ClusterError, match="a worker runs version 1; must be this one's, 2"):
        list(run.run(enumerate(range(3)), 3))


def test_cancelled_work_ends_the_sweep_instead_of_losing_its_cases():
    class Cancelling(Here):
        def submit(self, *_):
            future = Future()
            future.set_exception(CancelledError())
            return future

    with pytest.raises(ClusterError, match="work was cancelled there; run again to go on"):
        list(Stream(Cancelling(), squared, "1", version).run(enumerate(range(3)), 3))
