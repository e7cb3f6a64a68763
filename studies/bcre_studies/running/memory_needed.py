"""How much memory a run will take, so that it can be refused before it takes it.

A run of T frames holds, for every frame and cell, both layers and a row of the table that becomes
``profiles.csv`` (whose text is written as it is made); BCRE holds three or more grids besides, and
what its solver works with. The bytes below were measured as growth of the peak resident size.
"""

from __future__ import annotations

from typing import Literal

from bcre_studies.scenes.scene import Scene

FRAME = {"ca": 80, "pde": 140}
"""Bytes a frame and cell: h, R and their table; for BCRE with the coarser grids."""

WORK = {"runge-kutta": 200, "RK45": 800, "DOP853": 1300, "LSODA": 800, "BDF": 7500}
"""Bytes a cell that the solver works with; LSODA has a full Jacobian besides."""

NOISE = 800
"""Bytes a cell while 32 sines are added up to a rough surface."""


def estimate(scene: Scene, model: Literal["ca", "pde", "both"], frames: int, finest: int) -> int:
    """Bytes that ``bcre run`` will take beyond its libraries, to within a factor of two.

    Parameters
    ----------
    finest: cells of the PDE's finest grid.
    """
    noise = NOISE * any(term.kind == "noise" for term in scene.surface)
    total = 0
    if model in ("ca", "both"):
        total += scene.domain.cells * (frames * FRAME["ca"] + noise)
    if model in ("pde", "both"):
        total += finest * (frames * FRAME["pde"] + noise + WORK[scene.solver.method])
        if scene.solver.method == "LSODA":
            total += 8 * (3 * finest) ** 2
    return total
