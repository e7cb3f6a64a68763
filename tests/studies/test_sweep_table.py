"""A sweep's rows on disk: whole or noticed, each point once, taken up again where it was."""

import json

import pandas as pd
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from bcre_studies.sweeps import sweep as engine
from bcre_studies.sweeps.stream import measure_chunk
from bcre_studies.sweeps.sweep import Sweep, run
from bcre_studies.sweeps.table import ABOUT, PARTS, TABLE, OtherSweepError, Results, read

COLUMNS = {"a": float, "square": float}


def squared(case):
    if case["a"] == 5.0:
        raise ValueError("five")
    return {"square": case["a"] ** 2}


POINTS = [{"a": float(number)} for number in range(30)]
ALL = Sweep("test", squared, POINTS, COLUMNS, {"spec": 1}, "bcre_studies.sweeps.points")


class Here:
    """Workers that are this process, stopped after the ``last`` case."""

    died = ()

    def __init__(self, last=None):
        self._last, self.measured = last, []

    def count(self):
        return 1

    def submit(self, function, measure, cases, version_of):
        from concurrent.futures import Future

        assert function is measure_chunk
        if self._last is not None and len(self.measured) >= self._last:
            raise KeyboardInterrupt
        self.measured += [number for number, _ in cases]
        future = Future()
        future.set_result(function(measure, cases, version_of))
        return future

    def require_alive(self):
        pass


@pytest.fixture
def on(monkeypatch):
    """Run the sweep in a folder on these workers."""
    from contextlib import contextmanager

    def start(folder, workers, sweep=ALL):
        @contextmanager
        def given_ones(_):
            yield workers

        monkeypatch.setattr(engine, "workers_of", given_ones)
        return run(sweep, folder, None, lambda _: None)

    return start


def test_a_table_has_one_row_a_point_with_its_version_and_its_reason(tmp_path, on):
    account = on(tmp_path, Here())
    table = read(tmp_path)
    assert list(table["point"]) == list(range(30))
    assert list(table.columns) == ["point", "a", "square", "version", "failure"]
    assert (table["version"] == engine.version_of(ALL.module)).all()
    assert table["failure"][5] == "ValueError: five"
    assert pd.isna(table["square"][5])
    others = table[table["failure"] == ""]
    assert list(others["square"]) == [number**2 for number in range(30) if number != 5]
    assert (account.measured, account.failed, account.found) == (30, 1, 0)
    assert not list((tmp_path / PARTS).iterdir())


def test_a_stopped_sweep_goes_on_where_it_was_and_writes_the_same_bytes(tmp_path, on):
    stopped = Here(last=12)
    with pytest.raises(KeyboardInterrupt):
        on(tmp_path / "a", stopped)
    there, again = set(read(tmp_path / "a")["point"]), Here()
    account = on(tmp_path / "a", again)
    assert account.found == len(there) >= 8
    assert set(again.measured) == set(range(30)) - there
    on(tmp_path / "b", Here())
    assert (tmp_path / "a" / TABLE).read_bytes() == (tmp_path / "b" / TABLE).read_bytes()


def test_a_finished_sweep_measures_nothing(tmp_path, on):
    on(tmp_path, Here())
    idle = Here()
    assert on(tmp_path, idle).found == 30
    assert idle.measured == []


def test_half_a_part_is_noticed_and_its_points_are_measured_again(tmp_path, on):
    with pytest.raises(KeyboardInterrupt):
        on(tmp_path, Here(last=12))
    (part,) = (tmp_path / PARTS).iterdir()
    part.write_bytes(part.read_bytes()[: part.stat().st_size // 2])
    with pytest.raises(ValueError, match="damaged or half-written"):
        read(tmp_path)
    account = on(tmp_path, Here())
    assert (account.found, account.damaged, account.measured) == (0, 1, 30)
    assert len(read(tmp_path)) == 30


def test_an_unfinished_temporary_file_is_no_part(tmp_path, on):
    on(tmp_path, Here())
    (tmp_path / PARTS / ".x.parquet.0123.part").write_bytes(b"PAR1 half")
    assert on(tmp_path, Here()).damaged == 0
    assert not list((tmp_path / PARTS).iterdir())


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=40)
@given(st.floats(0, 1, exclude_max=True), st.integers(1, 255))
def test_a_changed_byte_is_noticed_or_changes_nothing(tmp_path, place, change):
    results = Results(tmp_path, COLUMNS, {"spec": 1})
    results.begin()
    results.add({"point": i, "a": 0.5 * i, "square": 0.25 * i * i, "failure": ""} for i in range(9))
    whole = results.finish()
    path = tmp_path / TABLE
    content = bytearray(path.read_bytes())
    content[int(place * len(content))] ^= change
    path.write_bytes(content)
    results = Results(tmp_path, COLUMNS, {"spec": 1})
    rows = results.begin()
    assert rows.equals(whole) if not results.damaged else rows.num_rows == 0


def test_a_point_that_was_written_twice_counts_once(tmp_path, on):
    on(tmp_path, Here())
    results = Results(tmp_path, COLUMNS, json.loads((tmp_path / ABOUT).read_text()))
    results.add([{"point": 3, "a": 3.0, "square": -1.0, "failure": ""}])
    assert read(tmp_path)["square"][3] == 9.0
    on(tmp_path, Here())
    assert read(tmp_path)["square"][3] == 9.0


def test_a_folder_with_another_sweep_is_refused_and_keeps_it(tmp_path, on):
    on(tmp_path, Here())
    before = (tmp_path / TABLE).read_bytes()
    other = Sweep("test", squared, POINTS, COLUMNS, {"spec": 2}, ALL.module)
    with pytest.raises(OtherSweepError, match=r"holds another sweep \(spec differs\)"):
        on(tmp_path, Here(), other)
    assert (tmp_path / TABLE).read_bytes() == before


def test_points_of_other_sources_are_not_mixed_with_these(tmp_path, on, monkeypatch):
    with pytest.raises(KeyboardInterrupt):
        on(tmp_path, Here(last=12))
    monkeypatch.setattr(engine.sources, "digest", lambda _: "0" * 64)
    with pytest.raises(OtherSweepError, match="version differs"):
        on(tmp_path, Here())
