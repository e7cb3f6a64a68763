"""Machine code on disk, under a key of the sources of this package.

Numba's key holds the values that a function closes over, but not the files of the functions that it
calls. A compiled function that calls others closes over :data:`SOURCES`, and so is compiled anew
after any change here.

Whatever is wrong with the files or their folder costs a compilation and nothing else.
"""

from __future__ import annotations

import hashlib
import logging
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
from numba.core.caching import FunctionCache

_log = logging.getLogger(__name__)


def digest(folder: Path) -> str:
    """SHA-256, in hexadecimal, of the Python files in a folder and in those below it."""
    total = hashlib.sha256()
    for path in sorted(folder.rglob("*.py")):
        total.update(path.read_bytes())
    return total.hexdigest()


SOURCES = digest(Path(__file__).parent)


def kept(**options: Any) -> Callable[[Callable[..., Any]], Any]:
    """A decorator that compiles a function and keeps its machine code on disk.

    ``options`` are those of ``numba.njit``. Where no folder can be written to, machine code is kept
    in memory only.
    """

    def compiled(function: Callable[..., Any]) -> Any:
        dispatcher = numba.njit(error_model="numpy", **options)(function)
        try:
            Path("~").expanduser()  # without a home numba would make a folder of that name
            dispatcher._cache = _Cache(function)
        except (OSError, RuntimeError) as error:
            _log.warning("compiled code is not kept on disk: %s", error)
        return dispatcher

    return compiled


class _Cache(FunctionCache):  # type: ignore[misc]
    """Numba's, without its exceptions."""

    def load_overload(self, signature: Any, target: Any) -> Any:
        try:
            return super().load_overload(signature, target)
        except Exception as error:
            _log.warning("compiled code could not be read and is made anew: %s", error)
            return None

    def save_overload(self, signature: Any, data: Any) -> None:
        try:
            self._save_or_begin_anew(signature, data)
        except Exception as error:
            _log.warning("compiled code is not kept on disk: %s", error)

    def _save_or_begin_anew(self, signature: Any, data: Any) -> None:
        try:
            super().save_overload(signature, data)
        except OSError:
            raise
        except Exception:  # the index of what is kept cannot be read
            self.flush()
            super().save_overload(signature, data)
