r"""How much a rolling layer matters in a run: two small numbers, and the error without a layer.

    eps = v/(gamma Sc l)        tau = R/(Sc l)

l is the length on which the surface changes and R the thickest rolling layer. v/(gamma Sc) is the
distance in which a layer comes to rest on level ground, so eps is that distance over l; tau is the
sand that rolls over the sand that lies. A heap of height A = Sc l that is fed with Q at its top has
R = Q/v, hence tau = Q/(v A). Where both vanish a slope never leaves repose, and the surface follows
from an isotonic regression alone (``bcre_pde.line.prigozhin_zaltzman``).
"""

from __future__ import annotations

import math

import numpy as np

from bcre_studies.models.run import Run

CHANGED = 0.01
"""A part of the surface changes where it does so by this part of the most."""


def smallness(run: Run) -> tuple[float, float]:
    """eps and tau of a run that begins at t = 0; infinite where nothing moves or comes to rest."""
    material = run.scene.material
    change = np.abs(run.u - run.u[0]).max(axis=0)
    length = run.d * np.count_nonzero(change > CHANGED * change.max())
    height = material.Sc * length
    eps = material.v / (material.gamma * height) if material.gamma * height > 0 else math.inf
    return eps, float(run.R.max()) / height if height > 0 else math.inf


def surface_error(run: Run, reference: Run) -> float:
    """The largest mean distance of h at any recorded time, over the mean change at the end.

    Both runs have the same times, and the first is t = 0; infinite where the surface never changes.
    """
    frames = range(1, reference.t.size)
    gaps = [_mean(run.u[i] - reference.sample(run.x, "u", i)) for i in frames]
    change = _mean(reference.u[-1] - reference.u[0])
    return max(gaps) / change if change > 0 else math.inf


def _mean(values: np.ndarray) -> float:
    return float(np.mean(np.abs(values)))
