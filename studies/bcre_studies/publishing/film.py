"""Frames of every built-in scene in both models, for the page's player.

The automaton runs as the scene says. BCRE, as it stands and with the automaton's own D_eff and
kappa_eff, is solved on cells four and two times smaller; the finer solution is averaged over the
automaton's cells, and the change from the coarser one is shown as BCRE's own error.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from bcre_studies.comparison.rounding import significant
from bcre_studies.models.bcre import SHARE
from bcre_studies.models.registry import AUTOMATON, BCRE, EFFECTIVE, Model
from bcre_studies.models.run import frame_times
from bcre_studies.reporting.page.packing import pack
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.listing import studied_names
from bcre_studies.scenes.scene import load
from bcre_studies.sweeps.parallel import each

FRAMES = 81
FINER = 4
"""BCRE's cells in one of the automaton's; half as many for the estimate of its error."""
WIDEST = 200
"""Cells shown; a scene on more is averaged to at most so many."""
DIGITS = 2


def films() -> list[dict[str, Any]]:
    """One film a built-in scene, in the order of their names; see :func:`film`."""
    return each(film, studied_names(), "scenes to watch")


def film(name: str) -> dict[str, Any]:
    """A scene as the page's script reads it.

    ``models`` holds, packed, u = h + Sc x at the start above its lowest point, how it changes, and
    R; ``difference``, ``left``
    and ``error`` are relative L1 differences of R by frame: automaton from BCRE, automaton from
    BCRE with D_eff and kappa_eff, and BCRE from itself on cells twice as long. None stands where
    there is nothing to divide by.
    """
    scene = load(name)
    times = frame_times(scene, FRAMES)
    automaton = AUTOMATON.run(scene, times)
    cells = automaton.x.size
    shown = cells if cells <= WIDEST else next(n for n in range(WIDEST, 0, -1) if cells % n == 0)

    def solved(model: Model, finer: int) -> tuple[Array, Array]:
        run = model.run(scene, times, finer * cells)
        return _averaged(run.h, shown), _averaged(run.R, shown)

    layers = {
        AUTOMATON.name: (_averaged(automaton.h, shown), _averaged(automaton.R, shown)),
        BCRE.name: solved(BCRE, FINER),
        EFFECTIVE.name: solved(EFFECTIVE, FINER),
    }
    coarser = solved(BCRE, FINER // 2)[1]
    R = {model: both[1] for model, both in layers.items()}
    difference = _differences(R[AUTOMATON.name], R[BCRE.name])
    error = _differences(coarser, R[BCRE.name])
    x = (np.arange(shown) + 0.5) * scene.domain.length / shown
    floor = min(float((h + scene.material.Sc * x).min()) for h, _ in layers.values())
    return {
        "name": name,
        "title": scene.title,
        "length": scene.domain.length,
        "cells": shown,
        "t": [significant(t, 5) for t in times],
        "models": {
            model: _packed(h + scene.material.Sc * x - floor, layer)
            for model, (h, layer) in layers.items()
        },
        "difference": difference,
        "left": _differences(R[AUTOMATON.name], R[EFFECTIVE.name]),
        "error": error,
        "unresolved": [
            own is not None and gap is not None and own > SHARE * max(gap, SHARE)
            for own, gap in zip(error, difference, strict=True)
        ],
    }


def _packed(u: Array, R: Array) -> dict[str, Any]:
    return {
        "start": pack(u[:1]),
        "change": pack(u - u[0], each=True),
        "R": pack(R, each=True),
        "ends": [significant(float(u.min()), 4), significant(float(u.max()), 4)],
    }


def _averaged(values: Array, cells: int) -> Array:
    """(T, N) averaged over ``cells`` larger cells, of which N is a multiple."""
    return np.asarray(values.reshape(values.shape[0], cells, -1).mean(axis=2))


def _differences(R: Array, reference: Array) -> list[float | None]:
    """Relative L1 difference in every frame, to two digits; None where nothing rolls any more."""
    least = 1e-6 * float(reference[0].mean())
    found: list[float | None] = []
    for row, other in zip(R, reference, strict=True):
        size = float(other.mean())
        gap = float(np.abs(row - other).mean())
        found.append(significant(gap / size, DIGITS) if size > least else None)
    return found
