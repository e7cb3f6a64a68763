"""How long compiling takes, apart from what is compiled."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def compiling() -> Iterator[Callable[[], float]]:
    """A function that returns the seconds which numba has spent on compiling since the beginning.

    Reading what an earlier process has compiled counts, and so does waiting for another process
    that compiles the same.
    """
    from numba.core import event

    listener = event.TimingListener()
    with event.install_listener("numba:compiler_lock", listener):
        yield lambda: listener.duration if listener.done else 0.0
