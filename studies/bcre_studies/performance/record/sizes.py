"""Speed by size of the pile, and how large a pile may be at 60 frames a second."""

from __future__ import annotations

import math
from functools import partial
from typing import Any, cast

import pandas as pd

from bcre_ca.rule import Scheme
from bcre_studies.performance.record import loads
from bcre_studies.performance.record.contest import Contender, own
from bcre_studies.scenes.scene import Scene, load
from bcre_studies.timing import machine
from bcre_studies.timing.clock import Call, take_turns
from bcre_studies.timing.machine import Load

SIZES = (100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000)
SCHEMES = ("upwind", "calibrated", "limited")
BYTES_A_CELL = {
    "upwind": 16,
    "calibrated": 16,
    "limited": 48,
    "right-hand side of BCRE": 80,
    "preallocated NumPy": 40,
}
"""Layers and scratch in float64: h and R; four rows more for the limited scheme; three fields,
their rates, neighbours and faces for BCRE; flux, exchange and one row more for NumPy."""

FRAME_S = 1 / 60
FRAMES = 600
"""Ten seconds from the start of a scene to its end."""

COUNTED_CELLS = 800


def measure(sizes: tuple[int, ...] = SIZES) -> pd.DataFrame:
    """Cell-steps per second by model and size, and their share of what the machine allows.

    The limit is what 7 additions a cell take at best where the pile fits into the cache, and one
    pass over memory a step where it does not; of the two, whichever is lower.
    """
    rows = []
    for cells in sizes:
        work = {name: _load(name, cells) for name in BYTES_A_CELL}
        additions, passing = machine.additions(2_000), machine.memory_pass(cells)
        passes = loads.steps_for(cells, 3e7)
        calls = {name: load.call for name, load in work.items()}
        calls["additions"] = additions.call
        calls["pass"] = partial(_repeat, passing.call, passes)
        times = take_turns(calls).table().set_index("name")["median_s"]
        additions_limit = additions.amount / machine.ADDITIONS_A_CELL / times["additions"]
        pass_limit = cells * passes / times["pass"]
        for name, load_ in work.items():
            rate = load_.amount / times[name]
            rows.append(
                {
                    "model": name,
                    "cells": cells,
                    "cell_steps_per_s": rate,
                    "share_of_additions": rate / additions_limit,
                    "share_of_a_pass": rate / pass_limit,
                    "bytes_a_cell": BYTES_A_CELL[name],
                }
            )
    return pd.DataFrame(rows)


def _repeat(call: Call, times: int) -> None:
    for _ in range(times):
        call()


def _load(name: str, cells: int) -> Load:
    if name == "right-hand side of BCRE":
        return loads.right_hand_side(cells)
    if name == "preallocated NumPy":
        return loads.plain_numpy(cells)
    return loads.automaton(cast(Scheme, name), cells, 3e7 if name != "limited" else 1e7)


def budget() -> pd.DataFrame:
    """The finest grid on which each model plays each figure of the paper at 60 frames a second.

    A scene is played in ten seconds, its 600 frames equally far apart. The first frame is timed on
    grids twice as fine each until it takes too long, and counted with the steps that the mean
    frame of the whole scene takes for each of its own, since avalanches that grow shorten the
    step. Between the last two grids, frames take a power of the number of cells.
    """
    return pd.DataFrame(
        [
            {"scene": name, "model": contender.name, **_finest(contender, load(name))}
            for name in ("figure1", "figure2", "figure3")
            for contender in own()[:4]
        ]
    )


def _finest(contender: Contender, scene: Scene) -> dict[str, Any]:
    first = scene.with_changes(until=scene.time.until / FRAMES)
    steps = [contender.prepare(part, COUNTED_CELLS)().steps for part in (scene, first)]
    dearer = max(steps[0] / FRAMES / steps[1], 1.0)

    def frame_s(cells: int) -> float:
        solve = contender.prepare(first, cells)
        solve()
        return dearer * float(take_turns({"frame": solve}).table()["median_s"].iloc[0])

    cells, taken, former = 400, frame_s(400), 0.0
    while taken < FRAME_S and cells < 10**6:
        cells, former = 2 * cells, taken
        taken = frame_s(cells)
    power = math.log2(taken / former) if former > 0 else 2.0
    most = cells * (FRAME_S / taken) ** (1 / power)
    return {"cells": most, "d": scene.domain.length / most, "steps_against_first_frame": dearer}
