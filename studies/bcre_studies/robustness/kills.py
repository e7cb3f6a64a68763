"""Runs that are killed, in a copy of the project, and what is left of them.

A run is ``bcre study NAME...``, started in a folder of its own that has a copy of the packages, so
that the project's own reports and store are never touched.
"""

from __future__ import annotations

import os
import random
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import bcre_ca
import bcre_pde
import bcre_studies
from bcre_studies.system import pickles

QUICK = ("one_variable", "printed_rule")
"""Studies of a few seconds, with some cases each."""

SIGNALS = (signal.SIGKILL, signal.SIGINT, signal.SIGTERM)

GRACE = 15.0
"""Seconds within which the workers of a run must be gone after it; they look twice a second, but
one that is just being started has to import the libraries first."""

# A shell that starts a command in the background has it ignore SIGINT, and children inherit that.
_COMMAND = (
    "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
    "from bcre_studies.cli import main; sys.argv[0] = 'bcre'; main()"
)

Contents = dict[str, bytes]


@dataclass(frozen=True)
class Copy:
    """A copy of the project in ``folder``, whose runs write there."""

    folder: Path

    @classmethod
    def make(cls, folder: Path) -> Copy:
        for package in (bcre_ca, bcre_pde, bcre_studies):
            source = Path(str(package.__file__)).parent
            shutil.copytree(source, folder / "packages" / source.name)
        return cls(folder)

    def start(self, names: tuple[str, ...], workers: int = 2) -> subprocess.Popen[str]:
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
            text=True,
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
        """Temporary files below ``reports/`` and in the store."""
        folders = (self.folder / "reports", self.folder / ".cache")
        return sum(1 for folder in folders for _ in folder.rglob(".*.part"))

    def intermediates(self) -> dict[Path, int]:
        """Finished cases and tables in the store, with the times at which they were written."""
        return {
            path: path.stat().st_mtime_ns for path in (self.folder / ".cache").rglob("*.pickle")
        }

    def forget(self, old: Contents) -> None:
        """An empty store, and other reports of an earlier time."""
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
    """Start a run, kill it after so many seconds, and look; None where it has ended before.

    Parameters
    ----------
    whole_group: kill its workers as well, as a terminal does, or the run alone.
    good: the contents before and after a run; every report must be one of the two.
    """
    before, finished = copy.reports(), copy.intermediates()
    process = copy.start(names)
    try:
        process.wait(after)
    except subprocess.TimeoutExpired:
        (os.killpg if whole_group else os.kill)(process.pid, sent)
        process.wait()
    else:
        return None
    alive = _alive_after(process.pid, GRACE)
    now, still = copy.reports(), copy.intermediates()
    return Aftermath(
        half=sum(content not in {old.get(name) for old in good} for name, content in now.items()),
        lost=len(before.keys() - now.keys()),
        leftovers=copy.leftovers(),
        workers_alive=alive,
        damaged=sum(not _is_whole(path) for path in still),
        redone=sum(still.get(path, told) != told for path, told in _cases(finished).items()),
    )


def _cases(intermediates: dict[Path, int]) -> dict[Path, int]:
    """The finished cases alone: a table's time is when it was last of use."""
    return {path: told for path, told in intermediates.items() if path.parent.name != ".cache"}


def _is_whole(path: Path) -> bool:
    try:
        pickles.load(path)
    except LookupError:
        return False
    return True


def _alive_after(group: int, seconds: float) -> int:
    """Processes of a group that are still there after so many seconds at most."""
    until = time.monotonic() + seconds
    while (alive := _alive(group)) and time.monotonic() < until:
        time.sleep(0.1)
    return alive


def _alive(group: int) -> int:
    proc = Path("/proc")
    if not proc.is_dir():
        try:
            os.killpg(group, 0)
        except OSError:
            return 0
        return 1
    count = 0
    for stat in proc.glob("[0-9]*/stat"):
        try:
            state, _, of = stat.read_text().rpartition(")")[2].split()[:3]
        except OSError:
            continue  # gone meanwhile
        count += int(of) == group and state != "Z"
    return count


@dataclass(frozen=True)
class Series:
    """Kills in turn, and whether all is as if there had been none at the end."""

    rows: list[tuple[signal.Signals, bool, Aftermath]]
    equal: bool
    leftovers: int


def kill_in_turn(copy: Copy, names: tuple[str, ...], kills: int, seed: int) -> Series:
    """Kill so many runs, at random times between start and end, then let one end.

    The copy must have been run before: a run that has to compile does not show how long one takes.
    A killed run is followed by the next as it left things; one that has come to its end is
    followed by one with an empty store and other, older reports.
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
