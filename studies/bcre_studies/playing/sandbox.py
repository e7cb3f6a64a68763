"""A scene that runs on, while its material is changed and sand is poured on it."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace

from bcre_ca.plane import BLOCK, MARGIN, Run, Sand, Source
from bcre_ca.rule import ROUNDING
from bcre_studies.models.plane.automaton import plane_of
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.plane.scene import PlaneScene

LASTS = 20.0
"""Seconds in which a scene would play at :data:`FRAMES` a second."""

FRAMES = 60

MOST_SECONDS = 0.1
"""Of a frame: what was not reached by then is left to the next one, and time runs slower."""

MOST_HALVINGS = 60

POURED_WIDTH = 1 / 16
"""Diameter of what the pointer pours, a part of the shorter side; two cells at the least."""

POURED_HEIGHT = 0.2
"""What the pointer adds in a frame to each cell under it, in units of Sc d."""


@dataclass(frozen=True)
class Frame:
    """What a browser is shown of a moment; ``seconds`` is what the frame took to compute."""

    t: float
    h: Array
    R: Array
    seconds: float


class Sandbox:
    """The automaton on a scene, from frame to frame.

    Parameters
    ----------
    scene: its times only say how fast the sandbox plays; its step is that which its bounds allow.
    """

    def __init__(self, scene: PlaneScene) -> None:
        self.scene = scene
        h, R = scene.initial()
        self._first = h
        self._plane = plane_of(scene, h)
        self._pointer: Source | None = None
        Run(Sand(h, R + ~scene.walls()), self._plane).take(1, 0.0)  # compiles, before it is shown
        self._run = Run(Sand(h, R), self._plane)
        self.span = scene.time.until / (LASTS * FRAMES)

    def change(self, **material: float) -> None:
        """Go on with other values of v, D, gamma or Sc.

        Raises
        ------
        SceneError
            for a value that a scene may not have; then nothing changes.
        """
        self.scene = self.scene.with_changes(**material)
        self._plane = plane_of(self.scene, self._first)
        self._go_on()

    def pour(self, place: tuple[float, float] | None) -> None:
        """Let sand fall about (x, y) from now on; None stops it.

        A place without a cell that can hold sand takes none.
        """
        domain = self.scene.domain
        d = domain.d
        width = max(POURED_WIDTH * min(domain.length, domain.width), 2 * d)
        deepening = POURED_HEIGHT * max(self.scene.material.Sc, 0.1) * d / self.span
        before = self._pointer
        self._pointer = None
        if place is not None and all(map(math.isfinite, place)):
            self._pointer = Source(math.pi / 4 * width**2 * deepening, place, width)
        if self._pointer != before:
            self._go_on()

    def _go_on(self) -> None:
        """The same sand on the plane as it now is."""
        sand, sources = self._run.sand(), self._plane.sources
        if self._pointer is not None:
            try:
                plane = replace(self._plane, sources=(*sources, self._pointer))
                self._run = Run(sand, plane)
                return
            except ValueError:  # it holds no cell
                self._pointer = None
        self._run = Run(sand, self._plane)

    def frame(self) -> Frame:
        """Run on by :attr:`span`, as far as the time for a frame lasts."""
        began = time.perf_counter()
        end = self._run.t + self.span
        while end - self._run.t > 1e-9 * self.span:
            self._block(end)
            if time.perf_counter() - began > MOST_SECONDS:
                break
        seconds = time.perf_counter() - began
        return Frame(self._run.t, self._run.h.copy(), self._run.R.copy(), seconds)

    def _block(self, end: float) -> None:
        """Some steps under the bounds; taken back and halved where they pass them."""
        run = self._run
        left = end - run.t
        dt = min(MARGIN * run.largest_stable_step(), left)
        start = run.save()
        for _ in range(MOST_HALVINGS):
            run.take(min(BLOCK, max(round(left / dt), 1)), dt)
            if dt <= run.largest_stable_step() * (1 + ROUNDING):
                return
            run.go_back(start)
            dt = dt / 2
        raise FloatingPointError(f"no step is short enough at t = {run.t:.6g}")
