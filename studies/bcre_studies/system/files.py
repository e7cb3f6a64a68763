"""Where results go, and how: a file is there whole or not at all."""

from __future__ import annotations

import errno
import glob
import os
import secrets
import shutil
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from filelock import FileLock, Timeout

_HERE = Path(__file__).resolve().parents[3]

ROOT = _HERE if (_HERE / "pyproject.toml").is_file() else Path.cwd()
"""The repository, or where the command was started if the package is installed without one."""

REPORTS = ROOT / "reports"
CACHE = ROOT / ".cache"


LOCKLESS = {errno.ENOSYS, errno.ENOTSUP, errno.EOPNOTSUPP, errno.ENOLCK, errno.EINVAL}
"""What a file system without locks answers when it is asked for one."""


def replace_file(path: Path, write: Callable[[Path], None]) -> None:
    """Let ``write`` fill a temporary file beside ``path``, then move it there in one step.

    The content is on the disk before it bears its name, so that a power cut leaves the old file or
    the new one. What a killed writer left of the same file is removed. A link is written through. A
    file that is there keeps its permissions, a new one has those of the umask.

    Raises
    ------
    OSError
        naming the file and the reason where it cannot be written; what was there stays.
    """
    try:
        target = path.resolve()
        target.parent.mkdir(parents=True, exist_ok=True)
        sweep(target.parent, glob.escape(target.name))
        temporary = target.with_name(f".{target.name}.{secrets.token_hex(4)}.part")
        with locked(temporary):  # creates it; held for as long as its writer lives
            try:
                write(temporary)
                with temporary.open("rb+") as file:
                    os.fsync(file.fileno())
                if target.exists():
                    shutil.copymode(target, temporary)
                temporary.replace(target)
            finally:
                temporary.unlink(missing_ok=True)
    except (OSError, RuntimeError) as error:  # the latter for links that go round in a circle
        reason = getattr(error, "strerror", None) or error
        raise OSError(f"{path}: cannot be written: {reason}") from error


def sweep(folder: Path, pattern: str) -> None:
    """Remove temporary files, of names like ``pattern``, whose writers are dead.

    Where the file system has no locks nobody knows who is dead, so that they stay.
    """
    for leftover in folder.glob(f".{pattern}.*.part"):
        # A living writer has it locked.
        with suppress(OSError), locked(leftover, blocking=False) as held:
            if held:
                leftover.unlink()


@contextmanager
def locked(path: Path, blocking: bool = True) -> Iterator[bool]:
    """Hold the file ``path``, which is made if need be; do without where no file can be locked.

    Yields whether it is held.

    Raises
    ------
    filelock.Timeout
        where another holds it and ``blocking`` is false.
    """
    lock = FileLock(path, fallback_to_soft=False)
    try:
        lock.acquire(blocking=blocking)
    except OSError as error:
        if error.errno not in LOCKLESS:
            raise
        yield False
        return
    try:
        yield True
    finally:
        lock.release()


@contextmanager
def alone(lock: Path, waiting: str) -> Iterator[None]:
    """Hold the file ``lock``, which stays.

    A second run waits, after saying ``waiting``, until the first has ended, however it ends.
    """
    lock.parent.mkdir(parents=True, exist_ok=True)
    with ExitStack() as held:
        try:
            held.enter_context(locked(lock, blocking=False))
        except Timeout:
            print(waiting, file=sys.stderr, flush=True)
            held.enter_context(locked(lock))
        yield


def can_be_written(folder: Path) -> bool:
    """Whether files could be written there."""
    try:
        require_writable("", folder)
    except ValueError:
        return False
    return True


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
