"""Compiled functions whose machine code is kept on disk while the sources stay as they are.

Each specialisation, a function for one choice of argument types, has a file of its own, named by a
digest of all sources of this package. Processes that need the same one at the same time wait for
the first of them to compile it. Numba's own files are looked up by the source file of the one
function alone, and two processes that write them together can mix up their specialisations.

Whatever is wrong with the files costs a compilation and nothing else.
"""

from __future__ import annotations

import contextlib
import hashlib
import logging
import os
import pickle
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numba
from filelock import FileLock, Timeout
from numba.core.caching import FunctionCache
from numba.core.compiler_lock import global_compiler_lock
from numba.core.serialize import dumps

from bcre_ca.sources import SOURCES

LONGEST_WAIT = 120.0
"""Seconds after which a process compiles for itself what another one is compiling."""

_log = logging.getLogger(__name__)


def kept(function: Callable[..., Any], sources: str = SOURCES) -> Any:
    """The function compiled, free of Python's lock; ``sources`` is a digest of what it calls.

    Its own code is in the key of its machine code anyway.

    Where no folder can be written to, machine code is kept in memory only.
    """
    compiled = numba.njit(nogil=True, error_model="numpy")(function)
    try:
        Path("~").expanduser()  # Without a home numba would make a folder of that name.
        compiled._cache = cache = _Cache(function, sources)
    except (OSError, RuntimeError) as error:
        _say_once(f"compiled code is not kept on disk: {error}")
        return compiled

    def compile_once(signature: Any) -> Any:
        with global_compiler_lock, cache.alone(signature, compiled.targetctx.codegen()):
            return type(compiled).compile(compiled, signature)

    compiled.compile = compile_once
    return compiled


class _Cache(FunctionCache):  # type: ignore[misc]
    """Numba's, with other files and without its exceptions."""

    def __init__(self, function: Callable[..., Any], sources: str) -> None:
        super().__init__(function)
        self._cache_file = self.files = _Files(Path(self.cache_path), function.__name__, sources)

    def load_overload(self, signature: Any, target: Any) -> Any:
        try:
            return super().load_overload(signature, target)
        except Exception as error:
            _say_once(f"compiled code could not be read and is made anew: {error}")
            return None

    def save_overload(self, signature: Any, data: Any) -> None:
        try:
            super().save_overload(signature, data)
        except Exception as error:
            _say_once(f"compiled code is not kept on disk: {error}")

    @contextlib.contextmanager
    def alone(self, signature: Any, codegen: Any) -> Iterator[None]:
        """Hold off other processes from this specialisation unless it is on disk already."""
        path = self.files.path(self._index_key(signature, codegen))
        with contextlib.ExitStack() as held:
            if not path.exists():
                lock = FileLock(path.with_suffix(".lock"), timeout=LONGEST_WAIT)
                with contextlib.suppress(OSError, NotImplementedError, Timeout):
                    held.enter_context(lock)
            yield


class _Files:
    """A file a specialisation: the SHA-256 of what follows, then the machine code."""

    def __init__(self, folder: Path, name: str, sources: str) -> None:
        self.folder, self.name, self.sources = folder, name, sources

    def path(self, key: tuple[Any, ...]) -> Path:
        """Where the machine code of a key of numba's lies: argument types, processor, bytecode."""
        whole = repr((numba.__version__, self.sources, *key))
        return self.folder / f"{self.name}_{hashlib.sha256(whole.encode()).hexdigest()[:32]}.nbc"

    def load(self, key: tuple[Any, ...]) -> Any:
        """What was saved, or None where that is missing or damaged."""
        try:
            content = self.path(key).read_bytes()
        except FileNotFoundError:
            return None
        digest, data = content[:32], content[32:]
        return pickle.loads(data) if hashlib.sha256(data).digest() == digest else None

    def save(self, key: tuple[Any, ...], data: Any) -> None:
        """Write all of it or nothing."""
        content = dumps(data)
        handle, name = tempfile.mkstemp(dir=self.folder)
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(hashlib.sha256(content).digest() + content)
            Path(name).replace(self.path(key))
        except BaseException:
            Path(name).unlink()
            raise


_said: set[str] = set()


def _say_once(what: str) -> None:
    if what not in _said:
        _said.add(what)
        _log.warning(what)
