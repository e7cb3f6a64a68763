"""One random scene through ``bcre run``'s own entry, held against the plain integrations.

Every check gives a number and what is allowed of it; a scene that a check does not concern has no
such number. All are relative to the thickest layer of the scene, unless they say otherwise.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import exact_sand
import plain_automaton
import plain_bcre
from bcre_studies.models.run import Run
from bcre_studies.running.run import run_scene
from bcre_studies.scenes.refusal import SceneError
from bcre_studies.scenes.scene import load
from drawn_scenes import Drawn

Array = NDArray[np.float64]

ROUNDING = 1e-10
"""Of a hundred steps or so, in layers that grow by e^3 at the most."""

TABLE = 1e-5
"""Error of a cubic through six rows a cell, where twelve cells make a wave at the least."""

LOOKS = 64
"""Steps between two looks at the bounds: a step beyond them for longer must have been seen."""

DRY = 3.0
"""Mean change of R by the cut-off, in units of ``dry``: two fronts leave a layer of it each."""

CHECKS: dict[str, str] = {
    "start h": "automaton: h at t = 0 against the exact value at each cell's centre",
    "start R": "automaton: R at t = 0 against the exact value at each cell's centre",
    "start BCRE": "BCRE: h and R at t = 0 against the exact values, or means, on its own grid",
    "start mass": "automaton against BCRE: sand at the start, relative to all that rolls",
    "rule": "automaton, fixed step: h and R against the plain automaton, largest difference",
    "auto": "automaton, step 'auto': R against the plain automaton with the mean step, mean",
    "dry": "automaton with a cut-off: R against the plain automaton without, mean",
    "mass": "either model: change of sand and outflow together, at any frame",
    "negative": "automaton: how far R falls below 0",
    "frames": "automaton: h and R at common times of runs with few and many frames",
    "steps": "automaton: steps of runs with few and many frames, difference",
    "BCRE frames": "BCRE: R at the end of runs with few and many frames, mean",
    "BCRE R": "BCRE: R against the plain integration, mean over all frames",
    "BCRE h": "BCRE: h against the plain integration, mean over all frames",
    "unstable": "automaton: steps beyond the bound in a run that was not refused",
    "refused": "automaton: 1 where a run was refused whose step never passed the bound",
}


class Found(NamedTuple):
    """A number and what is allowed of it."""

    value: float
    allowed: float

    @property
    def holds(self) -> bool:
        return self.value <= self.allowed


def judge(drawn: Drawn, folder: Path) -> dict[str, Found]:
    """All checks of one scene."""
    path = drawn.write(folder)
    automaton, refusal = run(path, "ca", drawn.frames)
    if automaton is None:
        return _of_refusal(drawn, refusal)
    bcre, refusal = run(path, "both" if drawn.options["model"] == "both" else "pde", drawn.frames)
    assert bcre is not None, refusal
    return {
        **of_start(drawn, automaton),
        **_of_start_of_bcre(drawn, automaton, bcre),
        **_of_rule(drawn, automaton),
        **of_frames(drawn, path, automaton),
        **_of_frames_of_bcre(drawn, path, bcre),
        **_of_bcre(drawn, bcre),
        "mass": Found(max(_mass_error(automaton), _mass_error(bcre)), 1e-12),
    }


def run(path: Path, model: Any, frames: int) -> tuple[Run | None, str]:
    """The run of the model, the last one of both; or None and why it was refused."""
    try:
        return run_scene(load(path), model, frames)[-1], ""
    except SceneError as refusal:
        return None, str(refusal)


def _of_refusal(drawn: Drawn, refusal: str) -> dict[str, Found]:
    """A refused step has to pass the bound, at the start or later."""
    assert drawn.options["step"] != "auto", refusal
    assert "stable" in refusal, refusal
    column, step = drawn.column(), drawn.data["time"]["step"]
    column.passed.append(column.largest_step())
    with np.errstate(all="ignore"):
        plain_automaton.march(column, step, _whole_steps(drawn), watch=True)
    passed = any(not step <= largest * (1 + 1e-9) for largest in column.passed)
    return {"refused": Found(0.0 if passed else 1.0, 0.0)}


def _whole_steps(drawn: Drawn) -> int:
    return math.floor(drawn.until / drawn.data["time"]["step"] * (1 + 1e-9))


def of_start(drawn: Drawn, automaton: Run) -> dict[str, Found]:
    """The automaton's sand at t = 0."""
    h, R = exact_sand.values(drawn.data, automaton.x)
    scale, allowed = float(R.max()), _exactness(drawn)
    return {
        "start h": Found(_largest(automaton.h[0] - h) / scale, allowed),
        "start R": Found(_largest(automaton.R[0] - R) / scale, allowed),
    }


def _exactness(drawn: Drawn) -> float:
    kinds = {term["kind"] for term in drawn.data["surface"] + drawn.data["rolling"]}
    return TABLE if "table" in kinds else 1e-9


def _of_start_of_bcre(drawn: Drawn, automaton: Run, bcre: Run) -> dict[str, Found]:
    """BCRE's sand at t = 0: values at the centres, or means, as its scheme takes them."""
    _, R = exact_sand.averages(drawn.data, drawn.cells)
    off = [
        max(_largest(bcre.h[0] - exact[0]), _largest(bcre.R[0] - exact[1]))
        for exact in (
            exact_sand.averages(drawn.data, bcre.x.size),
            exact_sand.values(drawn.data, bcre.x),
        )
    ]
    # Sums of values converge to the integral too, at second order if the profile ends abruptly.
    gap = abs(automaton.mass()[0] - bcre.mass()[0]) / (drawn.d * float(R.sum()))
    return {
        "start BCRE": Found(min(off) / float(R.max()), _exactness(drawn)),
        "start mass": Found(gap, 1e-3),
    }


def _of_rule(drawn: Drawn, run: Run) -> dict[str, Found]:
    """The automaton's layers at the recorded times, and its bounds on the way."""
    scale = float(run.R.max())
    found = {"negative": Found(max(-float(run.R.min()), 0.0) / scale, 1e-15)}
    if drawn.options["step"] == "auto":
        return found | {"auto": _against_mean_step(drawn, run)}
    step = drawn.data["time"]["step"]
    column = _started(drawn, run)
    column.passed.append(column.largest_step())
    off, mean = 0.0, 0.0
    for frame in range(run.t.size):
        if not _on_step(run.t[frame], step):
            continue
        _march_to(column, step, round(run.t[frame] / step))
        gap_R, gap_h = run.R[frame] - column.R, run.h[frame] - column.h
        off = max(off, _largest(gap_R), _largest(gap_h))
        mean = max(mean, float(np.mean(np.abs(gap_R))))
    if drawn.options["dry"] == "some":
        growth = max(scale / float(run.R[0].max()), 1.0)
        found["dry"] = Found(mean / drawn.data["automaton"]["dry"], DRY * growth)
    else:
        found["rule"] = Found(off / scale, ROUNDING)
    _march_to(column, step, _whole_steps(drawn))
    beyond = longest_run(not step <= largest * (1 + 1e-9) for largest in column.passed)
    return found | {"unstable": Found(beyond, LOOKS)}


def _march_to(column: plain_automaton.Column, step: float, steps: int) -> None:
    """So many steps since the start; the bound is noted at the start and after each."""
    plain_automaton.march(column, step, steps - (len(column.passed) - 1), watch=True)


def _started(drawn: Drawn, run: Run) -> plain_automaton.Column:
    """The plain automaton from the run's own start, which is judged by itself."""
    column = drawn.column()
    column.h, column.R = run.h[0].tolist(), run.R[0].tolist()
    return column


def _against_mean_step(drawn: Drawn, run: Run) -> Found:
    """R at the end against the mean step and half of it, which differ by the error of first order.

    A step that follows its bounds may change by a small factor on the way, and its error with it.
    """
    ends = []
    for parts in (1, 2):
        column = _started(drawn, run)
        plain_automaton.march(column, drawn.until / (run.steps * parts), run.steps * parts)
        ends.append(np.array(column.R))
    off = float(np.mean(np.abs(run.R[-1] - ends[0])))
    dry = drawn.data.get("automaton", {}).get("dry", 0.0)
    allowed = float(np.mean(np.abs(ends[1] - ends[0]))) + DRY * dry + 1e-12
    return Found(off / allowed, 1.0)


def _on_step(time: float, step: float) -> bool:
    return bool(abs(time / step - round(time / step)) < 1e-6)


def longest_run(flags: Any) -> int:
    longest = current = 0
    for flag in flags:
        current = current + 1 if flag else 0
        longest = max(longest, current)
    return longest


def of_frames(drawn: Drawn, path: Path, automaton: Run) -> dict[str, Found]:
    """Runs with fewer and more frames pass through the same layers, by the same steps."""
    off, steps = 0.0, 0
    for frames in {2, 2 * drawn.frames - 1} - {drawn.frames}:
        other, refusal = run(path, "ca", frames)
        assert other is not None, refusal
        few, many = sorted((automaton, other), key=lambda run: run.t.size)
        every = (many.t.size - 1) // (few.t.size - 1)
        for layer in ("h", "R"):
            gap = getattr(few, layer) - getattr(many, layer)[::every]
            off = max(off, _largest(gap) / float(automaton.R.max()))
        steps = max(steps, abs(few.steps - many.steps))
    return {"frames": Found(off, 0.0), "steps": Found(steps, 0.0)}


def _of_frames_of_bcre(drawn: Drawn, path: Path, bcre: Run) -> dict[str, Found]:
    if drawn.frames == 2 or drawn.options["model"] == "both":
        return {}
    few, refusal = run(path, "pde", 2)
    assert few is not None, refusal
    x = drawn.d * (np.arange(drawn.cells) + 0.5)
    gap = float(np.mean(np.abs(sampled(few, x) - sampled(bcre, x))))
    scale = float(bcre.R.max())
    allowed = sum(stated(run, "error_estimate") or 0.0 for run in (few, bcre)) / scale + 1e-6
    return {"BCRE frames": Found(gap / scale, allowed)}


def stated(run: Run, name: str) -> float | None:
    """The mean error that a run states of itself, a length; None where it knows none."""
    layer = float(np.abs(run.R).mean())
    share = run.facts.get(name)
    return None if share is None else share * layer


def sampled(run: Run, x: Array) -> Array:
    """R of the last frame at positions x."""
    periodic = run.scene.domain.ends == "periodic"
    length = run.scene.domain.length
    history = plain_bcre.History(
        run.x, run.t[-1:], run.h[-1:], run.R[-1:], run.outflow, length, periodic
    )
    return history.at(x)[1][0]


def _of_bcre(drawn: Drawn, run: Run) -> dict[str, Found]:
    """BCRE's layers at the recorded times, allowed the error that it states of itself."""
    u, R, u_off, R_off = plain_solution(drawn, run.t[1:], run.x)
    h = u - drawn.sand.Sc * run.x
    scale = float(run.R.max())
    floor = 1e-6 * scale + (TABLE * scale if drawn.data["rolling"][0]["kind"] == "table" else 0.0)
    errors = {"R": stated(run, "error_estimate"), "h": stated(run, "error_estimate_h")}
    found = {}
    for name, gap, off in (("R", run.R[1:] - R, R_off), ("h", run.h[1:] - h, u_off)):
        error = math.inf if errors[name] is None else errors[name]
        allowed = error + float(np.mean(off)) + floor
        found[f"BCRE {name}"] = Found(float(np.mean(np.abs(gap))) / scale, allowed / scale)
    return found


def plain_solution(
    drawn: Drawn, times: Array, x: Array, cells: int | None = None
) -> tuple[Array, Array, Array, Array]:
    """u and R of BCRE at the times and places, and how far two grids are apart there."""
    sand, length = drawn.sand, drawn.length
    foot = exact_sand.values(drawn.data, np.array([length]))[0][0] + sand.Sc * length
    start = [0.0, *times]

    def volumes(n: int) -> plain_bcre.History:
        h, R = exact_sand.averages(drawn.data, n)
        places = (np.arange(n) + 0.5) * length / n
        return plain_bcre.finite_volumes(
            sand, h + sand.Sc * places, R, foot, length, start, drawn.periodic
        )

    def waves(n: int) -> plain_bcre.History:
        places = (np.arange(n) + 0.5) * length / n
        h, R = exact_sand.values(drawn.data, places)
        return plain_bcre.fourier(sand, h + sand.Sc * places, R, length, start)

    if drawn.periodic:
        u, R, u_off, R_off = plain_bcre.by_two_grids(waves, 128, x)
        if max(_largest(R_off), _largest(u_off)) < 1e-5 * _largest(R):
            return u[1:], R[1:], u_off[1:], R_off[1:]
    u, R, u_off, R_off = plain_bcre.by_two_grids(volumes, cells or max(4 * drawn.cells, 180), x)
    return u[1:], R[1:], u_off[1:], R_off[1:]


def _mass_error(run: Run) -> float:
    """Largest imbalance of any frame, relative to all the sand that a frame adds up."""
    mass = run.mass() + run.outflow
    scale = run.d * float(np.sum(np.abs(run.h[0]) + run.R[0]))
    return float(np.max(np.abs(mass - mass[0]))) / scale


def _largest(values: Array) -> float:
    return float(np.max(np.abs(values)))
