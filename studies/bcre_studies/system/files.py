"""Where results go, and how: a file is there whole or not at all."""

from __future__ import annotations

import fcntl
import glob
import os
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

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
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        sweep(path.parent, glob.escape(path.name))
        with _temporary(path) as (handle, temporary):
            write(temporary)
            temporary.chmod(0o644)
            os.fsync(handle)
            temporary.replace(path)
    except OSError as error:
        raise OSError(f"{path}: cannot be written: {error.strerror or error}") from error


@contextmanager
def _temporary(path: Path) -> Iterator[tuple[int, Path]]:
    """An open file beside ``path``, locked for as long as its writer lives, and its name."""
    while True:
        handle, name = tempfile.mkstemp(".part", f".{path.name}.", path.parent)
        fcntl.flock(handle, fcntl.LOCK_EX)
        if os.fstat(handle).st_nlink:
            break
        os.close(handle)  # swept away by another run before it was locked
    try:
        yield handle, Path(name)
    finally:
        Path(name).unlink(missing_ok=True)
        os.close(handle)


def sweep(folder: Path, pattern: str) -> None:
    """Remove temporary files, of names like ``pattern``, whose writers are dead.

    A living writer holds the lock of its file; that of a dead one is free.
    """
    for leftover in folder.glob(f".{pattern}.*.part"):
        with suppress(OSError), leftover.open("rb") as file:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            leftover.unlink()


@contextmanager
def workshop(folder: Path, waiting: str) -> Iterator[None]:
    """Hold ``folder`` alone, and remove it at the end.

    A second run waits, after saying ``waiting``, until the first has ended, however it ends.
    After an exception or a kill what is in the folder stays, for the next run to take over.
    """
    handle = _lock(folder, waiting)
    try:
        yield
        shutil.rmtree(folder, ignore_errors=True)
    finally:
        with suppress(OSError):
            folder.rmdir()  # where nothing was finished
        os.close(handle)


def _lock(folder: Path, waiting: str) -> int:
    while True:
        folder.mkdir(parents=True, exist_ok=True)
        with suppress(FileNotFoundError):  # its last holder was done and removed it
            handle = os.open(folder, os.O_RDONLY)
            try:
                _lock_patiently(handle, waiting)
                if os.path.samestat(folder.stat(), os.fstat(handle)):
                    return handle
            except BaseException:
                os.close(handle)
                raise
            os.close(handle)


def _lock_patiently(handle: int, waiting: str) -> None:
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        print(waiting, file=sys.stderr, flush=True)
        fcntl.flock(handle, fcntl.LOCK_EX)


def remove_abandoned(folder: Path) -> None:
    """Remove a folder of :func:`workshop` that nobody holds."""
    handle = os.open(folder, os.O_RDONLY)
    with suppress(BlockingIOError):
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        shutil.rmtree(folder, ignore_errors=True)
    os.close(handle)


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
