"""The record of speed: what is measured on one machine in one run, and where it is kept.

``reports/speed/`` holds the committed record and names its machine; ``reports/local/`` that of the
machine at hand, which is measured in less than a minute and belongs to no repository.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pandas as pd

from bcre_studies.comparison.rounding import significant
from bcre_studies.performance.record import contest
from bcre_studies.system import records
from bcre_studies.system.files import REPORTS, replace_text
from bcre_studies.timing import machine
from bcre_studies.timing.clock import take_turns

Tables = dict[str, pd.DataFrame]

READS = "speed/*.csv"
RECORD = REPORTS / "speed"
LOCAL = REPORTS / "local"

TARGETS = (0.1, 0.03, 0.01, 0.001)
"""Relative L1 errors of R to be reached."""

LOCAL_SCENES = ("figure 2", contest.WAVE)
DIGITS = 3


def measure_record() -> Tables:
    """Everything, some minutes: for a machine that does nothing else."""
    from bcre_studies.performance.record import (
        first_use,
        models,
        plane,
        ratios,
        sizes,
        specialisation,
    )
    from bcre_studies.performance.record.advice_times import time_hits
    from bcre_studies.timing import costs

    raced = race(contest.own() + contest.rivals(), tuple(contest.scenes()))
    return {
        "machine": _machine(),
        "contest": raced,
        "reach": reach(raced),
        "ratios": ratios.measure(with_compiling=True),
        "sizes": sizes.measure(),
        "budget": sizes.budget(),
        "models": models.measure(),
        "plane": plane.ratios(),
        "plane_budget": plane.budget(),
        "first_use": first_use.measure(),
        "costs": costs.measure(),
        "specialisation": specialisation.specialisation_gains(),
        "advice": time_hits(),
    }


def measure_local() -> Tables:
    """The race of our own models on two scenes, and the ratios that need no compiling."""
    from bcre_studies.performance.record import ratios

    quick = tuple(
        contender for contender in contest.own() if contender.name not in ("PDE, LSODA", "PDE, BDF")
    )
    raced = race(quick, LOCAL_SCENES, most=8e6)
    return {
        "machine": _machine(),
        "contest": raced,
        "reach": reach(raced),
        "ratios": ratios.measure(with_compiling=False),
    }


def write(tables: Tables, folder: Path) -> None:
    """One CSV file a table, each whole or not at all; numbers to three digits."""
    for name, table in tables.items():
        floats = table.select_dtypes("float").columns
        rounded = table.assign(**{column: table[column].map(_rounded) for column in floats})
        replace_text(folder / f"{name}.csv", rounded.to_csv(index=False, lineterminator="\n"))


def read(folder: Path) -> Tables:
    """The tables of a record."""
    return {path.stem: pd.read_csv(path) for path in sorted(folder.glob("*.csv"))}


def recorded(*names: str) -> Tables:
    """These tables of the committed record.

    Raises
    ------
    FileNotFoundError
        naming the one that is missing.
    """
    return {name: pd.read_csv(records.record(f"speed/{name}.csv")) for name in names}


def race(
    contenders: tuple[contest.Contender, ...], labels: tuple[str, ...], most: float | None = None
) -> pd.DataFrame:
    """Errors and seconds of every contender on every grid of every scene.

    The grids of one scene take turns, so that the times of a scene may be compared.
    """
    tables = []
    for label in labels:
        scene, rows, calls = contest.scenes()[label], [], {}
        for contender in contenders:
            if not contender.enters(label):
                continue
            for cells, solve, end in contest.rungs(contender, scene, most):
                rows.append(contest.row_of(label, contender, cells, end))
                calls[f"{contender.name}, {cells}"] = solve
        times = take_turns(calls).table()
        columns = times[["median_s", "smallest_s", "largest_s", "rounds"]]
        tables.append(pd.concat([pd.DataFrame(rows), columns], axis=1))
    return pd.concat(tables, ignore_index=True)


def reach(raced: pd.DataFrame) -> pd.DataFrame:
    """Seconds to reach an error of R: the cheapest grid measured that has no more.

    ``to_automaton`` is the time against that of the paper's rule, ``automaton_s``; where that was
    fine enough on no grid tried, the latter is a lower bound (``at_least``), or missing where the
    error grows as cells get finer.
    """
    rows: list[dict[str, Any]] = []
    for (scene, target), group in _with_targets(raced):
        found = [
            best
            for _, rungs in group.groupby("contender", sort=False)
            if (best := cheapest(rungs, target, "median_s")) is not None
        ]
        nominal = group[group["contender"] == "automaton, upwind"]
        seconds, at_least = _seconds_to(nominal, target)
        rows.extend(
            {
                "scene": scene,
                "error": target,
                "contender": best["contender"],
                "cells": best["cells"],
                "seconds": best["median_s"],
                "to_automaton": None if seconds is None else best["median_s"] / seconds,
                "automaton_s": seconds,
                "at_least": at_least,
                "winner": best["median_s"] == min(other["median_s"] for other in found),
            }
            for best in found
        )
    return pd.DataFrame(rows)


def _with_targets(raced: pd.DataFrame) -> list[tuple[tuple[str, float], pd.DataFrame]]:
    return [
        ((str(scene), target), group)
        for scene, group in raced.groupby("scene", sort=False)
        for target in TARGETS
    ]


def _seconds_to(rungs: pd.DataFrame, target: float) -> tuple[float | None, bool]:
    """Seconds of a first-order scheme to an error, and whether they are but a lower bound.

    Half the error takes twice the cells at least, and they twice the steps. None where the error
    grows as cells get finer.
    """
    best = cheapest(rungs, target, "median_s")
    if best is not None:
        return float(best["median_s"]), False
    coarse, fine = rungs.iloc[-2], rungs.iloc[-1]
    if fine["error_R"] >= coarse["error_R"]:
        return None, True
    return float(fine["median_s"] * (fine["error_R"] / target) ** 2), True


def cheapest(rungs: pd.DataFrame, target: float, cost: str) -> pd.Series | None:
    """The row of least cost among those whose error of R is no more than the target."""
    reached = rungs[rungs["error_R"] <= target]
    return None if reached.empty else reached.loc[reached[cost].idxmin()]


def _machine() -> pd.DataFrame:
    described = machine.description()
    return pd.DataFrame({"what": list(described), "which": list(described.values())})


def _rounded(value: float) -> float:
    return significant(value, DIGITS)
