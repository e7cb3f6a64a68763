"""Many cases at once, with a progress bar: the one place that knows of processes.

Within :func:`kept` every finished case is a file, so that a run that is killed and started again
measures only the cases that it had not finished.
"""

from __future__ import annotations

import os
import threading
import time
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import closing, contextmanager
from contextvars import ContextVar
from functools import cache
from pathlib import Path
from typing import TypeVar

import joblib
from rich.markup import escape
from rich.progress import track

from bcre_studies.system import pickles

Case = TypeVar("Case")
Result = TypeVar("Result")

# With psutil there, loky replaces a worker that has grown by 300 MB, as compiled functions let it.
warnings.filterwarnings("ignore", "A worker stopped while some jobs", UserWarning)

_folder: ContextVar[Path | None] = ContextVar("folder of finished cases", default=None)


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


def each(function: Callable[[Case], Result], cases: Iterable[Case], label: str) -> list[Result]:
    """``[function(case) for case in cases]`` on all processors, in the order of the cases.

    Parameters
    ----------
    function: a module-level function, so that another process can import it.
    label: what the progress bar says.

    ``LOKY_MAX_CPU_COUNT`` limits the processors, as everywhere in joblib.
    """
    todo = list(cases)
    folder, parent = _folder.get(), os.getpid()
    tasks = [
        joblib.delayed(_once)(function, case, _place(folder, function, case), parent)
        for case in todo
    ]
    results = joblib.Parallel(n_jobs=-1, return_as="generator")(tasks)
    with closing(results):
        return list(track(results, description=escape(f"{label:24}"), total=len(todo)))


def _place(folder: Path | None, function: Callable[[Case], Result], case: Case) -> Path | None:
    return None if folder is None else folder / f"{joblib.hash((function, case))}.pickle"


def _once(
    function: Callable[[Case], Result], case: Case, place: Path | None, parent: int
) -> Result:
    """The result of a case: from its place where it is whole there, else measured and put there."""
    _end_with(parent)
    if place is None:
        return function(case)
    try:
        result: Result = pickles.load(place)
    except LookupError:
        result = function(case)
        pickles.dump(place, result)
    return result


@cache
def _end_with(parent: int) -> None:
    """Let a worker end when the run that started it is gone, even by a kill that it cannot see."""

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(0.5)
        os._exit(1)

    if os.getpid() != parent:
        threading.Thread(target=watch, daemon=True).start()
