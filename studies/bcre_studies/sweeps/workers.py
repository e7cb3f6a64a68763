"""Where the points of a sweep are measured: on this machine's processors, or on a Dask cluster.

Both run ``function(*arguments)`` in another process and return a future of
``concurrent.futures``; so the loop over them (:mod:`bcre_studies.sweeps.stream`) is one.
"""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from functools import cache
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    from distributed import Client

ANSWER_S = 10.0
"""Seconds within which a scheduler must answer."""

PATIENCE_S = 60.0
"""Seconds that a cluster may be without any worker; a manager starts lost ones again by then."""


class ClusterError(ValueError):
    """A scheduler that does not answer, or has no workers; one line that names it."""


class Workers(Protocol):
    """Processes that measure.

    ``died`` are the exceptions of a future whose worker died; ``blames`` says whether it died of
    that very work, again and again, or perhaps of what another worker did.
    """

    died: tuple[type[BaseException], ...]
    blames: bool

    def count(self) -> int:
        """How many functions run at once."""

    def submit(self, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
        """Start the function, which another process must be able to import."""

    def require_alive(self) -> None:
        """Raise :class:`ClusterError` where nobody will ever answer."""

    def close(self) -> None:
        """End what was started."""


class Local:
    """Loky's workers, the same that joblib uses; they end with this process, even if killed."""

    died: tuple[type[BaseException], ...] = (BrokenProcessPool,)
    blames = False

    def count(self) -> int:
        import joblib

        return int(joblib.effective_n_jobs(-1))

    def submit(self, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
        future: Future[Any] = self._executor().submit(_in_worker, os.getpid(), function, *arguments)
        return future

    def require_alive(self) -> None:
        """Loky notices the death of a worker by itself."""

    def close(self) -> None:
        self._executor().shutdown(kill_workers=True)

    def _executor(self) -> Any:
        """The present one; a new one after a worker has died."""
        from joblib.externals.loky import get_reusable_executor

        return get_reusable_executor(max_workers=self.count())


class Cluster:
    """The workers of a Dask scheduler, which starts the work of one that dies on another.

    It gives up on work that has killed as many as ``distributed.scheduler.allowed-failures`` says.
    """

    blames = True

    def __init__(self, client: Client) -> None:
        from distributed.scheduler import KilledWorker

        self.died: tuple[type[BaseException], ...] = (KilledWorker,)
        self._client = client
        self._address = str(client.scheduler.address)
        self._executor = client.get_executor(pure=False)
        self._seen = time.monotonic()

    def count(self) -> int:
        return max(int(sum(self._client.nthreads().values())), 1)

    def submit(self, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
        future: Future[Any] = self._executor.submit(_single_threaded, function, *arguments)
        return future

    def require_alive(self) -> None:
        if self._client.status != "running":
            raise ClusterError(f"--scheduler = {self._address!r}: the scheduler is gone")
        now = time.monotonic()
        if self._client.nthreads():
            self._seen = now
        elif now - self._seen > PATIENCE_S:
            raise ClusterError(
                f"--scheduler = {self._address!r}: has had no workers for {PATIENCE_S:.0f} s; must "
                "have at least one, started by dask worker"
            )

    def close(self) -> None:
        self._executor.shutdown(wait=False)


@contextmanager
def workers_of(scheduler: str | None) -> Iterator[Workers]:
    """This machine's processors, or the workers of the scheduler at an address."""
    if scheduler is None:
        local = Local()
        try:
            yield local
        finally:
            local.close()
        return
    with connected(scheduler) as client:
        cluster = Cluster(client)
        try:
            yield cluster
        finally:
            cluster.close()


@contextmanager
def connected(scheduler: str) -> Iterator[Client]:
    """A client of the scheduler at an address like ``tcp://host:port``.

    Raises
    ------
    ClusterError
        where nobody answers there, or Dask is not installed.
    """
    try:
        from distributed import Client
    except ImportError:
        raise ClusterError(
            f"--scheduler = {scheduler!r}: needs Dask, pip install -r requirements-cluster.lock"
        ) from None
    try:
        client = Client(scheduler, timeout=ANSWER_S)
    except (OSError, ValueError, TypeError) as error:
        raise ClusterError(
            f"--scheduler = {scheduler!r}: no scheduler answers there ({error}); must be an "
            "address such as tcp://127.0.0.1:8786, of one that dask scheduler has started"
        ) from None
    with client:
        yield client


def end_with(parent: int) -> None:
    """Let this worker end when the run that started it is gone, even by a kill it cannot see."""
    if os.getpid() != parent:
        _watch(parent)


@cache
def _watch(parent: int) -> None:
    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(0.5)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def _in_worker(parent: int, function: Callable[..., Any], *arguments: Any) -> Any:
    end_with(parent)
    return _single_threaded(function, *arguments)


def _single_threaded(function: Callable[..., Any], *arguments: Any) -> Any:
    """There are as many workers as processors; each takes one."""
    import numba

    numba.set_num_threads(1)
    return function(*arguments)
