"""Many cases at once, with a progress bar: the one place that knows of processes."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TypeVar

from joblib import Parallel, delayed
from rich.progress import track

Case = TypeVar("Case")
Result = TypeVar("Result")


def each(function: Callable[[Case], Result], cases: Iterable[Case], label: str) -> list[Result]:
    """``[function(case) for case in cases]`` on all processors, in the order of the cases.

    Parameters
    ----------
    function: a module-level function, so that another process can import it.
    label: what the progress bar says.
    """
    todo = list(cases)
    results = Parallel(n_jobs=-1, return_as="generator")(delayed(function)(case) for case in todo)
    return list(track(results, description=f"{label:24}", total=len(todo)))
