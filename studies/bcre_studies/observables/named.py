r"""What a person asks of a scene, each as one number (or profile) with a scale of its own.

The change of an observable is |q - q_full| over a scale that says what there is to see of it, so
that 1 % means the same for a slope, a place and an area:

    slope      S, least squares over the middle half      over Sc, the repose slope
    roughness  RMS of h about that line                   over its largest in the full model's run
    front      x of the downhill edge of R at each time   over the length of the slope
    eroded     d sum max(h(0) - h, 0)                     over d sum |h(0) - h| of the full model
    reach      how far uphill the surface changes         over the length of the slope
    top        whether the avalanche runs to the top      1: another word is a change of 100 %
    R          R(x, t)                                    over the mean of the full model's R

Where the full model leaves the surface as it was, a millionth of what was released stands for the
scale of roughness (of its largest layer) and of eroded (of its area): less counts as untouched.

A front, a reach and an arrival at the top belong to an avalanche on a slope with two ends: a scene
whose ends are joined does not pose them.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from bcre_studies.models.run import Run
from bcre_studies.observables.fronts import edge
from bcre_studies.observables.fronts import roughness as root_mean_square
from bcre_studies.observables.outcome import SPENT, reached_the_top
from bcre_studies.observables.outcome import slope as fitted_slope
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.scene import Scene

FRONT = 0.1
"""The front stands where R is this part of its largest at the time."""

CHANGED = 0.01
"""The surface counts as changed where it has changed by this part of the most."""

UNTOUCHED = 1e-6
"""A surface that has changed by this part of the largest layer released counts as untouched."""

NAMES = ("slope", "roughness", "front", "eroded", "reach", "top", "R")


def posed(scene: Scene) -> tuple[str, ...]:
    """The observables that the scene poses: without joined ends all of them."""
    if scene.domain.ends != "periodic":
        return NAMES
    return tuple(name for name in NAMES if name not in ("front", "reach", "top"))


def change(name: str, full: Run, other: Run) -> float:
    """Relative change of an observable; 1 where the other model has no rolling layer for it.

    Parameters
    ----------
    name: one of :data:`NAMES`.
    full, other: the same scene at the same times, on any cells.
    """
    if name in ("R", "front") and full.R.any() and not other.R.any():
        return 1.0
    if name == "R":
        return _relative_l1(full, other)
    if name == "front":
        gap = float(np.max(np.abs(front(full) - front(other))))
    else:
        gap = abs(MEASURES[name](full) - MEASURES[name](other))
    size = scale(name, full)
    if not math.isfinite(gap):
        return math.inf
    return gap / size if size > 0 else (0.0 if gap == 0 else math.inf)


@lru_cache(maxsize=32)
def scale(name: str, full: Run) -> float:
    """What a change of the observable is measured against; units are those of the observable."""
    if name == "slope":
        return full.scene.material.Sc
    if name == "roughness":
        largest = max(_roughness_of(full.x, h) for h in full.h)
        return max(largest, UNTOUCHED * float(_released(full).max()))
    if name in ("front", "reach"):
        return full.scene.domain.length
    if name == "eroded":
        moved = float(np.sum(np.abs(full.h[-1] - full.h[0])))
        return _cell(full) * max(moved, UNTOUCHED * float(_released(full).sum()))
    if name == "R":
        return float(np.mean(full.R))
    return 1.0


def slope(run: Run) -> float:
    """S = -dh/dx at the end, least squares over the middle half; dimensionless."""
    return fitted_slope(run.x, run.h[-1])


def roughness(run: Run) -> float:
    """Root mean square of h about its line, over the middle half, at the end; a length."""
    return _roughness_of(run.x, run.h[-1])


def front(run: Run) -> Array:
    """x of the downhill edge of the rolling layer at every time after the start, (T - 1,); lengths.

    There R is :data:`FRONT` of its largest at the time. Where it is so much in the last cell, or
    nothing is left of the layer (``outcome.SPENT``), the front is at the foot.
    """
    foot = run.scene.domain.length
    spent = SPENT * float(run.R[0].max())
    places = []
    for R in run.R[1:]:
        level = FRONT * float(R.max())
        gone = R[-1] >= level or level <= FRONT * spent
        places.append(foot if gone else -edge(-run.x[::-1], R[::-1], level))
    return np.array(places)


def eroded(run: Run) -> float:
    """d sum max(h(0) - h, 0): sand that the avalanche has taken from the surface; an area."""
    return _cell(run) * float(np.sum(np.maximum(run.h[0] - run.h[-1], 0.0)))


def reach(run: Run) -> float:
    """How far uphill of the pulse's centre the surface has changed at the end; a length.

    By :data:`CHANGED` of the most that it has changed anywhere; 0 where it is untouched. The centre
    is that of the rolling layer which the scene releases.
    """
    released = _released(run)
    changed = np.abs(run.h[-1] - run.h[0])
    if not changed.max() > UNTOUCHED * float(released.max()):
        return 0.0
    centre = float(released @ run.x / released.sum())
    level = max(CHANGED * float(changed.max()), UNTOUCHED * float(released.max()))
    return centre - (0.0 if changed[0] >= level else edge(run.x, changed, level))


def top(run: Run) -> float:
    """1 where the avalanche has run to the top by the end, else 0.

    See ``outcome.reached_the_top``. A slope no higher than repose but for rounding
    has nothing to bring down.
    """
    repose = run.scene.material.Sc * run.x
    start, end = run.h[0] + repose, run.h[-1] + repose
    if not start[0] - start[-1] > UNTOUCHED * float(_released(run).max()):
        return 0.0
    return float(reached_the_top(run.x, start, end))


def value(name: str, run: Run) -> float:
    """The observable as one number: of the front the last place, of R its mean."""
    if name == "front":
        return float(front(run)[-1])
    if name == "R":
        return scale(name, run)
    return MEASURES[name](run)


MEASURES = {"slope": slope, "roughness": roughness, "eroded": eroded, "reach": reach, "top": top}


def _released(run: Run) -> Array:
    return run.scene.initial(run.x)[1]


def _cell(run: Run) -> float:
    return run.scene.domain.length / run.x.size


def _roughness_of(x: Array, h: Array) -> float:
    length = x[0] + x[-1]
    middle = (x >= length / 4) & (x <= length * 3 / 4)
    line = -fitted_slope(x, h) * x
    return root_mean_square((h - line)[middle])


def _relative_l1(full: Run, other: Run) -> float:
    """Mean |R - R_full| over all cells and times, over the mean of R_full.

    On other cells both are averaged over the cells of the coarser grid.
    """
    cells = min(full.x.size, other.x.size)
    a, b = (_averaged(R, cells) for R in (full.R, other.R))
    gap, size = float(np.mean(np.abs(a - b))), float(np.mean(np.abs(a)))
    return gap / size if size > 0 else (0.0 if gap == 0 else math.inf)


def _averaged(R: Array, cells: int) -> Array:
    """R (T, N) averaged over ``cells`` larger cells; N need not be a multiple of them."""
    if R.shape[1] == cells:
        return R
    area = np.concatenate([np.zeros((R.shape[0], 1)), np.cumsum(R, axis=1)], axis=1)
    edges = np.linspace(0, R.shape[1], cells + 1)
    sums = np.array([np.interp(edges, np.arange(R.shape[1] + 1), row) for row in area])
    return np.asarray(np.diff(sums, axis=1) * cells / R.shape[1])
