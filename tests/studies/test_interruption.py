"""Runs that are killed, disturbed or out of space: files are whole, cases kept, no worker left."""

import errno
import fcntl
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pandas as pd
import psutil
import pytest
from filelock import FileLock

from bcre_studies import cli
from bcre_studies.publishing import store
from bcre_studies.sweeps import parallel
from bcre_studies.system import files, pickles
from bcre_studies.system.files import alone, replace_bytes, replace_file, require_writable


def measure(case):
    """A case that writes down that it was measured."""
    folder, number = case
    with (folder / "measured").open("a") as told:
        told.write(f"{number}\n")
    if number == 3 and not (folder / "go on").exists():
        raise OSError("interrupted")
    return number * 0.1, {"number": number}


def measured(folder):
    return sorted(int(line) for line in (folder / "measured").read_text().split())


@pytest.fixture
def one_worker(monkeypatch):
    monkeypatch.setenv("LOKY_MAX_CPU_COUNT", "1")


# Files


def test_file_is_on_the_disk_before_it_bears_its_name(tmp_path, monkeypatch):
    path, order = tmp_path / "a.txt", []
    replace = Path.replace
    monkeypatch.setattr(os, "fsync", lambda handle: order.append(os.fstat(handle).st_size))
    monkeypatch.setattr(Path, "replace", lambda *names: order.append("named") or replace(*names))
    replace_bytes(path, b"four")
    assert order == [4, "named"]


def test_leftover_of_a_killed_writer_goes_and_that_of_a_living_one_stays(tmp_path):
    for name in (".a.1.part", ".a.2.part", ".b.1.part"):
        (tmp_path / name).write_bytes(b"half")
    with FileLock(tmp_path / ".a.2.part"):
        replace_bytes(tmp_path / "a", b"whole")
    assert {path.name for path in tmp_path.iterdir()} == {"a", ".a.2.part", ".b.1.part"}
    assert (tmp_path / ".a.2.part").read_bytes() == b"half"


def test_temporary_file_is_safe_from_another_run_while_it_is_written(tmp_path):
    def write(temporary):
        temporary.write_bytes(b"new")
        files.sweep(tmp_path, "*")
        assert temporary.read_bytes() == b"new"

    replace_file(tmp_path / "a", write)
    assert (tmp_path / "a").read_bytes() == b"new"


def test_temporary_file_that_is_swept_before_it_is_locked_is_made_again(tmp_path, monkeypatch):
    locked, flock = [], fcntl.flock

    def swept_at_first(handle, how):
        if not locked:
            (leftover,) = tmp_path.iterdir()
            leftover.unlink()
        locked.append(handle)
        return flock(handle, how)

    monkeypatch.setattr(fcntl, "flock", swept_at_first)
    replace_bytes(tmp_path / "a", b"new")
    assert (tmp_path / "a").read_bytes() == b"new"
    assert [path.name for path in tmp_path.iterdir()] == ["a"]


def test_full_disk_leaves_the_old_file_and_ends_in_one_line_with_its_name(
    tmp_path, monkeypatch, capsys
):
    path = tmp_path / "a.csv"
    replace_bytes(path, b"old")

    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Path, "write_bytes", full)
    monkeypatch.setattr(cli, "app", lambda **_: replace_bytes(path, b"new"))
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert ended.value.code == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1
    assert "a.csv: cannot be written: No space left on device" in told
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_folder_that_is_a_file_is_refused_by_its_key(tmp_path):
    (tmp_path / "reports").write_text("mine")
    with pytest.raises(ValueError, match=r"reports = .*must be a folder that can be written"):
        require_writable("reports", tmp_path / "reports")


# Finished cases


def test_finished_cases_outlive_a_failure_and_are_not_measured_again(tmp_path, one_worker):
    cases = [(tmp_path, number) for number in range(5)]
    with parallel.kept(tmp_path / "cases"):
        with pytest.raises(OSError, match="interrupted"):
            parallel.each(measure, cases, "test")
        assert measured(tmp_path) == [0, 1, 2, 3]
        (tmp_path / "go on").touch()
        results = parallel.each(measure, cases, "test")
    assert results == [measure(case) for case in cases]
    assert measured(tmp_path)[:7] == [0, 0, 1, 1, 2, 2, 3]
    assert measured(tmp_path).count(4) == 2  # once in the run, once in this test


def test_damaged_finished_case_is_measured_again(tmp_path, one_worker):
    (tmp_path / "go on").touch()
    cases = [(tmp_path, number) for number in range(3)]
    with parallel.kept(tmp_path / "cases"):
        first = parallel.each(measure, cases, "test")
        hurt = sorted((tmp_path / "cases").iterdir())[1]
        hurt.write_bytes(hurt.read_bytes()[:-1])
        assert parallel.each(measure, cases, "test") == first
    assert len(measured(tmp_path)) == 4


def test_nothing_is_kept_outside_a_study(tmp_path, one_worker):
    (tmp_path / "go on").touch()
    for _ in range(2):
        parallel.each(measure, [(tmp_path, 1)], "test")
    assert measured(tmp_path) == [1, 1]
    assert {path.name for path in tmp_path.iterdir()} == {"go on", "measured"}


@pytest.mark.parametrize("workers", ["1", "2"])
def test_results_do_not_depend_on_the_number_of_workers(monkeypatch, workers):
    monkeypatch.setenv("LOKY_MAX_CPU_COUNT", workers)
    assert parallel.each(hex, range(20), "test") == [hex(number) for number in range(20)]


def test_label_with_markup_is_text_in_the_progress_bar(capsys, one_worker):
    parallel.each(hex, range(3), "[bold]x[/bold] [/]")
    assert "[bold]x[/bold] [/]" in capsys.readouterr().err


# Two runs at once


def test_second_run_waits_for_the_first_and_says_so(tmp_path, monkeypatch):
    lock, order, held, said = tmp_path / "new/lock", [], threading.Event(), threading.Event()

    def say(text, **_):
        order.append(text)
        said.set()

    def first():
        with alone(lock, "waits"):
            held.set()
            said.wait()
            order.append("first done")

    monkeypatch.setattr(files, "print", say, raising=False)

    thread = threading.Thread(target=first)
    thread.start()
    held.wait()
    order.append("second comes")
    with alone(lock, "waits"):
        order.append("second in")
    thread.join()
    assert order == ["second comes", "waits", "first done", "second in"]


def test_lock_of_a_run_that_fails_is_free(tmp_path, capsys):
    with pytest.raises(KeyboardInterrupt), alone(tmp_path / "lock", "waits"):
        raise KeyboardInterrupt
    with alone(tmp_path / "lock", "waits"):
        pass
    assert capsys.readouterr().err == ""


# The store


def test_store_keeps_the_latest_states_of_a_study_and_forgets_the_others(tmp_path, monkeypatch):
    monkeypatch.setattr(store, "CACHE", tmp_path)
    tables = {"comparison": pd.DataFrame({"a": [1.0]})}
    names = [f"fake-{number:016x}.pickle" for number in range(6)]
    for age, name in enumerate(reversed(names)):
        pickles.dump(tmp_path / name, tables)
        os.utime(tmp_path / name, (1e9 - age, 1e9 - age))
    pickles.dump(tmp_path / f"fake_too-{0:016x}.pickle", tables)
    pickles.dump(tmp_path / f"fake-{7:016x}" / "case.pickle", 1)
    (tmp_path / "fake.lock").touch()
    (tmp_path / f".fake-{8:016x}.pickle.x.part").touch()
    assert store._load(tmp_path / names[0]) is not None  # of use now, though the oldest
    store._forget_old("fake")
    kept = {path.name for path in tmp_path.iterdir()}
    assert kept == {names[0], names[5], names[4], f"fake_too-{0:016x}.pickle", "fake.lock"}


# Signals

SLEEPERS = """
import os, signal, sys, time
from pathlib import Path
from bcre_studies.sweeps import parallel
from bcre_studies import cli

def sleep(case):
    Path(f"started-{os.getpid()}").touch()
    time.sleep(600)

# A shell that starts a command in the background has it ignore SIGINT, and children inherit that.
signal.signal(signal.SIGINT, signal.default_int_handler)
cli.app = lambda **_: parallel.each(sleep, range(4), "sleepers")
cli.main()
"""


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_no_worker_outlives_its_run_even_if_the_run_alone_is_killed(tmp_path, sent):
    environment = os.environ | {"LOKY_MAX_CPU_COUNT": "2"}
    run = subprocess.Popen(
        [sys.executable, "-c", SLEEPERS],
        cwd=tmp_path,
        env=environment,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    while not (started := list(tmp_path.glob("started-*"))) and run.poll() is None:
        time.sleep(0.05)
    run.send_signal(sent)
    code = run.wait()
    workers = [int(path.name.partition("-")[2]) for path in started]
    assert workers
    assert run.pid not in workers or os.cpu_count() == 1
    until = time.monotonic() + PATIENCE
    while any(map(is_alive, workers)) and time.monotonic() < until:
        time.sleep(0.1)
    assert not any(map(is_alive, workers))
    told = run.communicate()[1]
    if sent != signal.SIGKILL:
        assert code == 130
        assert "bcre: interrupted; every file written before is whole" in told
        assert "Traceback" not in told


PATIENCE = 300.0
"""Seconds that workers may take to end: as long as the busiest machine needs, and no test fails."""


def is_alive(pid):
    try:
        return psutil.Process(pid).status() != psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return False
