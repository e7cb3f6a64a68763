"""Machine code that is kept on disk, and not longer than the sources it was compiled from."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba

SOURCES = Path(__file__).parents[2]


def digest_of(folder: Path) -> str:
    """Of all source files in a folder and those below it."""
    digest = hashlib.sha256()
    for path in sorted(folder.rglob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()


def kept(function: Callable[..., Any], sources: str) -> Any:
    """The function compiled, free of Python's lock.

    Its machine code is kept in files named after the function, which are looked at only when its
    own source file is as it was; that those of the functions it calls are, and those of the types
    that it takes, is seen by the digest ``sources``, which is made part of its name.
    """
    function.__qualname__ = f"{function.__name__}_{sources[:16]}"
    return numba.njit(cache=True, nogil=True, error_model="numpy")(function)
