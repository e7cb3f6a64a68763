"""How far a run is from another of the same scene, in what a user wants of it.

* ``R``: relative L1 difference of R at the end, at the centres of the run's own cells.
* ``h``: that of what h has changed by since the start.
* ``slope``, ``roughness``, ``front``, ``eroded``, ``reach``, ``top``: see
  ``observables``, each over a scale that says what there is to see of it.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

import numpy as np

import bcre_pde
from bcre_studies.models.run import Run
from bcre_studies.observables import named as observables
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.scene import Scene

OBSERVABLES = ("R", "h", *(name for name in observables.NAMES if name != "R"))


def posed(scene: Scene) -> tuple[str, ...]:
    """Those of :data:`OBSERVABLES` that a scene poses; some need a slope with two ends."""
    asked = {"h", *observables.posed(scene)}
    return tuple(name for name in OBSERVABLES if name in asked)


def deviation(run: Run, reference: Run, observable: str = "R") -> float:
    """The error of ``run`` against ``reference``, dimensionless; both start at t = 0.

    Infinite where there is nothing that it could be relative to.

    Parameters
    ----------
    observable: one of :data:`OBSERVABLES`.
    """
    if observable not in ("R", "h"):
        return observables.change(observable, reference, run)
    profile = _rolling if observable == "R" else _change
    scale = float(np.mean(np.abs(profile(reference, reference.x))))
    gap = float(np.mean(np.abs(profile(run, run.x) - profile(reference, run.x))))
    if gap == 0:
        return 0.0
    return gap / scale if scale > 0 and math.isfinite(gap) else math.inf


def uncertainty(runs: Sequence[Run], observable: str = "R") -> float:
    """Error of the finest of BCRE's runs, by :func:`bcre_pde.error_of_finest`.

    Of the deviations between them, so in their unit; infinite where one of them is.

    Parameters
    ----------
    runs: at least three, each on twice the cells of the one before.
    """
    pairs = itertools.pairwise(runs[-bcre_pde.LEAST_GRIDS :])
    changed = [deviation(coarse, fine, observable) for coarse, fine in pairs]
    if not all(map(math.isfinite, changed)):
        return math.inf
    return bcre_pde.error_of_finest(changed, jump=bcre_pde.jump_stands(*runs[-2:])).error


def _rolling(run: Run, x: Array) -> Array:
    return run.sample(x)


def _change(run: Run, x: Array) -> Array:
    return run.sample(x, "u") - run.sample(x, "u", frame=0)
