"""Many cases at once, with a progress bar, on this machine or on a cluster.

Within :func:`kept` every finished case is a file, so that a run that is killed and started again
measures only the cases that it had not finished.
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import closing, contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path
from typing import Any, TypeVar

import joblib
from rich.console import Console
from rich.markup import escape
from rich.progress import track

from bcre_studies.sweeps.workers import connected, end_with
from bcre_studies.system import pickles

Case = TypeVar("Case")
Result = TypeVar("Result")

# With psutil there, loky replaces a worker that has grown by 300 MB, as compiled functions let it.
warnings.filterwarnings("ignore", "A worker stopped while some jobs", UserWarning)

_folder: ContextVar[Path | None] = ContextVar("folder of finished cases", default=None)
_elsewhere: ContextVar[bool] = ContextVar("whether the workers are those of a cluster")


@contextmanager
def kept(folder: Path) -> Iterator[None]:
    """Keep finished cases in ``folder``, and take from there those that it already has.

    The folder must be that of one state of the sources: a case is known by its function's name
    and its content alone.
    """
    before = _folder.set(folder)
    try:
        yield
    finally:
        _folder.reset(before)


@contextmanager
def on(scheduler: str | None) -> Iterator[None]:
    """Measure on the workers of the Dask scheduler at this address; None: on all processors here.

    Its workers must have the same sources as this process.

    Raises
    ------
    ClusterError
        where no scheduler answers.
    """
    if scheduler is None:
        yield
        return
    with connected(scheduler) as client, joblib.parallel_config("dask", client=client):
        before = _elsewhere.set(True)
        try:
            yield
        finally:
            _elsewhere.reset(before)


def each(function: Callable[[Case], Result], cases: Iterable[Case], label: str) -> list[Result]:
    """``[function(case) for case in cases]`` on all processors, in the order of the cases.

    Parameters
    ----------
    function: a module-level function, so that another process can import it.
    label: what the progress bar says.

    ``LOKY_MAX_CPU_COUNT`` limits the processors, as everywhere in joblib.
    """
    todo, folder = list(cases), _folder.get()
    places = [None if folder is None else _place(folder, function, case) for case in todo]
    results = _finished(places)
    found = len(results)
    parent = None if _elsewhere.get(False) else os.getpid()
    tasks = (
        joblib.delayed(_numbered)(i, function, case, parent)
        for i, case in enumerate(todo)
        if i not in results
    )
    measured = joblib.Parallel(n_jobs=-1, return_as="generator_unordered")(tasks)
    with closing(measured):
        what, console = escape(f"{label:24}"), Console(stderr=True)
        shown = track(measured, what, total=len(todo), completed=found, console=console)
        for i, result in shown:
            results[i] = result
            place = places[i]
            if place is not None:
                pickles.dump(place, result)
    return [results[i] for i in range(len(todo))]


def _place(folder: Path, function: Callable[[Any], Any], case: Any) -> Path:
    return folder / f"{joblib.hash((function, case))}.pickle"


def _finished(places: list[Path | None]) -> dict[int, Any]:
    """The results that are whole in their places, by the numbers of their cases."""
    results = {}
    for i, place in enumerate(places):
        if place is not None:
            with suppress(LookupError):
                results[i] = pickles.load(place)
    return results


def _numbered(
    number: int, function: Callable[[Case], Result], case: Case, parent: int | None
) -> tuple[int, Result]:
    """What a worker does; one of this machine ends with the ``parent`` that started it."""
    if parent is not None:
        end_with(parent)
    return number, function(case)
