r"""Speed on a plane: ratios within interleaved rounds, and planes that play at 60 frames a second.

Sand rolls on every cell, so that no window saves work. A pass over memory reads and writes h and R.
``two_threads_at_best`` is what two threads gain where they share nothing. Where it is far below 2
others hold the second processor, and goals of two threads cannot be judged.
"""

from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numba
import numpy as np
import pandas as pd
from pde import PDE, CartesianGrid, FieldCollection, ScalarField

import bcre_ca
from bcre_ca.plane import BLOCK, Plane, Run, Sand, step
from bcre_ca.plane.theory import max_stable_step
from bcre_pde.plane import Material
from bcre_pde.plane.equation import BCRE
from bcre_studies.performance.record.sizes import FRAME_S, FRAMES
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.scene import load
from bcre_studies.timing import machine
from bcre_studies.timing.clock import Call, Timed, take_turns
from bcre_studies.timing.machine import Load

RULE = bcre_ca.Rule(v=0.5, D=0.1, gamma=0.01, Sc=0.5, d=1.0, dt=0.4)
ADDITIONS = 30_000_000
SMALL, MEDIUM, LARGE = 256, 1024, 2048
"""Cells along each side."""

SIDES = tuple(round(256 * math.sqrt(2) ** power) for power in range(9))
GOALS = {"figure1": 768, "figure2": 1536}
"""Cells along each side that are to play on two threads."""


def ratios() -> pd.DataFrame:
    """The automaton against NumPy, memory, threads, BCRE and py-pde's own expressions."""
    at_best = two_threads_at_best()
    rows = [*_against_numpy(), *_large_planes(), *_against_expressions()]
    return pd.DataFrame(rows).assign(two_threads_at_best=at_best)


def two_threads_at_best() -> float:
    """How many times as much two threads add up as one, where nothing is read from memory."""
    _add_up(1)

    def together() -> None:
        with ThreadPoolExecutor(2) as pool:
            for part in [pool.submit(_add_up, ADDITIONS) for _ in range(2)]:
                part.result()

    return (
        2 * take_turns({"one": lambda: _add_up(ADDITIONS), "two": together}).ratio("one", "two")[0]
    )


@numba.njit(nogil=True)
def _add_up(number):  # type: ignore[no-untyped-def]
    total = 0.0
    for i in range(number):
        total += (i % 7) * 1.1
    return total


def _against_numpy() -> list[dict[str, Any]]:
    loads = {
        "automaton": automaton(MEDIUM, 1),
        "NumPy": plain_numpy(MEDIUM),
        "BCRE": right_hand_side(MEDIUM, 1),
    }
    timed = _timed(loads)
    seconds = timed.table().set_index("name")
    rate = loads["BCRE"].amount / 1e6 / seconds.loc["BCRE"]
    millions = (rate["median_s"], rate["largest_s"], rate["smallest_s"])
    what = f"automaton : NumPy step, {MEDIUM} x {MEDIUM} cells"
    return [
        _row(what, 20.0, _ratio(timed, loads, "automaton", "NumPy")),
        _row(f"BCRE right-hand side, 1e6 cells/s, {MEDIUM} x {MEDIUM} cells", 20.0, millions),
    ]


def _large_planes() -> list[dict[str, Any]]:
    passing = machine.memory_pass(LARGE**2)
    loads = {
        "one": automaton(LARGE, 1),
        "two": automaton(LARGE, 2),
        "pass": Load(passing.call, float(LARGE**2)),
    }
    timed = _timed(loads)
    size = f"{LARGE} x {LARGE} cells"
    return [
        _row(f"automaton : a pass over memory, {size}", 0.75, _ratio(timed, loads, "one", "pass")),
        _row(f"two threads : one, {size}", 1.7, _ratio(timed, loads, "two", "one")),
    ]


def _against_expressions() -> list[dict[str, Any]]:
    loads = {
        "automaton": automaton(SMALL, 1),
        "BCRE": right_hand_side(SMALL, 1),
        "expressions": expressions(SMALL),
    }
    timed = _timed(loads)
    size = f"{SMALL} x {SMALL} cells"
    return [
        _row(
            f"automaton : BCRE right-hand side, {size}",
            1.0,
            _ratio(timed, loads, "automaton", "BCRE"),
        ),
        _row(
            f"automaton : py-pde's right-hand side from expressions, {size}",
            1.0,
            _ratio(timed, loads, "automaton", "expressions"),
        ),
    ]


def _timed(loads: dict[str, Load]) -> Timed:
    return take_turns({name: load.call for name, load in loads.items()})


def _ratio(timed: Timed, loads: dict[str, Load], fast: str, slow: str) -> tuple[float, ...]:
    scale = loads[fast].amount / loads[slow].amount
    return tuple(scale * value for value in timed.ratio(slow, fast))


def _row(what: str, goal: float, ratio: tuple[float, ...]) -> dict[str, Any]:
    median, smallest, largest = ratio
    return {"ratio": what, "goal": goal, "median": median, "from": smallest, "to": largest}


def wet_plane(side: int) -> tuple[Array, Array]:
    """h and R of a plane about its repose slope with sand rolling everywhere."""
    wave = np.sin(2 * np.pi * np.arange(side) / min(side, 1000))
    h = -RULE.Sc * np.arange(side)[:, None] + 0.1 * np.outer(wave, wave)
    return h, 1 + 0.5 * np.outer(wave, np.roll(wave, side // 3))


def automaton(side: int, threads: int) -> Load:
    """Blocks of compiled steps."""
    run = Run(Sand(*wet_plane(side)), Plane(RULE), threads)
    return Load(lambda: run.take(BLOCK), float(BLOCK * side**2))


def plain_numpy(side: int) -> Load:
    """The step that defines the rule, in NumPy."""
    layers, plane = wet_plane(side), Plane(RULE)
    return Load(lambda: step(*layers, plane), float(side**2))


def right_hand_side(side: int, threads: int) -> Load:
    """That of BCRE, of fifth order."""
    material = Material(RULE.v, RULE.D, RULE.D, RULE.gamma, RULE.Sc)
    grid = BCRE.grid(float(side), float(side), (side, side), (True, True))
    equation = BCRE(material, grid, threads=threads)
    h, R = wet_plane(side)
    u = h + RULE.Sc * np.arange(side)[:, None]
    layers = np.array(BCRE.state(grid, u, R, u[0]).data)
    rates = np.zeros_like(layers)
    return Load(lambda: equation.rate(layers, rates), float(side**2))


def expressions(side: int) -> Load:
    """BCRE as py-pde's users write it, central differences, compiled by py-pde."""
    grid = CartesianGrid([[0.0, float(side)]] * 2, side, periodic=True)
    h, R = wet_plane(side)
    u = h + RULE.Sc * np.arange(side)[:, None]
    state = FieldCollection([ScalarField(grid, u), ScalarField(grid, R)])
    exchange = "gamma * R * d_dx(u)"
    equation = PDE(
        {"u": exchange, "R": f"D * laplace(R) - v * d_dx(R) - {exchange}"},
        consts={"gamma": RULE.gamma, "D": RULE.D, "v": RULE.v},
    )
    rate: Any = equation.make_pde_rhs(state, backend="numba")
    data = np.array(state.data)
    return Load(lambda: rate(data, 0.0), float(side**2))


def budget() -> pd.DataFrame:
    """Cells along each side of the plane that plays a figure's material at 60 frames a second.

    The plane is as long and wide as the figure, in 600 frames, with sand rolling on every cell and
    the longest stable step. Frames take a power of the side between the two sides about the budget.
    """
    rows, at_best = [], two_threads_at_best()
    for name, goal in GOALS.items():
        for threads in (1, 2):
            side, steps = _largest_side(name, threads)
            row = {"scene": name, "threads": threads, "side": side, "steps_a_frame": steps}
            rows.append(row | {"goal": goal if threads == 2 else None})
    table = pd.DataFrame(rows).astype({"goal": "Int64"})
    return table.assign(two_threads_at_best=at_best)


def _largest_side(name: str, threads: int) -> tuple[float, int]:
    scene = load(name)
    former, taken, side, steps = 0.0, 0.0, SIDES[0], 0
    for side in SIDES:
        call, steps = _frame(scene.domain.length, scene.time.until / FRAMES, name, side, threads)
        former, taken = taken, float(take_turns({"frame": call}).table()["median_s"].iloc[0])
        if taken > FRAME_S:
            break
    power = math.log(taken / former) / math.log(math.sqrt(2)) if former > 0 else 3.0
    return side * (FRAME_S / taken) ** (1 / power), steps


def _frame(length: float, seconds: float, name: str, side: int, threads: int) -> tuple[Call, int]:
    m, d = load(name).material, length / side
    h, R = wet_plane(side)
    rule = bcre_ca.Rule(m.v, m.D, m.gamma, m.Sc, d, dt=1.0)
    steps = math.ceil(seconds / (bcre_ca.MARGIN * max_stable_step(Plane(rule), 1.5)))
    run = Run(Sand(h * d, 1e-3 * R), Plane(rule), threads)
    return lambda: run.take(steps, seconds / steps), steps
