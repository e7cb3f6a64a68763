"""Machine code that is kept on disk, and not longer than the sources it was compiled from."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba


def kept(function: Callable[..., Any], sources: str) -> Any:
    """The function compiled, free of Python's lock.

    Its machine code is kept in files named after the function, which are looked at only when its
    own source file is as it was; that those of the functions it calls are, and those of the types
    that it takes, is seen by the digest ``sources``, which is made part of its name.
    """
    function.__qualname__ = f"{function.__name__}_{sources[:16]}"
    return numba.njit(cache=True, nogil=True, error_model="numpy")(function)
