"""Running the automaton on a plane: so many steps, or to chosen times under the bounds."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bcre_ca.gate import ascending, numbers_of, whole
from bcre_ca.plane.layers import Sand
from bcre_ca.plane.run import BLOCK, Run
from bcre_ca.plane.setting import Plane
from bcre_ca.plane.sources import clock_of
from bcre_ca.rule import ROUNDING
from bcre_ca.unstable import UnstableStep

Array = NDArray[np.float64]

MARGIN = 0.8
"""Part of the bound that a followed step takes, so that a block of growth seldom passes it."""

MOST_HALVINGS = 60

SAME_TIME = 1e-9
"""Part of a step by which a time may miss its end and still be that."""


def evolve(
    h: ArrayLike, R: ArrayLike, plane: Plane, steps: int, threads: int | None = None
) -> tuple[Array, Array]:
    """The layers after exactly ``steps`` steps of ``plane.rule.dt``, as new arrays.

    Parameters
    ----------
    h, R: static and rolling layer, lengths, shape (N, M), both in double or in single precision.
    plane: what they lie on.
    steps: number of steps, >= 0.
    threads: how many processors share a step; left out, all of them where that pays.

    Raises
    ------
    UnstableStep
        where dt cannot be stable for this start, naming a cell; FloatingPointError where the layers
        outgrow it; ValueError for layers that are not what is asked for, naming the layer.
    """
    left = whole("steps", steps)
    run = Run(Sand(numbers_of("h", h), numbers_of("R", R)), plane, threads)
    run.require_stable(plane.rule.dt)
    while left > 0:
        part = left if run.is_at_rest else min(BLOCK, left)
        run.take(part)
        _require_outlasted(run, plane.rule.dt)
        left -= part
    return run.h.copy(), run.R.copy()


def advance(sand: Sand, plane: Plane, steps: int, threads: int | None = None) -> Sand:
    """The sand after ``steps`` steps of ``plane.rule.dt``, whatever their stability.

    Raises
    ------
    FloatingPointError
        where the layers are no longer finite, naming a cell.
    """
    steps = whole("steps", steps)
    run = Run(sand, plane, threads)
    run.take(steps)
    end = run.sand()
    finite = np.isfinite(end.h) & np.isfinite(end.R)
    if not finite.all():
        i, j = np.unravel_index(int(np.argmin(finite)), finite.shape)
        raise FloatingPointError(
            f"the layers are no longer finite at t = {end.t:.6g}, in cell ({i}, {j})"
        )
    return end


def frames(
    sand: Sand,
    plane: Plane,
    times: Sequence[float],
    step: float | Literal["auto"] = "auto",
    threads: int | None = None,
) -> Iterator[Sand]:
    """The sand at each of the ascending ``times``.

    ``"auto"`` takes :data:`MARGIN` of the largest stable step and looks again after every
    :data:`BLOCK` steps; a block at whose end the bound has been passed is thrown away and taken
    in smaller steps. A number is taken as it is. The steps do not depend on the times: between
    two steps the layers are interpolated, which keeps mass, R >= 0 and h >= base.

    Raises
    ------
    UnstableStep
        for a fixed step that cannot be stable at the start, naming a cell.
    FloatingPointError
        for a fixed step that the avalanche outgrew, naming time, cell and bound.
    """
    run = Run(sand, plane, threads)
    wanted = ascending(times, sand.t)
    if isinstance(step, str) and step == "auto":
        return _followed(run, wanted)
    fixed = plane.rule.with_step(step).dt
    run.require_stable(fixed)
    return _fixed(run, wanted, fixed)


def _fixed(run: Run, times: list[float], dt: float) -> Iterator[Sand]:
    while times:
        found = _block(run, times, dt, is_whole=False)
        _require_outlasted(run, dt)
        yield from found
        times = times[len(found) :]


def _followed(run: Run, times: list[float]) -> Iterator[Sand]:
    former = 0.0
    while times:
        bound = run.largest_stable_step()
        wanted = dt = MARGIN * bound if math.isfinite(bound) else run.plane.rule.dt
        run.note(wanted, former)
        start = run.save()
        for _ in range(MOST_HALVINGS):
            found = _block(run, times, dt, is_whole=True)
            if dt <= run.largest_stable_step() * (1 + ROUNDING):
                break
            run.go_back(start)
            dt = dt / 2
        else:
            raise FloatingPointError(
                f"no step is short enough at t = {run.t:.6g}: the layers outgrow every bound"
            )
        former = wanted
        yield from found
        times = times[len(found) :]


def _block(run: Run, times: list[float], dt: float, is_whole: bool) -> list[Sand]:
    """Take a block of steps and return the sand at those of the times that fall into it.

    A block that need not be whole ends with the last of the times.
    """
    clock = clock_of(run.t, dt, BLOCK)
    found: list[Sand] = []
    done, before, after = 0, None, None
    for time in times:
        step = int(np.searchsorted(clock, time - SAME_TIME * dt))
        if step > BLOCK:
            break
        is_end = clock[step] <= time + SAME_TIME * dt
        first = step if is_end else step - 1
        if before is None or done <= first:
            run.take(first - done, dt)
            done, before, after = first, run.sand(), None
        if not is_end and after is None:
            run.take(1, dt)
            done, after = first + 1, run.sand()
        found.append(_between(before, after, 0.0 if is_end else time - clock[first], dt, time))
    if is_whole or len(found) < len(times):
        run.take(BLOCK - done, dt)
    return found


def _between(before: Sand, after: Sand | None, since: float, dt: float, time: float) -> Sand:
    """Linear between two steps, and in no cell beyond either."""
    if after is None or since == 0:
        return replace(before, t=time)
    part = since / dt

    def mixed(a: Array, b: Array) -> Array:
        return np.clip((1 - part) * a + part * b, np.minimum(a, b), np.maximum(a, b))

    return replace(
        after,
        h=mixed(before.h, after.h),
        R=mixed(before.R, after.R),
        t=time,
        inflow=(1 - part) * before.inflow + part * after.inflow,
        outflow=(1 - part) * before.outflow + part * after.outflow,
    )


def _require_outlasted(run: Run, dt: float) -> None:
    try:
        run.require_stable(dt)
    except UnstableStep as outgrown:
        raise FloatingPointError(
            f"the avalanche has outgrown the step by t = {run.t:.6g}: {outgrown}"
        ) from None
