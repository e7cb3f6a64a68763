"""Where results go, and how: a file is there whole or not at all."""

from __future__ import annotations

import glob
import os
import secrets
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

from filelock import FileLock, Timeout

_HERE = Path(__file__).resolve().parents[3]

ROOT = _HERE if (_HERE / "pyproject.toml").is_file() else Path.cwd()
"""The repository, or where the command was started if the package is installed without one."""

REPORTS = ROOT / "reports"
CACHE = ROOT / ".cache"


def replace_file(path: Path, write: Callable[[Path], None]) -> None:
    """Let ``write`` fill a temporary file beside ``path``, then move it there in one step.

    The content is on the disk before it bears its name, so that a power cut leaves the old file or
    the new one. What a killed writer left of the same file is removed.

    Raises
    ------
    OSError
        naming the file and the reason where it cannot be written; what was there stays.
    """
    temporary = path.with_name(f".{path.name}.{secrets.token_hex(4)}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        sweep(path.parent, glob.escape(path.name))
        with FileLock(temporary, mode=0o644):  # creates it; held for as long as its writer lives
            try:
                write(temporary)
                with temporary.open("rb+") as file:
                    os.fsync(file.fileno())
                temporary.replace(path)
            finally:
                temporary.unlink(missing_ok=True)
    except OSError as error:
        raise OSError(f"{path}: cannot be written: {error.strerror or error}") from error


def sweep(folder: Path, pattern: str) -> None:
    """Remove temporary files, of names like ``pattern``, whose writers are dead."""
    for leftover in folder.glob(f".{pattern}.*.part"):
        with suppress(OSError), FileLock(leftover, blocking=False):  # a living writer has it locked
            leftover.unlink()


@contextmanager
def alone(lock: Path, waiting: str) -> Iterator[None]:
    """Hold the file ``lock``, which stays.

    A second run waits, after saying ``waiting``, until the first has ended, however it ends.
    """
    lock.parent.mkdir(parents=True, exist_ok=True)
    held = FileLock(lock)
    try:
        held.acquire(blocking=False)
    except Timeout:
        print(waiting, file=sys.stderr, flush=True)
        held.acquire()
    try:
        yield
    finally:
        held.release()


def require_writable(key: str, folder: Path, names: Sequence[str] = ()) -> None:
    """Raise ValueError, naming ``key``, where files of these names could not be written there."""
    present = folder.absolute()
    while not present.exists():
        present = present.parent
    if not present.is_dir() or not os.access(present, os.W_OK | os.X_OK):
        raise ValueError(f"{key} = {str(folder)!r}: {present} must be a folder that can be written")
    for name in names:
        if (folder / name).is_dir():
            raise ValueError(f"{key} = {str(folder)!r}: {name} in it must not be a folder")


def replace_text(path: Path, text: str) -> None:
    """Write UTF-8 text whole or not at all."""
    replace_bytes(path, text.encode())


def replace_bytes(path: Path, content: bytes) -> None:
    """Write bytes whole or not at all."""

    def write(temporary: Path) -> None:
        temporary.write_bytes(content)

    replace_file(path, write)
