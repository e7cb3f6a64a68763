r"""How steep a slope must be for a pulse of finite size to run to its top.

In units of D/v, D/v^2 and v/gamma, BCRE has no group but the pulse's own: its thickness
a = gamma A/v, its width w v/D and its distance to the foot. The slope is told by
s = (S - Sc)/(Sd - Sc) with BCRE's second critical slope, gamma (Sd - Sc) = v^2/(4 D). The
automaton has Pe = v d/D besides.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from bcre_studies.models.registry import AUTOMATON, BCRE, MODELS
from bcre_studies.observables.outcome import decided, reached_the_top
from bcre_studies.scenes.scene import Scene
from bcre_studies.sweeps.parallel import each

WIDTH = 3.0
LENGTH = 60.0
TO_FOOT = 15.0
UNTIL = 3000.0
"""w v/D, L v/D, the distance to the foot in D/v, and the time in D/v^2."""

THICKNESSES = (1e-7, 1e-2, 0.1, 1.0)
PECLETS = (0.25, 0.5, 1.0, 1.5, 2.0)
GRIDS = (60, 120)
"""BCRE's cells; what changes from one to the other is the error of a threshold. At other places
both models have cells of D/v."""

OTHER_PLACES = ((2 * LENGTH, TO_FOOT), (LENGTH, 8.0), (LENGTH, 30.0))
"""Length and distance to the foot, besides the usual ones."""

LOOKS = (0.0, *np.geomspace(10.0, UNTIL, 30).tolist())
"""Times at which a run is asked whether it has been decided."""

GENTLEST, STEEPEST = 0.1, 1.3
HALVINGS = 8
HALF_WIDTH = (STEEPEST - GENTLEST) / 2 ** (HALVINGS + 1)
"""How far a threshold may lie from the middle of the last interval."""


@dataclass(frozen=True)
class Setting:
    """A pulse on a slope whose steepness is sought.

    Parameters
    ----------
    model: a name of the registry, the automaton or BCRE.
    cells: d of the automaton as cells on :data:`LENGTH`, or BCRE's own grid.
    thickness: a = gamma A/v.
    length, to_foot: in D/v.
    """

    model: str
    cells: int
    thickness: float
    length: float = LENGTH
    to_foot: float = TO_FOOT

    @property
    def peclet(self) -> float:
        """v d/D of the automaton, or of BCRE's grid."""
        return self.length / self.cells


def threshold(setting: Setting) -> float:
    """s above which the pulse runs to the top, to within :data:`HALF_WIDTH`."""
    low, high = GENTLEST, STEEPEST
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        if runs_to_the_top(setting, middle):
            high = middle
        else:
            low = middle
    return (low + high) / 2


def runs_to_the_top(setting: Setting, s: float) -> bool:
    """Whether it has by the end, on a slope of s."""
    scene = Scene.model_validate(
        {
            "title": "A pulse near the foot",
            "material": {"v": 1.0, "D": 1.0, "gamma": 1.0, "Sc": 0.0},
            "domain": {"length": setting.length, "cells": setting.cells, "ends": "open"},
            "time": {"until": UNTIL},
            "surface": [{"kind": "incline", "slope": s / 4}],
            "rolling": [
                {
                    "kind": "gaussian",
                    "amplitude": setting.thickness,
                    "centre": setting.length - setting.to_foot,
                    "width": WIDTH,
                }
            ],
        }
    )
    run = MODELS[setting.model].run(scene, LOOKS, setting.cells, decided)
    return reached_the_top(run.x, run.u[0], run.u[-1])


def settings(peclets: Sequence[float], grids: Sequence[int]) -> list[Setting]:
    """All pulses whose thresholds are sought, BCRE's first, as they take longest.

    Parameters
    ----------
    peclets: of the automaton; they must divide :data:`LENGTH` into whole cells.
    grids: two numbers of BCRE's cells.
    """
    wanted = [
        Setting(BCRE.name, cells, thickness)
        for thickness in THICKNESSES[1:]
        for cells in sorted(grids, reverse=True)
    ]
    wanted += [
        Setting(AUTOMATON.name, round(LENGTH / peclet), thickness)
        for thickness in THICKNESSES
        for peclet in peclets
    ]
    wanted += [
        Setting(model, round(length), thickness, length, to_foot)
        for model in (BCRE.name, AUTOMATON.name)
        for thickness in THICKNESSES[1:]
        for length, to_foot in OTHER_PLACES
    ]
    return wanted


def thresholds_of(wanted: Sequence[Setting]) -> pd.DataFrame:
    """The slopes at which these pulses begin to run to the top, a row each."""
    found = each(threshold, wanted, "agreement_map: slopes")
    return pd.DataFrame(
        [
            {
                "model": setting.model,
                "peclet": setting.peclet,
                "thickness": setting.thickness,
                "length": setting.length,
                "to_foot": setting.to_foot,
                "s": round(s, 4),
            }
            for setting, s in zip(wanted, found, strict=True)
        ]
    )
