"""A run on a plane: layers kept where compiled code can step them, and looked at without a copy."""

from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from bcre_ca.gate import require_kind, whole
from bcre_ca.plane import kernels
from bcre_ca.plane.bounds import largest_step_of, refusal
from bcre_ca.plane.coefficients import Coefficients
from bcre_ca.plane.kernels.march import BEGIN, END, SLAB, WEDGE, WHOLE
from bcre_ca.plane.kernels.storage import COLUMNS, ROWS, inside, stored
from bcre_ca.plane.kernels.work import work_on
from bcre_ca.plane.layers import Sand, checked
from bcre_ca.plane.setting import Plane
from bcre_ca.plane.sources import cells_of, clock_of, poured
from bcre_ca.rule import ROUNDING

Array = NDArray[np.float64]

BLOCK = 32
"""Steps between two looks at the bounds."""

AT_ONCE = 200_000_000
"""Cell-steps between two looks at the keyboard: compiled code cannot be interrupted."""

SHARED_FROM = 100_000
"""Wet cells from which several threads pay."""

_POOL = ThreadPoolExecutor(numba.get_num_threads())


class Start(NamedTuple):
    """What :meth:`Run.go_back` needs: the cells that a block can change, and the accounts."""

    box: tuple[slice, slice]
    h: Array
    R: Array
    wet: NDArray[np.int64]
    sums: Array
    t: float
    poured: float
    steps: int


class Run:
    """Sand on a plane that steps on in place.

    Parameters
    ----------
    sand: where it begins; not changed.
    plane: what it lies on.
    threads: how many processors share a step; left out, all of them where that pays.
    """

    def __init__(self, sand: Sand, plane: Plane, threads: int | None = None) -> None:
        require_kind("sand", sand, Sand)
        h, R = checked(sand.h, sand.R, plane)
        self.plane, self.t = plane, sand.t
        self._sand, self._poured, self._steps = sand, 0.0, 0
        self._lowered = self._raised = self._redone = 0
        self._field = stored(h, R, plane)
        free = plane.free(h.shape)
        self._cells = cells_of(plane.sources, free, plane.rule.d, plane.sides == "periodic")
        form = kernels.FORMS[plane.flow]
        if threads is None:
            threads = numba.get_num_threads() if h.size >= SHARED_FROM else 1
        threads = whole("threads", threads, least=1)
        if plane.ends == "periodic":
            threads, form = 1, form._replace(together=1)
        self._threads, self._work = threads, work_on(self._field, form, threads)

    @property
    def h(self) -> Array:
        """The static layer as it is now; it changes with every step."""
        return inside(self._field.h, self._field)

    @property
    def R(self) -> Array:
        """The rolling layer as it is now; it changes with every step."""
        return inside(self._field.R, self._field)

    @property
    def is_at_rest(self) -> bool:
        """Whether nothing rolls and nothing will be poured."""
        return not (self.plane.sources or (self._work.wet[0] < self._work.wet[1]).any())

    def sand(self) -> Sand:
        """A copy of the state."""
        area, first = self.plane.rule.d**2, self._sand
        return Sand(
            h=self.h.copy(),
            R=self.R.copy(),
            t=self.t,
            inflow=first.inflow + self._poured * area,
            outflow=first.outflow + math.fsum(self._work.sums[:, 0]) * area,
            steps=first.steps + self._steps,
            lowered=first.lowered + self._lowered,
            raised=first.raised + self._raised,
            redone=first.redone + self._redone,
        )

    def take(self, steps: int, dt: float | None = None) -> None:
        """Take so many steps of ``plane.rule.dt``, or of another dt, whatever their stability."""
        dt = self.plane.rule.dt if dt is None else dt
        self._steps += steps
        if self.is_at_rest:
            self.t += steps * dt
            return
        dtype = self._field.h.dtype
        K = self.plane.coefficients(dtype, dt)
        number = np.bincount(self._cells.source, minlength=len(self._cells.height))
        part = max(AT_ONCE // self._field.h.size, BLOCK)
        for done in range(0, steps, part):
            clock = clock_of(self.t, dt, min(part, steps - done))
            heights = poured(self.plane.sources, self._cells, clock).astype(dtype)
            self._advance(K, heights)
            self.t = float(clock[-1])
            self._poured += float(heights.sum(0, dtype=float) @ number)

    def largest_stable_step(self) -> float:
        """Largest stable dt for all cells that the next block can read; NaN if not finite."""
        K = self.plane.coefficients(self._field.h.dtype)
        found = kernels.extremes(self._field, K, self._cells, BLOCK, self._work)
        return largest_step_of(self.plane, *found)

    def require_stable(self, dt: float) -> None:
        """Raise :class:`bcre_ca.UnstableStep` where dt cannot be stable now."""
        largest = self.largest_stable_step()
        if not dt <= largest * (1 + ROUNDING):
            column = np.arange(self._field.M)
            read = (column >= self._work.windows[0][:, None]) & (
                column < self._work.windows[1][:, None]
            )
            raise refusal(dt, largest, self.h, self.R, read, self.plane)

    def note(self, wanted: float, former: float) -> None:
        """Count a step that follows its bounds and became shorter or longer than the former one."""
        self._lowered += wanted < former * (1 - 1e-9)
        self._raised += 0 < former * (1 + 1e-9) < wanted

    def save(self) -> Start:
        """What a block of steps from here can change; :meth:`largest_stable_step` comes first."""
        lo, hi = self._work.windows
        rows = np.flatnonzero(lo < hi)
        box = (slice(0, 0), slice(0, 0))
        if rows.size:
            first, last = lo[rows].min() + COLUMNS - 1, hi[rows].max() + COLUMNS + 1
            box = (slice(rows[0] + ROWS - 1, rows[-1] + ROWS + 2), slice(first, last))
        h, R = self._field.h[box].copy(), self._field.R[box].copy()
        accounts = (
            self._work.wet.copy(),
            self._work.sums.copy(),
            self.t,
            self._poured,
            self._steps,
        )
        return Start(box, h, R, *accounts)

    def go_back(self, start: Start) -> None:
        """Take a block back."""
        self._field.h[start.box], self._field.R[start.box] = start.h, start.R
        self._work.wet[:], self._work.sums[:] = start.wet, start.sums
        self.t, self._poured, self._steps = start.t, start.poured, start.steps
        self._redone += 1

    def _advance(self, K: Coefficients, heights: Array) -> None:
        if self._threads == 1:
            self._call(WHOLE, 0, K, heights)
            return
        for done in range(0, len(heights), BLOCK):
            first, after = self._work.wet
            is_shared = np.maximum(after - first, 0).sum() >= SHARED_FROM
            advance = self._advance_in_threads if is_shared else partial(self._call, WHOLE, 0)
            advance(K, heights[done : done + BLOCK])

    def _advance_in_threads(self, K: Coefficients, heights: Array) -> None:
        for done in range(0, len(heights), self._work.together):
            some = heights[done : done + self._work.together]
            slabs = self._call(BEGIN, 0, K, some)
            self._share(SLAB, slabs, K, some)
            self._share(WEDGE, slabs - 1, K, some)
            self._call(END, 0, K, some)

    def _share(self, part: int, number: int, K: Coefficients, heights: Array) -> None:
        """Do a part of the steps so many times, all but the first in other threads."""
        others = [_POOL.submit(self._call, part, s, K, heights) for s in range(1, number)]
        if number > 0:
            self._call(part, 0, K, heights)
        for other in others:
            other.result()

    def _call(self, part: int, s: int, K: Coefficients, heights: Array) -> int:
        return int(kernels.take_steps(part, s, self._field, K, self._cells, heights, self._work))
