"""Times that may be compared: all calls take turns, so that what disturbs one disturbs all.

Another process, a warmer processor or a lower clock rate then enters every call alike, and the
ratio of two medians of one table holds where their seconds do not.
"""

from __future__ import annotations

import gc
import math
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
import pandas as pd
from rich.console import Console
from rich.progress import Progress

Call = Callable[[], object]

LEAST_ROUNDS = 5
"""A median of fewer could be a single disturbed round."""

LEAST_S = 0.02
"""Shorter calls are repeated for this long within a round, in seconds: 10^5 ticks of the clock."""


@dataclass(frozen=True)
class Timed:
    """Seconds per call: ``first_s`` of the first, ``rounds_s`` of every round (rounds, names)."""

    first_s: dict[str, float]
    repeats: dict[str, int]
    rounds_s: pd.DataFrame

    def table(self) -> pd.DataFrame:
        """One row per call: name; first_s; median_s, smallest_s, largest_s; rounds; repeats."""
        each = self.rounds_s.to_numpy()
        return pd.DataFrame(
            {
                "name": list(self.first_s),
                "first_s": list(self.first_s.values()),
                "median_s": np.median(each, axis=0),
                "smallest_s": each.min(axis=0),
                "largest_s": each.max(axis=0),
                "rounds": len(each),
                "repeats": list(self.repeats.values()),
            }
        )

    def ratio(self, slower: str, faster: str) -> tuple[float, float, float]:
        """How many times longer one call takes than another: median, smallest, largest by round.

        What disturbs a whole round leaves its ratio alone, unlike the ratio of two medians.
        """
        by_round = self.rounds_s[slower] / self.rounds_s[faster]
        return float(by_round.median()), float(by_round.min()), float(by_round.max())


def interleaved(
    calls: Mapping[str, Call], rounds: int = LEAST_ROUNDS, budget_s: float = 0.0
) -> pd.DataFrame:
    """The table of :func:`take_turns`."""
    return take_turns(calls, rounds, budget_s).table()


def take_turns(
    calls: Mapping[str, Call], rounds: int = LEAST_ROUNDS, budget_s: float = 0.0
) -> Timed:
    """Seconds per call, cold and warm.

    Parameters
    ----------
    calls: what to time, by name. The first call of each is its first use, so it must do there
        what a user waits for (compile, set up), and nothing may have called it before.
    rounds: number of rounds, at least 5, in each of which every call has a turn. Of a call that
        is repeated within its turn, the mean counts.
    budget_s: further rounds are taken until so many seconds have passed since the first.

    Raises
    ------
    ValueError
        for fewer than 5 rounds.
    """
    if rounds < LEAST_ROUNDS:
        raise ValueError(f"rounds = {rounds!r}: must be at least {LEAST_ROUNDS}")
    console = Console(stderr=True)
    with (
        Progress(console=console, transient=True, disable=not console.is_terminal) as progress,
        _no_collection(),
    ):
        task = progress.add_task("timing", total=(rounds + 2) * len(calls))

        def begins(name: str) -> Call:
            progress.update(task, description=f"timing {name}", advance=1)
            return calls[name]

        first = {name: seconds(begins(name), 1) for name in calls}
        repeats = {name: repeats_needed(begins(name)) for name in calls}
        taken: list[dict[str, float]] = []
        began = time.perf_counter()
        while len(taken) < rounds or time.perf_counter() - began < budget_s:
            taken.append({name: seconds(begins(name), repeats[name]) for name in calls})
    return Timed(first, repeats, pd.DataFrame(taken))


def seconds(call: Call, repeats: int) -> float:
    """Mean seconds of so many calls in a row."""
    began = time.perf_counter()
    for _ in range(repeats):
        call()
    return (time.perf_counter() - began) / repeats


def repeats_needed(call: Call) -> int:
    """How many calls in a row take :data:`LEAST_S` at least."""
    repeats = 1
    while (taken := repeats * seconds(call, repeats)) < LEAST_S:
        repeats = max(2 * repeats, math.ceil(repeats * min(LEAST_S / max(taken, 1e-9), 100)))
    return repeats


@contextmanager
def _no_collection() -> Iterator[None]:
    """Without the garbage collector, which would strike whichever call is running."""
    was_on = gc.isenabled()
    gc.collect()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()
