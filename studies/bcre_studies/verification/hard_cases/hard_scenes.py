"""Scenes that are hard on a model: too steep, too thin, too thick, at a limit of the equations."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

import bcre_pde
from bcre_pde import Ends, exact, simple_wave
from bcre_studies.models.bcre import problem_of
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.scene import Scene, load

Profile = Callable[[Array], Array]


@dataclass(frozen=True)
class HardScene:
    """An initial value problem, the automaton's cells, and what is hard in it.

    ``steps`` are those that the automaton takes, "auto" and fixed ones; the length of a cell is
    ``problem.length / cells``. The PDE stands on the same cells.
    """

    name: str
    problem: bcre_pde.Problem
    cells: int
    until: float
    steps: tuple[float | str, ...] = ("auto",)

    @property
    def d(self) -> float:
        return self.problem.length / self.cells

    def centres(self) -> Array:
        return np.asarray((np.arange(self.cells) + 0.5) * self.d)


@dataclass(frozen=True)
class Sand:
    """A pulse of ``amplitude`` at ``centre`` on an incline ``excess`` above repose, d = 1."""

    v: float = 0.5
    D: float = 0.1
    gamma: float = 0.05
    kappa: float = 0.0
    Sc: float = 0.5
    excess: float = -0.1
    surface: Profile = field(default=np.zeros_like)
    layer: Profile = field(default=lambda x: np.exp(-(((x - 30) / 4) ** 2)))
    length: float = 100.0
    ends: Ends = "open"

    def problem(self) -> bcre_pde.Problem:
        material = bcre_pde.Material(self.v, self.D, self.gamma, self.Sc, self.kappa)

        def initial(x: Array) -> tuple[Array, Array]:
            h = (self.Sc + self.excess) * (self.length - x) + self.surface(x)
            return h, self.layer(x)

        return bcre_pde.Problem(initial, material, self.length, self.ends)


def _of_scene(name: str, scene: Scene, *steps: float | str) -> HardScene:
    return HardScene(name, problem_of(scene), scene.domain.cells, scene.time.until, steps)


def _one_wet_cell(thickness: float) -> Profile:
    """The 31st cell of length 1."""
    return lambda x: np.where(np.floor(x) == 30, thickness, 0.0)


def _cliff(x: Array) -> Array:
    return np.where(x < 50, 100.0, 0.0)


def _rough(x: Array) -> Array:
    return np.asarray(np.sin(2 * np.pi * x / 10))


def _long() -> Sand:
    return Sand(
        excess=0.0,
        surface=lambda x: 0.1 * np.sin(2 * np.pi * x / 16),
        layer=lambda x: 1 + 0.5 * np.cos(2 * np.pi * x / 16),
        length=16.0,
        ends="periodic",
    )


LONG, LONG_STEPS, LONG_DT = "10^7 steps", 10_000_000, 0.5


def _limits() -> dict[str, Sand]:
    sand = Sand(excess=0.2)
    absent = {
        "D = 0": replace(sand, D=0.0),
        "gamma = 0": replace(sand, gamma=0.0),
        "v = 0": replace(sand, v=0.0),
        "v = D = gamma = 0": replace(sand, v=0.0, D=0.0, gamma=0.0),
    }
    peclet = {
        f"v d/D = {number:.0e}": replace(sand, v=1.0, D=1.0 / number)
        for number in (1e-3, 1e-1, 1e1, 1e3, 1e6)
    }
    return absent | peclet


def scenes() -> dict[str, HardScene]:
    """All of them, by name."""
    figure1 = load("figure1")
    found = [
        _of_scene("v = 2.5, d = 1, dt = 1", load("figure2"), "auto", 1.0),
        _of_scene("figure 1, dt = 1", figure1.with_changes(until=800.0), "auto", 1.0),
    ]
    uphill = Sand(excess=-0.5)
    sands = {
        "cliff of 100 d": Sand(excess=0.0, surface=_cliff),
        "one wet cell of 1e-300": Sand(excess=0.3, layer=_one_wet_cell(1e-300)),
        "one wet cell of 1e6": Sand(excess=0.3, layer=_one_wet_cell(1e6)),
        "slope Sc (1 + 1e-12)": Sand(excess=0.5e-12),
        "slope Sc (1 - 1e-12)": Sand(excess=-0.5e-12),
        "valley, S = 0.8 and -0.8": replace(uphill, surface=_level(0.8)),
        "hill, S = -0.8 and 0.8": replace(uphill, surface=_level(-0.8)),
        "kappa = 10": Sand(kappa=10.0, excess=0.0, surface=_rough, length=60.0),
    }
    for name, sand in (sands | _limits()).items():
        until = {"one wet cell of 1e6": 5.0, "v d/D = 1e-03": 2.0, "kappa = 10": 5.0}
        cells = round(sand.length)
        found.append(HardScene(name, sand.problem(), cells, until.get(name, 60.0)))
    short = Sand(layer=np.ones_like, excess=0.2)
    found += [
        HardScene("1 cell", replace(short, length=1.0).problem(), 1, 10.0),
        HardScene("2 cells", replace(short, length=2.0).problem(), 2, 10.0),
        _steepening(),
    ]
    return {scene.name: scene for scene in found}


def long_run() -> HardScene:
    """A small pile on which ten million steps take a second."""
    return HardScene(LONG, _long().problem(), 16, LONG_STEPS * LONG_DT, (LONG_DT,))


def _level(height: float) -> Profile:
    """Slopes of -+ height about the middle, on an incline of none."""
    return lambda x: height * np.abs(x - 50)


def _steepening() -> HardScene:
    """The exact climbing wave, to twice the time at which it becomes vertical."""
    gamma, height, width = 0.5, 0.3, 1.5
    breaking = simple_wave.breaking_time(gamma * height / width * math.sqrt(2 / math.e))
    wave = exact.climbing_hump(1.0, gamma, height, width, 20.0, breaking)
    return HardScene("climbing wave to twice its shock time", wave.problem, 400, 2 * breaking)
