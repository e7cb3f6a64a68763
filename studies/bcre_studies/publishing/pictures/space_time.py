"""Figure 1 in space and time: both models, and their difference."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from bcre_studies.comparison.rounding import significant
from bcre_studies.models.bcre import SHARE
from bcre_studies.models.registry import AUTOMATON, BCRE
from bcre_studies.models.run import frame_times
from bcre_studies.publishing.pictures.panels import panels
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.scene import load
from bcre_studies.sweeps.parallel import each

RAMP = ("#fdf0d9", "#f9d9a6", "#f2b872", "#e58f45", "#cc672a", "#a5441c", "#752a17", "#451713")
"""From little to much; the style sheet turns it round in the dark scheme."""
LESS = ("#1f5a98", "#7ba7d1")
MORE = ("#e2976b", "#b54810")


@dataclass(frozen=True)
class SpaceTime:
    """Figure 1's rolling layer in both models on the automaton's cells, R (T, N).

    ``own`` (T,) is the change of BCRE from cells twice as long, relative to its mean, and
    ``gap`` (T,) that of the automaton from BCRE; ``top`` the height of the slope above repose.
    """

    x: Array
    t: Array
    automaton: Array
    pde: Array
    own: Array
    gap: Array

    @property
    def resolved_until(self) -> float:
        """The last time up to which BCRE's own error is small against the difference."""
        bad = np.flatnonzero(self.own > SHARE * np.maximum(self.gap, SHARE))
        return float(self.t[bad[0] - 1] if bad.size else self.t[-1])


UNTIL, ROWS, GRID = 240.0, 97, 800


def measure() -> SpaceTime:
    """Figure 1 on the paper's cells, with the step at which the studies compare it."""
    scene = load("figure1").with_changes(until=UNTIL, step=0.4)
    times = frame_times(scene, ROWS)
    run = AUTOMATON.run(scene, times)
    fine, coarse = each(_figure1_of_bcre, [GRID, GRID // 2], "figure 1, space-time")
    size = fine.mean(axis=1)
    return SpaceTime(
        x=run.x,
        t=run.t,
        automaton=run.R,
        pde=fine,
        own=np.abs(fine - coarse).mean(axis=1) / size,
        gap=np.abs(fine - run.R).mean(axis=1) / size,
    )


def _figure1_of_bcre(grid: int) -> Array:
    scene = load("figure1").with_changes(until=UNTIL, step=0.4)
    solution = BCRE.run(scene, frame_times(scene, ROWS), grid)
    cells = scene.domain.cells
    return np.asarray(solution.R.reshape(ROWS, cells, -1).mean(axis=2))


R_LEVELS = (0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 1000.0)
GAP_LEVELS = (-0.5, -0.2, -0.05, 0.05, 0.2, 0.5)


def draw(found: SpaceTime) -> Figure:
    """R(x, t) in the automaton and in BCRE, and their difference over BCRE's largest R then."""
    figure, axes = panels(1, 3, width=3.7, height=3.5)
    for axis, R in zip(axes, (found.automaton, found.pde), strict=False):
        axis.contourf(found.x, found.t, _rounded(R), levels=R_LEVELS, colors=RAMP)
    gap = (found.automaton - found.pde) / found.pde.max(axis=1, keepdims=True)
    axes[2].contourf(
        found.x,
        found.t,
        _rounded(gap),
        levels=GAP_LEVELS,
        colors=(LESS[0], LESS[0], LESS[1], "none", MORE[0], MORE[1], MORE[1]),
        extend="both",
    )
    titles = ("Automaton", "BCRE", "Automaton minus BCRE")
    for axis, title in zip(axes, titles, strict=True):
        axis.set_title(title, loc="left", weight="bold")
        axis.set(xlabel="distance downhill x", xlim=(35, 100), ylim=(0, UNTIL))
        axis.grid(visible=False)
    axes[0].set_ylabel("time t")
    until = found.resolved_until
    if until < UNTIL:
        for axis in axes[1:]:
            axis.axhspan(until, UNTIL, facecolor="none", edgecolor="0.5", hatch="///", linewidth=0)
            axis.axhline(until, color="0.5", linewidth=0.8)
        axes[2].annotate(
            "BCRE unresolved",
            (37, until),
            (0, 4),
            textcoords="offset points",
            fontsize=9,
            backgroundcolor="white",
        )
    return figure


def _rounded(values: Array) -> Array:
    """To four digits, so that every machine finds the same contours."""
    return np.array([[significant(float(value), 4) for value in row] for row in values])
