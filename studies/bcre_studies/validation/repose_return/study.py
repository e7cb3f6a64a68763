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

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

import bcre_ca.theory
import bcre_pde
import bcre_pde.theory
from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.compare import Comparison
from bcre_studies.comparison.error import allowed_error
from bcre_studies.comparison.rounding import shown
from bcre_studies.comparison.verdict import Verdict, worst
from bcre_studies.models.bcre import problem_of
from bcre_studies.models.effective import effective
from bcre_studies.models.registry import AUTOMATON, BCRE, COMPARED, EFFECTIVE, MODELS, Model
from bcre_studies.observables.outcome import slope, spent
from bcre_studies.reporting import style
from bcre_studies.scenes.scene import Scene, load
from bcre_studies.sweeps.parallel import each
from bcre_studies.validation.repose_return.repeated_pulses import (
    SOLVER_TOLERANCE,
    slopes_of_automaton,
    slopes_of_pde,
)
from bcre_studies.validation.repose_return.thin_pulse import slope_after_thin_pulse

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

TOLERANCE = 0.02
WHY = "0.01 in the slope, half a degree: as near as an angle of repose is measured"
AT_REPOSE = 0.001
AT_REPOSE_WHY = "S = Sc to three digits"
THIN = 0.1
"""A pulse is thin where the closed form changes S - Sc by less than this part of it, and its
surface wave is slower than this part of v."""
CLOSE = 0.3
"""|S0 - Sc| up to which a slope counts as close to repose: about 12 degrees above Sc = 0.5."""

COLUMNS = [AUTOMATON.column, BCRE.column]
SLOW, FAST, REPEATED = "slow", "fast", "repeated"
SETTINGS = {SLOW: ("figure1", 3000.0, 15.0), FAST: ("pulse_at_repose", 60.0, 20.0)}
"""Scene, time to leave, and place of the pulse, near the top."""
STEP = 0.2
"""dt at d = 1: a fixed step, so that D_eff is that of the whole run."""
SLOW_EXCESSES = (-0.3, -0.02, 0.02, 0.1, 0.3, 0.6, 1.0, 2.1, 3.2)
SLOW_PULSES = (0.1, 1.0, 10.0)
FAST_EXCESSES = (-0.3, -0.02, 0.0, 0.02, 0.3, 3.0)
FAST_PULSES = (1.0, 10.0)
SEQUENCES = ((-0.3, 10.0), (0.1, 10.0), (0.3, 1.0))
"""S0 - Sc and amplitude of the repeated pulses."""
RELEASES = 15
SHOWN = (1, 5, 10, 15)
GRIDS = (40, 80, 160)


def scene_of(kind: str, excess: float, pulse: float) -> Scene:
    """Figure 1's or figure 2's material with a pulse near the top, until it has left."""
    name, until, centre = SETTINGS[kind]
    scene = load(name)
    return scene.with_changes(
        **{"until": until, "step": STEP, "surface.0.slope": scene.material.Sc + excess},
        **{"rolling.0.amplitude": pulse, "rolling.0.centre": centre},
    )


def run() -> dict[str, pd.DataFrame]:
    """One pulse, then many."""
    slow = [(SLOW, excess, pulse) for excess in SLOW_EXCESSES for pulse in SLOW_PULSES]
    fast = [(FAST, excess, pulse) for excess in FAST_EXCESSES for pulse in FAST_PULSES]
    many = [(REPEATED, excess, pulse) for excess, pulse in SEQUENCES]
    results = each(_case, many + slow + fast, "repose_return")
    repeated, single = results[: len(many)], results[len(many) :]
    rows = [row for rows, _ in single + repeated for row in rows]
    return {
        "comparison": pd.DataFrame(rows),
        "repeated": pd.DataFrame([point for _, points in repeated for point in points]),
    }


Rows = list[dict[str, Any]]


def _case(case: tuple[str, float, float]) -> tuple[Rows, Rows]:
    kind, excess, pulse = case
    if kind == REPEATED:
        return repeated(excess, pulse)
    return [single(kind, excess, pulse)], []


def single(kind: str, excess: float, pulse: float) -> dict[str, Any]:
    """S - Sc after one pulse, in both models."""
    scene = scene_of(kind, excess, pulse)
    Sc = scene.material.Sc
    times = [float(t) for t in np.linspace(0.0, scene.time.until, 31)]
    end = AUTOMATON.run(scene, times, stop=spent)
    automaton = slope(end.x, end.h[-1]) - Sc

    def refined(scene: Scene) -> bcre_pde.Measured:
        found = bcre_pde.solve_refined(
            problem_of(scene),
            times,
            lambda solution: slope(solution.x, solution.h[-1]) - Sc,
            lambda value: allowed_error(automaton, value, TOLERANCE, Sc),
            coarsest=GRIDS[0],
            finest=GRIDS[-1],
            tolerance=SOLVER_TOLERANCE,
            stop=spent,
        )
        return bcre_pde.Measured(found.value, found.error)

    pde, with_own = refined(scene), refined(effective(scene))
    return {
        **_head(kind, excess, pulse, 1),
        **Comparison(automaton, pde, with_own, TOLERANCE, Sc).row(),
        "automaton_theory": closed_form(scene, scene.d),
        "pde_theory": closed_form(scene, 0.0),
    }


def repeated(excess: float, pulse: float) -> tuple[Rows, Rows]:
    """S - Sc after each of many pulses: rows for some of them, points of the figure for all."""
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
    head = {"S0 - Sc": excess, "pulse": pulse}
    points = [
        {**head, "pulses": n + 1, "model": model.name, "S - Sc": slopes[n]}
        for model, slopes in values.items()
        for n in range(RELEASES)
    ]
    rows = []
    for n in SHOWN:
        of_models = float(automaton[n - 1]), pde[n - 1], with_own[n - 1]
        row = Comparison(*of_models, TOLERANCE, Sc).row()
        rows.append({**_head(REPEATED, excess, pulse, n), **row})
    return rows, points


def closed_form(scene: Scene, d: float) -> float:
    """S - Sc: 0 above Sd, the thin pulse's below it where the pulse is thin, else not a number."""
    v, D, gamma = scene.material.v, scene.material.D, scene.material.gamma
    if d > 0:
        limit = bcre_ca.theory.second_critical_excess(v, D, gamma, d)
    else:
        limit = bcre_pde.theory.second_critical_slope(v, D, gamma, 0.0)
    excess = slope_at_start(scene)
    if excess > limit:
        return 0.0
    after = slope_after_thin_pulse(scene, d)
    _, R = scene.initial(scene.centres())
    thin = gamma * R.max() <= THIN * v
    return shown(after, 1e-5) if thin and abs(after - excess) <= THIN * abs(excess) else np.nan


def slope_at_start(scene: Scene) -> float:
    """S0 - Sc."""
    h, _ = scene.initial(scene.centres())
    return slope(scene.centres(), h) - scene.material.Sc


def _head(kind: str, excess: float, pulse: float, pulses: int) -> dict[str, Any]:
    return {
        "quantity": "final S - Sc",
        "case": kind,
        "S0 - Sc": excess,
        "pulse": pulse,
        "pulses": pulses,
    }


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """The property as printed, what happens instead, and both models compared."""
    table = tables["comparison"]
    once, many = table[table["case"] != REPEATED], table[table["case"] == REPEATED]
    return [
        _printed_claim(once),
        _all_or_nothing_claim(once),
        _one_pulse_claim(once),
        _repeated_claim(many, tables["repeated"]),
    ]


def _printed_claim(rows: pd.DataFrame) -> Claim:
    close = rows[rows["S0 - Sc"].abs() <= CLOSE]
    below, above = close[close["S0 - Sc"] <= 0], close[close["S0 - Sc"] > 0]
    figure2 = _row(rows, FAST, -0.02, 1.0)
    steepest = above.loc[(above.automaton - above["S0 - Sc"]).idxmax()]
    holds = (above[COLUMNS] <= AT_REPOSE).to_numpy().all()
    return Claim(
        "first property as printed",
        "A slope close to repose, perturbed locally, returns to an angle below the critical one.",
        Verdict.AGREE if holds else Verdict.DISAGREE,
        f"in neither model: of {len(above)} pulses on slopes up to {CLOSE:g} above Sc "
        f"{_count(above.automaton <= AT_REPOSE)} returned in the automaton and "
        f"{_count(above.pde <= AT_REPOSE)} in BCRE; the slope stays or steepens (S0 - Sc = "
        f"{steepest['S0 - Sc']:g}, pulse {steepest['pulse']:g}: {steepest.automaton:.3g} and "
        f"{steepest.pde:.3g}). On the {len(below)} at or below Sc the pulse is laid down and S "
        f"stays there, S - Sc at most {below[COLUMNS].to_numpy().max():g}, as in "
        f"figure 2 ({figure2.automaton:g} and {figure2.pde:g} from {figure2['S0 - Sc']:g}), "
        "where there is nothing to return from. It is true where the avalanche runs to the top: "
        "above Sd, for a thick enough pulse, or after enough pulses; and then S = Sc, not less",
        f"{AT_REPOSE:g} above Sc: {AT_REPOSE_WHY}",
    )


def _all_or_nothing_claim(rows: pd.DataFrame) -> Claim:
    above = rows[rows["S0 - Sc"] > 0]
    start = above["S0 - Sc"]
    returned = {column: above[column].abs() <= AT_REPOSE for column in COLUMNS}
    # The slope may be this little short of S0: nothing that a returning slope could be taken for.
    holds = all(
        (back | (above[column] >= start - AT_REPOSE)).all() for column, back in returned.items()
    )
    automaton, pde = map(_count, returned.values())
    in_both = start[pd.DataFrame(returned).all(axis=1)]
    return Claim(
        "all or nothing",
        "One pulse above repose leaves the slope as steep as it was, or brings it to S = Sc.",
        Verdict.AGREE if holds else Verdict.DISAGREE,
        f"of {len(above)} cases the slope came to Sc in {automaton} in the "
        f"automaton and {pde} in BCRE, and was kept or steepened in all "
        f"others; in both models it came down from S0 - Sc = {in_both.min():g} on, below either "
        "Sd, since a pulse that starts at the top has grown thick enough at the foot for its "
        "scarp to climb back",
        f"{AT_REPOSE:g}: {AT_REPOSE_WHY}",
    )


def _one_pulse_claim(rows: pd.DataFrame) -> Claim:
    differing = rows[rows["verdict"] != Verdict.AGREE]
    cases = ", ".join(
        f"{row['S0 - Sc']:g} and pulse {row['pulse']:g} ({row.automaton:.3g} against "
        f"{row.pde:.3g}, effective {row.pde_effective:.3g})"
        for _, row in differing.iterrows()
    )
    gaps = [(rows[column] - rows[f"{column}_theory"]).abs() for column in COLUMNS]
    return Claim(
        "final slope",
        "After one pulse the automaton's slope is that of BCRE.",
        worst(rows["verdict"]),
        f"they agree in {len(rows) - len(differing)} of {len(rows)} cases and differ at S0 - Sc = "
        f"{cases}, near the slope from which on the avalanche climbs back, which the automaton's "
        "v d/2 lowers. Where a closed form holds (thin pulses, and above Sd) S is within "
        f"{max(gap.max() for gap in gaps):.1g} of it",
        f"{TOLERANCE:.0%} of Sc: {WHY}",
    )


def _repeated_claim(rows: pd.DataFrame, points: pd.DataFrame) -> Claim:
    ends = []
    for excess, pulse in SEQUENCES:
        chosen = points[(points["S0 - Sc"] == excess) & (points["pulse"] == pulse)]
        if excess < 0:
            last = chosen[chosen["pulses"] == RELEASES].set_index("model")["S - Sc"]
            automaton, pde = last[AUTOMATON.name], last[BCRE.name]
            ends.append(f"{excess:g} rises to {automaton:.3g} and {pde:.3g} (pulse {pulse:g})")
        else:
            come = chosen[chosen["S - Sc"].abs() <= AT_REPOSE].groupby("model")["pulses"].min()
            counts = " and ".join(str(come.get(model.name, "none")) for model in (AUTOMATON, BCRE))
            peak = chosen[chosen["model"] == AUTOMATON.name]["S - Sc"].max()
            ends.append(
                f"{excess:g} steepens up to {peak:.3g} and is at Sc after {counts} pulses (pulse "
                f"{pulse:g})"
            )
    unresolved = rows[rows["verdict"] == Verdict.UNRESOLVED]
    doubt = (
        "; with kappa = 0 the grids still disagree in the midst of the return (S0 - Sc = "
        f"{unresolved.iloc[0]['S0 - Sc']:g} after {unresolved.iloc[0]['pulses']} pulses: "
        f"difference {unresolved.iloc[0]['difference']:.2g}, "
        f"{unresolved.iloc[0]['difference_effective']:.1g} with D_eff and kappa_eff)"
        if len(unresolved)
        else ""
    )
    return Claim(
        "repeated pulses",
        "Repeated pulses bring the slope to repose, in the automaton as in BCRE.",
        worst(rows["verdict"]),
        "S - Sc in the automaton and in BCRE: from "
        + "; from ".join(ends)
        + f". S = Sc is where both end, or what they approach{doubt}",
        f"{TOLERANCE:.0%} of Sc: {WHY}",
    )


def _row(rows: pd.DataFrame, kind: str, excess: float, pulse: float) -> Any:
    chosen = (rows["case"] == kind) & (rows["S0 - Sc"] == excess) & (rows["pulse"] == pulse)
    return rows[chosen].iloc[0]


def _count(holds: pd.Series) -> str:
    return str(int(holds.sum())) if holds.any() else "none"


def draw(tables: dict[str, pd.DataFrame]) -> Figure:
    """Final against initial slope, what thin pulses change, and repeated pulses."""
    table = tables["comparison"]
    figure, axes = style.panels(1, 3)
    _draw_final(axes[0], table[table["case"] == SLOW])
    _draw_change(axes[1], table)
    _draw_repeated(axes[2], tables["repeated"])
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


def _draw_repeated(axis: Axes, points: pd.DataFrame) -> None:
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
