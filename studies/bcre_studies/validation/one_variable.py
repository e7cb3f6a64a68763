r"""Control: an automaton of the height alone, through the same four comparisons.

Its rule (Bak, Tang and Wiesenfeld 1988, for a continuous height) moves sand downhill wherever the
slope exceeds Sc, and nothing else (``height_only``):

    f(i) = (1/4) max(0, h(i) - h(i+1) - Sc d)        h(i) += f(i-1) - f(i)

with a closed top and the last cell held, where sand leaves; or periodic in h + Sc x. It conserves
h and has no rolling layer, so what it does as well needs no second layer, and what it does not
is what the second layer is for. A pulse of rolling sand is given to it as height.

Beside it stands the same rule with angles of start and of stop: a cell sheds nothing until the
slope exceeds S_start, and from then on until it is Sc. S_start is the Sd of the two-layer
automaton.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.rounding import significant
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.comparison.wording import sentences, when
from bcre_studies.models.automaton import rule_of
from bcre_studies.models.height_only import HeightOnly
from bcre_studies.models.registry import AUTOMATON, BCRE, HEIGHT_ONLY, Look
from bcre_studies.models.run import Run
from bcre_studies.observables.outcome import slope
from bcre_studies.reporting import style
from bcre_studies.scenes.scene import Scene, load
from bcre_studies.sweeps.parallel import each

if TYPE_CHECKING:
    from matplotlib.figure import Figure

EXCESSES = (0.5, 1.5, 3.2)
PULSES = (0.0, 1.0)
CELLS = 200
WAVE_CELLS = 800
"""So that the shortest waves of the rough slope keep their height in BCRE."""
CHANGED = 0.01
SLOPE = "final S - Sc"
MODELS = (HEIGHT_ONLY, AUTOMATON, BCRE)
LOOKS: tuple[Look, ...] = ({}, {"markersize": 10, "markerfacecolor": "none"}, {})
STICKING = "start_and_stop"
"""Column of the control with angles of start and of stop."""
TOLERANCE = 0.05
WHY = "of the slope's excess at the start: a twentieth of what there is to lose"

Row = dict[str, Any]


def run() -> dict[str, pd.DataFrame]:
    """The four properties, in the control, in the two-layer automaton and in BCRE."""
    cases: list[tuple[str, float, float]] = [
        ("slope", excess, pulse) for excess in EXCESSES for pulse in PULSES
    ]
    cases += [("roughness", 0.0, 0.0), ("reach", 0.0, 0.0)]
    return {"comparison": pd.DataFrame(each(_case, cases, "one_variable"))}


def _case(case: tuple[str, float, float]) -> Row:
    kind, excess, pulse = case
    if kind == "slope":
        return final_slope(excess, pulse)
    return roughness() if kind == "roughness" else reach()


def final_slope(excess: float, pulse: float) -> Row:
    """S - Sc at the end of figure 1 on a slope Sc + excess, with a pulse or undisturbed."""
    scene = load("figure1").with_changes(
        **{"until": 2000.0, "surface.0.slope": 0.5 + excess, "rolling.0.amplitude": pulse},
        **{"solver.tolerance": 1e-4},
    )
    Sc = scene.material.Sc
    return _row(SLOPE, slope_case(excess, pulse), scene, lambda run: slope(run.x, run.h[-1]) - Sc)


def slope_case(excess: float, pulse: float) -> str:
    """What the table calls it."""
    return f"S0 - Sc = {excess:g}, pulse {pulse:g}"


def roughness() -> Row:
    """RMS of u at the end of rough_slope, relative to the start."""
    return _row(
        "RMS of u, end over start",
        "rough_slope",
        load("rough_slope"),
        lambda run: float(np.std(run.u[-1]) / np.std(run.u[0])),
        WAVE_CELLS,
    )


def reach() -> Row:
    """How far uphill of the pulse's centre the surface of figure 3 changes by 1 % of the most."""
    scene = load("figure3")
    x, (_, R) = scene.centres(), scene.initial(scene.centres())
    centre = float(R @ x / R.sum())

    def reached(run: Run) -> float:
        change = np.abs(run.h[-1] - run.h[0])
        return centre - float(run.x[change >= CHANGED * change.max()][0])

    return _row("reach uphill", "figure3", scene, reached)


def _row(
    quantity: str, case: str, scene: Scene, measure: Callable[[Run], float], cells: int = CELLS
) -> Row:
    """What is measured at the end of the scene in every model; BCRE on so many cells."""
    row: Row = {"quantity": quantity, "case": case}
    for model in MODELS:
        run = model.run(scene, [0.0, scene.time.until], cells if model is BCRE else None)
        row[model.column] = significant(round(measure(run), 4) + 0.0, 3)
    run = sticking(scene).run(scene, [0.0, scene.time.until])
    return row | {STICKING: significant(round(measure(run), 4) + 0.0, 3)}


def sticking(scene: Scene) -> HeightOnly:
    """The control that starts at the Sd of the scene's automaton and stops at Sc."""
    return HeightOnly(start=rule_of(scene).second_critical_slope())


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """Which properties need a second layer, and which no more than an angle of start."""
    table = tables["comparison"].set_index(["quantity", "case"])
    slopes = {
        (excess, pulse): table.loc[(SLOPE, slope_case(excess, pulse))]
        for excess in EXCESSES
        for pulse in PULSES
    }
    rough = table.loc[("RMS of u, end over start", "rough_slope")]
    far = table.loc[("reach uphill", "figure3")]
    steep, gentle = slopes[EXCESSES[-1], 1.0], slopes[EXCESSES[0], 1.0]
    returns = all(
        abs(row.one_variable) <= TOLERANCE * excess for (excess, _), row in slopes.items()
    )
    stands = all(
        abs(slopes[excess, 0.0][model.column] - excess) <= TOLERANCE * excess
        for excess in EXCESSES
        for model in (AUTOMATON, BCRE)
    )
    metastable = [
        excess
        for excess in EXCESSES
        if abs(slopes[excess, 0.0][STICKING] - excess) <= TOLERANCE * excess
        and abs(slopes[excess, 1.0][STICKING]) <= TOLERANCE * excess
    ]
    tolerance = f"{TOLERANCE:.0%} {WHY}"
    still = slopes[EXCESSES[-1], 0.0]

    def claim(name: str, statement: str, good: bool, evidence: str) -> Claim:
        verdict = Verdict.AGREE if good else Verdict.DISAGREE
        return Claim(name, statement, verdict, evidence, tolerance)

    return [
        claim(
            "return to repose",
            "Returning to the repose slope needs no second layer.",
            returns,
            f"the control ends at S - Sc = {steep.one_variable:g} from S0 - Sc = "
            f"{EXCESSES[-1]:g} and at {gentle.one_variable:g} from {EXCESSES[0]:g}; from "
            f"{EXCESSES[0]:g} the two-layer automaton ends at {gentle.automaton:g} and BCRE at "
            f"{gentle.pde:g}",
        ),
        claim(
            "decay of roughness",
            "Smoothing needs no second layer.",
            rough.one_variable < 1 - TOLERANCE,
            f"of the RMS of rough_slope {rough.one_variable:g} is left in the control, "
            f"{rough.automaton:g} in the two-layer automaton and {rough.pde:g} in BCRE with "
            "kappa = 0",
        ),
        claim(
            "uphill reach",
            "With the second layer the surface changes farther uphill of a pulse than without.",
            far.one_variable < far.automaton - TOLERANCE * abs(far.automaton),
            f"in figure 3 it changes from {far.one_variable:g} above the pulse's centre in the "
            f"control, {far.automaton:g} in the two-layer automaton, {far.pde:g} in BCRE",
        ),
        claim(
            "second critical angle",
            "A slope that stands above repose until it is disturbed needs the second layer.",
            returns and stands and not metastable,
            sentences(
                f"undisturbed, S0 - Sc = {EXCESSES[-1]:g} ends at {still.one_variable:g} in the "
                f"control, {still.automaton:g} in the two-layer automaton and {still.pde:g} in "
                "BCRE",
                when(returns, "Sc is the plain control's only critical slope"),
                *(
                    f"with angles of start and stop one layer stands at S0 - Sc = {excess:g}, and "
                    f"ends at {slopes[excess, 1.0][STICKING]:g} after a pulse of 1"
                    for excess in metastable
                ),
                when(
                    metastable and returns,
                    "so it needs a second layer or a second angle; the layer finds its own",
                ),
            ),
        ),
    ]


def draw(tables: dict[str, pd.DataFrame]) -> Figure:
    """Final slope against initial slope, undisturbed and after a pulse."""
    table = tables["comparison"].set_index("case")
    figure, axes = style.panels(1, 2)
    for axis, pulse in zip(axes, PULSES, strict=True):
        rows = table.loc[[slope_case(excess, pulse) for excess in EXCESSES]]
        for model, look in zip(MODELS, LOOKS, strict=True):
            axis.plot(EXCESSES, rows[model.column], label=model.label, **model.markers(**look))
        axis.plot(EXCESSES, rows[STICKING], "x", color="0.4", label="height alone, start and stop")
        axis.set_xlabel("S0 - Sc")
        axis.set_ylabel("final S - Sc")
        axis.set_title("undisturbed" if pulse == 0 else f"after a pulse of {pulse:g}", loc="left")
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4)
    return figure
