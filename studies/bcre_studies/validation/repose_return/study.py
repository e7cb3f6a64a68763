r"""Does a perturbed slope return to below the critical angle? The paper's first property.

A pulse is released near the top of an incline S0; when it has left, the slope is the least-squares

    S = -dh/dx over the middle half, L/4 <= x <= 3L/4        compared is S - Sc

Expected of both models (closed forms in ``thin_pulse``, ``bcre_ca.theory``, ``bcre_pde.theory``):

* a thin pulse takes sigma I(x) from the surface, I ~ e^(q x), D q^2 - v q + sigma = 0 and
  sigma = gamma (S0 - Sc): below Sc it is laid down, above Sc it strips a layer that is the thicker
  the farther downhill. Either way the slope becomes steeper, by sigma q I;
* once an avalanche runs to the top (S0 > Sd, or thick enough for its scarp to climb) nothing is
  left above the repose line: S - Sc = 0.

"slow" is figure 1's material (v = 0.1), where both happen; "fast" that of figures 2 and 3
(v = 2.5), scene ``pulse_at_repose``, whose case S0 - Sc = -0.02, pulse 1 is figure 2 run to its
end. In "repeated" the slow pulses are released one after another, t = 1000 apart. Differences of
slopes are relative to Sc, since S - Sc may vanish.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.compare import compare_each
from bcre_studies.comparison.verdict import Verdict, worst
from bcre_studies.comparison.wording import joined, sentences, when
from bcre_studies.models.registry import AUTOMATON, BCRE, COMPARED
from bcre_studies.observables.outcome import slope, spent
from bcre_studies.reporting import style
from bcre_studies.sweeps.parallel import each
from bcre_studies.validation.repose_return import repeated_pulses
from bcre_studies.validation.repose_return.pulses import (
    AT_REPOSE,
    AT_REPOSE_WHY,
    FAST,
    GRIDS,
    REPEATED,
    SETTINGS,
    SLOW,
    SOLVER_TOLERANCE,
    TOLERANCE,
    WHY,
    head,
    scene_of,
)
from bcre_studies.validation.repose_return.thin_pulse import (
    closed_form,
    second_critical,
    slope_after_thin_pulse,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

CLOSE = 0.3
"""|S0 - Sc| up to which a slope counts as close to repose: about 12 degrees above Sc = 0.5."""

COLUMNS = [AUTOMATON.column, BCRE.column]
SLOW_EXCESSES = (-0.3, -0.02, 0.02, 0.1, 0.3, 0.6, 1.0, 2.1, 3.2)
SLOW_PULSES = (0.1, 1.0, 10.0)
FAST_EXCESSES = (-0.3, -0.02, 0.0, 0.02, 0.3, 3.0)
FAST_PULSES = (1.0, 10.0)


def run() -> dict[str, pd.DataFrame]:
    """One pulse, then many."""
    slow = [(SLOW, excess, pulse) for excess in SLOW_EXCESSES for pulse in SLOW_PULSES]
    fast = [(FAST, excess, pulse) for excess in FAST_EXCESSES for pulse in FAST_PULSES]
    rows, points = repeated_pulses.run()
    once = each(single, slow + fast, "repose_return")
    return {"comparison": pd.DataFrame(once + rows), "repeated": points}


def single(case: tuple[str, float, float]) -> dict[str, Any]:
    """S - Sc after one pulse, in both models."""
    scene = scene_of(*case)
    Sc = scene.material.Sc
    (result,) = compare_each(
        scene,
        [float(t) for t in np.linspace(0.0, scene.time.until, 31)],
        lambda run: [slope(run.x, run.h[-1]) - Sc],
        [Sc],
        TOLERANCE,
        coarsest=GRIDS[0],
        finest=GRIDS[-1],
        tolerance=SOLVER_TOLERANCE,
        stop=spent,
    )
    theories = [closed_form(scene, second_critical(case[0], d), d) for d in (scene.d, 0.0)]
    return {**head(*case, 1), **result.row(*theories)}


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """The property as printed, what happens instead, and both models compared."""
    table = tables["comparison"]
    once, many = table[table["case"] != REPEATED], table[table["case"] == REPEATED]
    return [
        _printed_claim(once),
        _all_or_nothing_claim(once[once["S0 - Sc"] > 0]),
        _one_pulse_claim(once),
        repeated_pulses.claim(many, tables["repeated"]),
    ]


def _printed_claim(rows: pd.DataFrame) -> Claim:
    close = rows[rows["S0 - Sc"].abs() <= CLOSE]
    below, above = close[close["S0 - Sc"] <= 0], close[close["S0 - Sc"] > 0]
    returned = above[COLUMNS] <= AT_REPOSE
    steepest = above.loc[(above.automaton - above["S0 - Sc"]).idxmax()]
    highest = below[COLUMNS].to_numpy().max()
    far = rows[(rows["S0 - Sc"] > CLOSE) & (rows[COLUMNS].abs() <= AT_REPOSE).all(axis=1)]
    return Claim(
        "first property as printed",
        "A slope close to repose, perturbed locally, returns to an angle below the critical one.",
        Verdict.AGREE if returned.to_numpy().all() else Verdict.DISAGREE,
        sentences(
            f"of {len(above)} pulses on slopes up to {CLOSE:g} above Sc "
            f"{_count(returned.automaton)} returned in the automaton and {_count(returned.pde)} in "
            f"BCRE; the largest change is at S0 - Sc = {steepest['S0 - Sc']:g} with pulse "
            f"{steepest['pulse']:g}, to {steepest.automaton:.3g} and {steepest.pde:.3g}",
            f"{len(below)} pulses on slopes at or below Sc, figure 2 among them, end at S - Sc = "
            f"{highest:g} at most",
            when(highest <= AT_REPOSE, "they are laid down, and there is nothing to return from"),
            when(
                len(far),
                f"steeper slopes come to S = Sc, not to less, in {len(far)} cases, from S0 - Sc = "
                f"{far['S0 - Sc'].min():g} on",
            ),
        ),
        f"{AT_REPOSE:g} above Sc: {AT_REPOSE_WHY}",
    )


def _all_or_nothing_claim(above: pd.DataFrame) -> Claim:
    start = above["S0 - Sc"]
    limits = {
        column: above["case"].map({kind: second_critical(kind, d) for kind in SETTINGS})
        for column, d in zip(COLUMNS, (1.0, 0.0), strict=True)
    }
    returned, kept = above[COLUMNS].abs() <= AT_REPOSE, {}
    for column, limit in limits.items():
        kept[column] = (above[column] >= start - AT_REPOSE) & (above[column] < limit)
    most = above.loc[(above[COLUMNS].max(axis=1) - start).idxmax()]
    scene = scene_of(most["case"], most["S0 - Sc"], most["pulse"])
    thin = [slope_after_thin_pulse(scene, d) for d in (1.0, 0.0)]
    in_both = start[returned.all(axis=1)]
    return Claim(
        "all or nothing",
        "One pulse above repose brings the slope to S = Sc, or steepens it to less than Sd.",
        Verdict.AGREE
        if all((returned[column] | kept[column]).all() for column in COLUMNS)
        else Verdict.DISAGREE,
        sentences(
            f"of {len(above)} cases the slope came to Sc in {_count(returned.automaton)} in the "
            f"automaton and {_count(returned.pde)} in BCRE, in both from S0 - Sc = "
            f"{in_both.min():g} on",
            f"it steepened most at S0 - Sc = {most['S0 - Sc']:g} with pulse {most['pulse']:g}, "
            f"ending at {most.automaton:.3g} in the automaton and {most.pde:.3g} in BCRE, where "
            f"the first order in the pulse gives {thin[0]:.3g} and {thin[1]:.3g}",
        ),
        f"{AT_REPOSE:g}: {AT_REPOSE_WHY}. Sd bounds the steepening, as above it a trace is enough "
        "to bring the slope down",
    )


def _one_pulse_claim(rows: pd.DataFrame) -> Claim:
    differing = rows[rows["verdict"] != Verdict.AGREE]
    only_automaton = (differing.automaton.abs() <= AT_REPOSE) & (differing.pde.abs() > AT_REPOSE)
    gaps = [(rows[column] - rows[f"{column}_theory"]).abs().max() for column in COLUMNS]
    cases = joined(
        f"{row['S0 - Sc']:g} and pulse {row['pulse']:g} ({row.automaton:.3g} against "
        f"{row.pde:.3g}, effective {row.pde_effective:.3g})"
        for _, row in differing.iterrows()
    )
    return Claim(
        "final slope",
        "After one pulse the automaton's slope is that of BCRE.",
        worst(rows["verdict"]),
        sentences(
            f"they agree in {len(rows) - len(differing)} of {len(rows)} cases; others: S0 - Sc = "
            f"{cases}",
            when(
                only_automaton.any(),
                f"in {_count(only_automaton)} of these the avalanche climbs back in the automaton "
                "and not in BCRE",
            ),
            f"where a closed form holds (thin pulses, and above Sd) S is within {max(gaps):.1g} "
            "of it",
        ),
        f"{TOLERANCE:.0%} of Sc: {WHY}",
    )


def _count(holds: pd.Series) -> str:
    return str(int(holds.sum())) if holds.any() else "none"


def draw(tables: dict[str, pd.DataFrame]) -> Figure:
    """Final against initial slope, what thin pulses change, and repeated pulses."""
    table = tables["comparison"]
    figure, axes = style.panels(1, 3)
    _draw_final(axes[0], table[table["case"] == SLOW])
    _draw_change(axes[1], table)
    repeated_pulses.draw(axes[2], tables["repeated"])
    style.legend(figure, COMPARED, markers=True)
    return figure


def _draw_final(axis: Axes, rows: pd.DataFrame) -> None:
    """Pulse 0.1 hollow, 1 half filled, 10 full; the dash-dotted line is S = S0."""
    fills = dict(zip(SLOW_PULSES, ("none", "left", "full"), strict=True))
    for model, shift in zip(COMPARED, (-0.04, 0.0, 0.04), strict=True):
        for pulse, fill in fills.items():
            chosen = rows[rows["pulse"] == pulse]
            look = model.markers(fillstyle=fill, markerfacecoloralt="white", markersize=6)
            axis.plot(chosen["S0 - Sc"] + shift, chosen[model.column], **look)
    axis.plot([-0.3, 1.1], [-0.3, 1.1], **style.START)
    axis.annotate("S = S0", (1.1, 1.1), xytext=(4, -8), textcoords="offset points", fontsize=8)
    axis.set(xlabel="initial S0 - Sc", ylabel="final S - Sc", ylim=(-0.4, 1.2))
    axis.set_title("one pulse: 0.1 hollow, 1 half, 10 full", loc="left")


def _draw_change(axis: Axes, table: pd.DataFrame) -> None:
    """Pulse 1 on slopes close to repose, and the closed form of a thin pulse."""
    places = np.linspace(-CLOSE, CLOSE, 61)
    for kind in (SLOW, FAST):
        rows = table[(table["case"] == kind) & (table["pulse"] == 1.0)]
        rows = rows[rows["S0 - Sc"].abs() <= CLOSE]
        for model in COMPARED:
            look = model.markers(fillstyle="none" if kind == FAST else "full", markersize=6)
            axis.plot(rows["S0 - Sc"], rows[model.column] - rows["S0 - Sc"], **look)
        for model, d in ((AUTOMATON, 1.0), (BCRE, 0.0)):
            after = [slope_after_thin_pulse(scene_of(kind, place, 1.0), d) for place in places]
            axis.plot(places, after - places, **model.line)
    axis.set_yscale("symlog", linthresh=1e-5)
    axis.set(xlabel="initial S0 - Sc", ylabel="change S - S0", ylim=(-5e-6, 0.05))
    axis.set_title("pulse 1, v = 0.1 full, v = 2.5 hollow; closed form", loc="left")
