r"""Pulses released one after another at the same place, each when the one before has left.

After a pause the rolling layer is down to traces; the next pulse is added to it and the surface is
taken as it was left.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

import bcre_ca
import bcre_pde
from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.compare import Comparison
from bcre_studies.comparison.verdict import Verdict, worst
from bcre_studies.comparison.wording import sentences, when
from bcre_studies.models.automaton import rule_of
from bcre_studies.models.bcre import problem_of
from bcre_studies.models.effective import effective
from bcre_studies.models.registry import AUTOMATON, BCRE, EFFECTIVE, MODELS, Model
from bcre_studies.observables.outcome import slope
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.scene import Scene
from bcre_studies.sweeps.parallel import each
from bcre_studies.validation.repose_return.pulses import (
    AT_REPOSE,
    GRIDS,
    REPEATED,
    SLOW,
    SOLVER_TOLERANCE,
    TOLERANCE,
    WHY,
    head,
    scene_of,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
SEQUENCES = ((-0.3, 10.0), (0.1, 10.0), (0.3, 1.0))
"""S0 - Sc and amplitude of the repeated pulses."""
RELEASES = 15
SHOWN = (1, 5, 10, 15)
Rows = list[dict[str, Any]]


def slopes_of_automaton(scene: Scene, pulses: int) -> list[float]:
    """Slope S after each of so many of the scene's pulses, ``scene.time.until`` apart."""
    h, pulse = scene.initial(scene.centres())
    pile = bcre_ca.Pile(h, pulse)
    rule, ends, time = rule_of(scene), scene.domain.ends, scene.time
    slopes = []
    for _ in range(pulses):
        (pile,) = bcre_ca.frames(pile, rule, [time.until], ends, time.step)
        slopes.append(slope(scene.centres(), pile.h))
        pile = bcre_ca.Pile(pile.h, pile.R + pulse)
    return slopes


def slopes_of_pde(scene: Scene, cells: int, pulses: int) -> list[float]:
    """Slope S after each pulse in BCRE on a grid of so many cells."""
    x, problem = scene.centres(cells), problem_of(scene)
    _, pulse = problem.initial(x)
    slopes = []
    for _ in range(pulses):
        solution = bcre_pde.solve(problem, [scene.time.until], cells, tolerance=SOLVER_TOLERANCE)
        slopes.append(slope(x, solution.h[-1]))
        problem = _next_problem(solution, pulse)
    return slopes


def _next_problem(solution: bcre_pde.Solution, pulse: Array) -> bcre_pde.Problem:
    """The same problem from where it has come to, with another pulse, on the same grid."""
    problem, h, R = solution.problem, solution.h[-1], solution.R[-1] + pulse
    foot = _foot(solution)

    def initial(x: Array) -> tuple[Array, Array]:
        return (h, R) if x.size == h.size else (x * 0 + foot, x * 0)

    return bcre_pde.Problem(initial, problem.material, problem.length, problem.ends)


def _foot(solution: bcre_pde.Solution) -> float:
    """h on an open foot: with kappa = 0 it stays, else by a parabola in u with u_x = 0 there."""
    problem = solution.problem
    end = solution.x[-1:] * 0 + problem.length
    if problem.material.kappa == 0:
        return float(problem.initial(end)[0][0])
    before, last = solution.u[-1, -2:]
    return float((9 * last - before) / 8 - problem.material.Sc * problem.length)


def run() -> tuple[Rows, pd.DataFrame]:
    """Rows of the comparison for some numbers of pulses, and the points of the figure."""
    results = each(repeated, SEQUENCES, "repose_return, repeated")
    rows = [row for rows, _ in results for row in rows]
    return rows, pd.DataFrame([point for _, points in results for point in points])


def repeated(sequence: tuple[float, float]) -> tuple[Rows, Rows]:
    """S - Sc after each of many pulses: rows for some of them, points of the figure for all."""
    excess, pulse = sequence
    scene = scene_of(SLOW, excess, pulse).with_changes(until=1000.0)
    Sc = scene.material.Sc
    automaton = np.array(slopes_of_automaton(scene, RELEASES)) - Sc

    def refined(changed: Scene) -> list[bcre_pde.Measured]:
        def measure_on(cells: int) -> tuple[None, list[float]]:
            slopes = slopes_of_pde(changed, cells, RELEASES)
            return None, [float(after) for after in np.array(slopes) - Sc]

        found = bcre_pde.measure_refined(measure_on, GRIDS)
        return [bcre_pde.Measured(after.value, after.error) for after in found]

    pde, with_own = refined(scene), refined(effective(scene))
    values: dict[Model, Sequence[float]] = {
        AUTOMATON: automaton.tolist(),
        BCRE: [after.value for after in pde],
        EFFECTIVE: [after.value for after in with_own],
    }
    points = [
        {
            "S0 - Sc": excess,
            "pulse": pulse,
            "pulses": n + 1,
            "model": model.name,
            "S - Sc": slopes[n],
        }
        for model, slopes in values.items()
        for n in range(RELEASES)
    ]
    rows = []
    for n in SHOWN:
        of_models = float(automaton[n - 1]), pde[n - 1], with_own[n - 1]
        row = Comparison(*of_models, TOLERANCE, Sc).row()
        rows.append({**head(REPEATED, excess, pulse, n), **row})
    return rows, points


def claim(rows: pd.DataFrame, points: pd.DataFrame) -> Claim:
    """Both models come to repose, after how many pulses and by what way."""
    lines = []
    for excess, pulse in SEQUENCES:
        chosen = points[(points["S0 - Sc"] == excess) & (points["pulse"] == pulse)]
        peaks, returns, ends = [], [], []
        for model in (AUTOMATON, BCRE):
            line = chosen[chosen["model"] == model.name].set_index("pulses")["S - Sc"]
            at_repose = line.index[line.abs() <= AT_REPOSE]
            peaks.append(f"{line.max():.3g}")
            returns.append(f"after {at_repose.min()} pulses" if len(at_repose) else "never")
            ends.append(f"{line.iloc[-1] + 0.0:.3f}")
        lines.append(
            f"from {excess:g} with pulse {pulse:g}: at most {' and '.join(peaks)}, at Sc "
            f"{' and '.join(returns)}, {' and '.join(ends)} after {RELEASES}"
        )
    unresolved = [
        f"S0 - Sc = {row['S0 - Sc']:g} after {row['pulses']} pulses: difference "
        f"{row['difference']:.2g}, {row['difference_effective']:.1g} with D_eff and kappa_eff"
        for _, row in rows[rows["verdict"] == Verdict.UNRESOLVED].iterrows()
    ]
    return Claim(
        "repeated pulses",
        "After each of many pulses the automaton's slope is that of BCRE.",
        worst(rows["verdict"]),
        sentences(
            f"S - Sc in the automaton and in BCRE, {'; '.join(lines)}",
            when(unresolved, f"BCRE with kappa = 0 is not resolved at {'; '.join(unresolved)}"),
        ),
        f"{TOLERANCE:.0%} of Sc: {WHY}",
    )


def draw(axis: Axes, points: pd.DataFrame) -> None:
    """S - Sc after every pulse, a line for each sequence and model."""
    for (_, _, name), line in points.groupby(["S0 - Sc", "pulse", "model"]):
        model = MODELS[str(name)]
        look = model.line | {"marker": model.marker, "fillstyle": "none"}
        axis.plot(line["pulses"], line["S - Sc"], **look)
    for excess, pulse in SEQUENCES:
        axis.annotate(
            f"from {excess:g}, pulse {pulse:g}",
            (0.7, excess),
            fontsize=8,
            xytext=(0, -12 if excess > 0 else -14),
            textcoords="offset points",
        )
    axis.set(xlabel="pulses so far", ylabel="S - Sc", ylim=(-0.38, 0.56))
    axis.set_title("repeated pulses", loc="left")
