"""Runs that are killed, in a copy of the project, and what is left of them.

A run is ``bcre study NAME...`` in a folder that holds a copy of the packages, so that the project's
own reports and store are never touched.
"""

from __future__ import annotations

import os
import random
import shutil
import signal
import subprocess
import sys
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import psutil

import bcre_ca
import bcre_pde
import bcre_studies
from bcre_studies.system import pickles

SIGNALS = (signal.SIGKILL, signal.SIGINT, signal.SIGTERM)

GRACE = 300.0
"""Seconds within which a killed run's workers must be gone. They look twice a second, but one that
is just being started has to import the libraries first, on a busy machine for minutes."""

# A shell that starts a command in the background has it ignore SIGINT, and children inherit that.
_COMMAND = (
    "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
    "from bcre_studies.cli import main; sys.argv[0] = 'bcre'; main()"
)

Contents = dict[str, bytes]


@dataclass(frozen=True)
class Copy:
    """A copy of the project in ``folder``, whose runs write there; it has the study ``quick``."""

    folder: Path

    @classmethod
    def make(cls, folder: Path) -> Copy:
        for package in (bcre_ca, bcre_pde, bcre_studies):
            source = Path(str(package.__file__)).parent
            shutil.copytree(source, folder / "packages" / source.name)
        studies = folder / "packages" / "bcre_studies"
        shutil.copy(Path(__file__).with_name("quick.py"), studies / "validation")
        with (studies / "catalog.py").open("a") as catalog:
            catalog.write('\nSTUDIES["quick"] = Entry("validation.quick", "Short cases")\n')
        return cls(folder)

    def start(self, names: tuple[str, ...], workers: int = 2) -> subprocess.Popen[bytes]:
        """``bcre study NAME...`` in a process group of its own."""
        environment = os.environ | {
            "PYTHONPATH": str(self.folder / "packages"),
            "LOKY_MAX_CPU_COUNT": str(workers),
        }
        return subprocess.Popen(
            [sys.executable, "-c", _COMMAND, "study", *names],
            cwd=self.folder,
            env=environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )

    def run(self, names: tuple[str, ...], workers: int = 2) -> int:
        """The exit code of a run that nothing disturbs."""
        return self.start(names, workers).wait()

    def reports(self) -> Contents:
        """Every file below ``reports/`` but the temporary ones."""
        folder = self.folder / "reports"
        paths = (path for path in folder.rglob("*") if path.is_file() and path.suffix != ".part")
        return {str(path.relative_to(folder)): path.read_bytes() for path in paths}

    def leftovers(self) -> int:
        """The number of temporary files below ``reports/`` and in the store."""
        folders = (self.folder / "reports", self.folder / ".cache")
        return sum(1 for folder in folders for _ in folder.rglob(".*.part"))

    def stored(self, pattern: str) -> dict[Path, int]:
        """The files in the store that match, with the times at which they were written."""
        return {path: path.stat().st_mtime_ns for path in (self.folder / ".cache").glob(pattern)}

    def forget(self, old: Contents) -> None:
        """Empty the store, and put these reports of an earlier time in the place of the present."""
        shutil.rmtree(self.folder / ".cache", ignore_errors=True)
        shutil.rmtree(self.folder / "reports", ignore_errors=True)
        for name, content in old.items():
            path = self.folder / "reports" / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)


@dataclass(frozen=True)
class Aftermath:
    """What a killed run left: counts of files and processes."""

    half: int
    lost: int
    leftovers: int
    workers_alive: int
    damaged: int
    redone: int


def kill_once(
    copy: Copy,
    names: tuple[str, ...],
    sent: signal.Signals,
    whole_group: bool,
    after: float,
    good: tuple[Contents, Contents],
) -> Aftermath | None:
    """Start a run, kill it after so many seconds, and look; None where it ended before.

    Parameters
    ----------
    whole_group: kill its workers as well, as a terminal does, or the run alone.
    good: the contents before and after a run; every report must be one of the two.
    """
    before, finished = copy.reports(), copy.stored("*/*.pickle")
    process = copy.start(names)
    try:
        process.wait(after)
    except subprocess.TimeoutExpired:
        (os.killpg if whole_group else os.kill)(process.pid, sent)
        process.wait()
    else:
        return None
    alive = _alive_after(process.pid, GRACE)
    now, cases = copy.reports(), copy.stored("*/*.pickle")
    return Aftermath(
        half=sum(content not in {old.get(name) for old in good} for name, content in now.items()),
        lost=len(before.keys() - now.keys()),
        leftovers=copy.leftovers(),
        workers_alive=alive,
        damaged=sum(not _is_whole(path) for path in copy.stored("**/*.pickle")),
        redone=sum(cases.get(path, written) != written for path, written in finished.items()),
    )


def _is_whole(path: Path) -> bool:
    try:
        pickles.load(path)
    except LookupError:
        return False
    return True


def _alive_after(group: int, seconds: float) -> int:
    """The number of processes of a group that are still there after so many seconds at most."""
    until = time.monotonic() + seconds
    while (alive := _alive(group)) and time.monotonic() < until:
        time.sleep(0.1)
    return alive


def _alive(group: int) -> int:
    count = 0
    for process in psutil.process_iter():
        with suppress(ProcessLookupError, psutil.NoSuchProcess):  # gone meanwhile
            in_group = os.getpgid(process.pid) == group
            count += in_group and process.status() != psutil.STATUS_ZOMBIE
    return count


@dataclass(frozen=True)
class Series:
    """Kills in turn, and whether all is as if there had been none at the end."""

    rows: list[tuple[signal.Signals, bool, Aftermath]]
    equal: bool
    leftovers: int


def kill_in_turn(copy: Copy, names: tuple[str, ...], kills: int, seed: int) -> Series:
    """Kill so many runs, at random times between start and end, then let one end.

    The copy must have been run before, so that nothing is left to compile. The next run starts from
    what a killed one left. After a run that came to its end the store is emptied and older reports
    are put in place.
    """
    chance = random.Random(seed)
    copy.forget({})
    began = time.monotonic()
    copy.run(names)
    span = time.monotonic() - began
    new = copy.reports()
    old = {name: b"older\n" + content for name, content in new.items()}
    copy.forget(old)
    rows: list[tuple[signal.Signals, bool, Aftermath]] = []
    while len(rows) < kills:
        sent, whole_group = SIGNALS[len(rows) % len(SIGNALS)], len(rows) % 2 == 1
        after = chance.uniform(0.05, 1) * span
        found = kill_once(copy, names, sent, whole_group, after, (old, new))
        if found is None:
            span *= 0.9  # what earlier ones had finished makes it end sooner
            copy.forget(old)
        else:
            rows.append((sent, whole_group, found))
    code = copy.run(names)
    return Series(rows, code == 0 and copy.reports() == new, copy.leftovers())


def two_at_once(copy: Copy, names: tuple[str, ...]) -> bool:
    """Whether two runs at once both end well and write what the one before them wrote."""
    expected = copy.reports()
    copy.forget({})
    codes = [run.wait() for run in [copy.start(names), copy.start(names)]]
    return codes == [0, 0] and copy.reports() == expected and copy.leftovers() == 0
