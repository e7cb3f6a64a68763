"""The ratios that say how fast the automaton is, each measured within one interleaved run."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numba
import numpy as np
import pandas as pd

import bcre_ca
from bcre_studies.models.automaton import rule_of
from bcre_studies.models.bcre import problem_of
from bcre_studies.performance.record import loads
from bcre_studies.performance.rivals import method_of_lines, pypde_expressions
from bcre_studies.scenes.scene import load
from bcre_studies.timing import machine
from bcre_studies.timing.clock import Call, seconds, take_turns
from bcre_studies.timing.machine import Load

ROUNDS = 9


def measure(*, with_compiling: bool) -> pd.DataFrame:
    """All ratios; ``with_compiling`` adds those that take py-pde minutes to compile."""
    rows = [*_against_numpy(), *_against_the_limits(), *_window(), *_batch(), *_following()]
    return pd.DataFrame(rows + _against_solvers(with_compiling=with_compiling))


def _row(what: str, goal: float, ratio: tuple[float, float, float], **more: Any) -> dict[str, Any]:
    median, smallest, largest = ratio
    return {"ratio": what, "goal": goal, "median": median, "from": smallest, "to": largest, **more}


def _rates(named: dict[str, Load], rounds: int = ROUNDS) -> Callable[[str, str], Any]:
    """Ratio of amounts per second, first over second: median, smallest, largest by round."""
    timed = take_turns({name: load.call for name, load in named.items()}, rounds)

    def ratio(fast: str, slow: str) -> tuple[float, float, float]:
        scale = named[fast].amount / named[slow].amount
        median, low, high = timed.ratio(slow, fast)
        return median * scale, low * scale, high * scale

    return ratio


def _against_numpy() -> list[dict[str, Any]]:
    rows = []
    for cells, goal in ((1_000, 25.0), (100_000, 5.5), (10_000_000, 12.0)):
        large = cells > 1_000_000
        ratio = _rates(
            {
                "automaton": loads.automaton("upwind", cells, 6.4e8 if large else 3e7),
                "numpy": loads.plain_numpy(cells, 2e7 if large else 2e6),
            },
            5 if large else ROUNDS,
        )
        found = ratio("automaton", "numpy")
        rows.append(_row(f"automaton : preallocated NumPy, {cells:.0e} cells", goal, found))
    ratio = _rates(
        {"rhs": loads.right_hand_side(1000), "numpy": loads.plain_numpy(1000)},
    )
    what = "BCRE right-hand side : step of the preallocated NumPy automaton, 1e+03 cells"
    rows.append(_row(what, 0.5, ratio("rhs", "numpy")))
    return rows


def _against_the_limits() -> list[dict[str, Any]]:
    additions = machine.additions(2_000)
    cells = additions.amount / machine.ADDITIONS_A_CELL
    in_cache = _rates(
        {
            "automaton": loads.automaton("upwind", 1000, 3e6),
            "limit": Load(additions.call, cells),
        },
        41,
    )
    large = 10_000_000
    passing = machine.memory_pass(large)
    out_of_cache = _rates(
        {
            "automaton": loads.automaton("upwind", large, 6.4e8),
            "pass": Load(passing.call, float(large)),
        },
        5,
    )
    return [
        _row("automaton : 7 additions a cell, 1e+03 cells", 0.8, in_cache("automaton", "limit")),
        _row(
            "automaton : one pass over memory a step, 1e+07 cells",
            1.8,
            out_of_cache("automaton", "pass"),
        ),
    ]


def _window() -> list[dict[str, Any]]:
    part, everywhere = loads.partly_wet(1_000_000, 0.05, 320)
    ratio = _rates({"part": part, "everywhere": everywhere}, 5)
    what = "5 % of 1e+06 cells wet : all wet"
    return [_row(what, 14.0, ratio("part", "everywhere"))]


def _batch() -> list[dict[str, Any]]:
    most = numba.get_num_threads()
    one_scene = loads.automaton("upwind", 200, 1e7)
    many = loads.batch(1000, 200, 200)

    def on(threads: int) -> Load:
        def call() -> None:
            numba.set_num_threads(threads)
            try:
                many.call()
            finally:
                numba.set_num_threads(most)

        return Load(call, many.amount)

    ratio = _rates({"scene": one_scene, "one": on(1), "two": on(min(2, most))})
    return [
        _row("batch of 1000 scenes of 200 cells : one scene, one core", 0.7, ratio("one", "scene")),
        _row("the batch on two cores : on one", 1.6, ratio("two", "one")),
    ]


def _following() -> list[dict[str, Any]]:
    """A step that follows its bounds against the same step, fixed."""
    rows = []
    for cells in (100, 1000, 100_000):
        pile = bcre_ca.Pile(*loads.wet_slope(cells))
        rule = loads.RULE
        dt = bcre_ca.MARGIN * bcre_ca.largest_stable_step(pile, rule, "periodic")
        steps = loads.steps_for(cells, 3e7)
        span = [steps * dt]

        def run(step: Any, pile: Any = pile, rule: Any = rule, span: Any = span) -> Call:
            return lambda: list(bcre_ca.frames(pile, rule, span, "periodic", step))

        amount = float(cells * steps)
        ratio = _rates({"fixed": Load(run(dt), amount), "auto": Load(run("auto"), amount)}, 15)
        what = f"fixed step : step that follows its bounds, {cells:.0e} cells"
        rows.append(_row(what, 1 / 1.1, ratio("auto", "fixed")))
    return rows


def _against_solvers(*, with_compiling: bool) -> list[dict[str, Any]]:
    """Figure 2 to its end: the same cells, the same step where there is one."""
    scene = load("figure2")
    until, rows = scene.time.until, []
    for cells in (100, 400):
        changed = scene.with_changes(cells=cells, step=0.2 * 100 / cells)
        rule, layers = rule_of(changed), changed.initial(changed.centres())
        steps = round(until / rule.dt)

        calls: dict[str, Call] = {
            "automaton": partial(bcre_ca.evolve, *layers, rule, steps),
            "LSODA": method_of_lines.prepare(problem_of(scene), until, cells),
        }
        euler = with_compiling and cells == 400
        if euler:
            calls["Euler"] = pypde_expressions.prepare(problem_of(scene), until, cells, rule.dt)
        timed = take_turns(calls)
        what = f"automaton : SciPy LSODA on figure 2, {cells} cells"
        rows.append(_row(what, 30.0, timed.ratio("LSODA", "automaton")))
        if euler:
            what = "automaton : py-pde Euler, same scheme, 400 cells, compiled before"
            rows.append(_row(what, 3.0, timed.ratio("Euler", "automaton")))
            each_call = partial(pypde_expressions.solve, problem_of(scene), until, cells, rule.dt)
            cold = [seconds(each_call, 1) for _ in range(3)]
            ratios = np.sort(cold) / timed.table().set_index("name").loc["automaton", "median_s"]
            what = "automaton : py-pde Euler, same scheme, 400 cells, as called (it compiles)"
            rows.append(_row(what, 100.0, (ratios[1], ratios[0], ratios[-1])))
    return rows
