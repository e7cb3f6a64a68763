"""Where results go, and how: a file is there whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

_HERE = Path(__file__).resolve().parents[3]

ROOT = _HERE if (_HERE / "pyproject.toml").is_file() else Path.cwd()
"""The repository, or where the command was started if the package is installed without one."""

REPORTS = ROOT / "reports"
CACHE = ROOT / ".cache"


def replace_file(path: Path, write: Callable[[Path], None]) -> None:
    """Let ``write`` fill a temporary file beside ``path``, then move it there in one step."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    os.close(handle)
    temporary = Path(name)
    try:
        write(temporary)
        temporary.chmod(0o644)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def require_writable(folder: Path, names: Sequence[str]) -> None:
    """Raise ValueError where files of these names could not be written into the folder."""
    present = folder.absolute()
    while not present.exists():
        present = present.parent
    if not present.is_dir() or not os.access(present, os.W_OK):
        raise ValueError(f"--out = {str(folder)!r}: {present} must be a folder that can be written")
    for name in names:
        if (folder / name).is_dir():
            raise ValueError(f"--out = {str(folder)!r}: {name} in it must not be a folder")


def replace_text(path: Path, text: str) -> None:
    """Write UTF-8 text whole or not at all."""
    replace_file(path, lambda temporary: _write(temporary, text.encode()))


def replace_bytes(path: Path, content: bytes) -> None:
    """Write bytes whole or not at all."""
    replace_file(path, lambda temporary: _write(temporary, content))


def _write(path: Path, content: bytes) -> None:
    path.write_bytes(content)
