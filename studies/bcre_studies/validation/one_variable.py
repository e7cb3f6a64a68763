r"""Control: an automaton of the height alone, through the same four comparisons.

Its rule (Bak, Tang and Wiesenfeld 1988, for a continuous height) moves sand downhill wherever the
slope exceeds Sc, and nothing else (``height_only``):

    f(i) = (1/4) max(0, h(i) - h(i+1) - Sc d)        h(i) += f(i-1) - f(i)

with a closed top and the last cell held, where sand leaves; or periodic in h + Sc x. It conserves
h and has no rolling layer, so what it does as well needs no second layer, and what it does not
is what the second layer is for. A pulse of rolling sand is given to it as height.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

import bcre_pde
from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.rounding import significant
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.models.height_only import settle
from bcre_studies.models.simulate import as_run, problem_of, run_automaton
from bcre_studies.observables.outcome import slope
from bcre_studies.reporting import style
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.scene import Scene, load
from bcre_studies.sweeps.each import each

if TYPE_CHECKING:
    from matplotlib.figure import Figure

EXCESSES = (0.5, 1.5, 3.2)
PULSES = (0.0, 1.0)
CELLS = 200
WAVE_CELLS = 800
"""So that the shortest waves of the rough slope keep their height in BCRE."""
CHANGED = 0.01
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


def _row(quantity: str, case: str, control: float, automaton: float, pde: float) -> Row:
    values = {"one_variable": control, "automaton": automaton, "pde": pde}
    rounded = {name: significant(round(value, 4) + 0.0, 3) for name, value in values.items()}
    return {"quantity": quantity, "case": case, **rounded}


def final_slope(excess: float, pulse: float) -> Row:
    """S - Sc at the end of figure 1 on a slope Sc + excess, with a pulse or undisturbed."""
    scene = load("figure1").with_changes(
        **{"until": 2000.0, "surface.0.slope": 0.5 + excess, "rolling.0.amplitude": pulse}
    )
    x, Sc = scene.centres(), scene.material.Sc
    h, R = scene.initial(x)
    control = slope(x, settle(h + R, Sc * scene.d, False))
    two_layer = slope(x, run_automaton(scene, [scene.time.until]).h[-1])
    solution = bcre_pde.solve(problem_of(scene), [scene.time.until], CELLS, tolerance=1e-4)
    pde = slope(solution.x, solution.h[-1])
    case = f"S0 - Sc = {excess:g}, pulse {pulse:g}"
    return _row("final S - Sc", case, control - Sc, two_layer - Sc, pde - Sc)


def roughness() -> Row:
    """RMS of u at the end of rough_slope, relative to the start."""
    scene = load("rough_slope")
    x, Sc = scene.centres(), scene.material.Sc
    h, _ = scene.initial(x)
    start = float(np.std(h + Sc * x))
    control = settle(h, Sc * scene.d, True) + Sc * x
    two_layer = run_automaton(scene, [scene.time.until]).u[-1]
    pde = bcre_pde.solve(problem_of(scene), [scene.time.until], WAVE_CELLS).u[-1]
    values = [float(np.std(u)) / start for u in (control, two_layer, pde)]
    return _row("RMS of u, end over start", "rough_slope", *values)


def reach() -> Row:
    """How far uphill of the pulse's centre the surface of figure 3 changes by 1 % of the most."""
    scene = load("figure3")
    x = scene.centres()
    h, R = scene.initial(x)
    control = settle(h + R, scene.material.Sc * scene.d, False) - (h + R)
    automaton = run_automaton(scene, [0.0, scene.time.until])
    pde = as_run(scene, bcre_pde.solve(problem_of(scene), [0.0, scene.time.until], CELLS))
    changes = [(x, control), *((run.x, run.h[-1] - run.h[0]) for run in (automaton, pde))]
    return _row("reach uphill", "figure3", *(_reach(scene, *change) for change in changes))


def _reach(scene: Scene, x: Array, change: Array) -> float:
    x0, R0 = scene.centres(), scene.initial(scene.centres())[1]
    centre = float(R0 @ x0 / R0.sum())
    changed = np.abs(change) >= CHANGED * np.abs(change).max()
    return centre - float(x[changed][0])


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """Three properties need no second layer; a second critical angle does."""
    table = tables["comparison"].set_index(["quantity", "case"])
    slopes = {
        (excess, pulse): table.loc[("final S - Sc", f"S0 - Sc = {excess:g}, pulse {pulse:g}")]
        for excess in EXCESSES
        for pulse in PULSES
    }
    rough = table.loc[("RMS of u, end over start", "rough_slope")]
    far = table.loc[("reach uphill", "figure3")]
    steep, gentle = slopes[EXCESSES[-1], 1.0], slopes[EXCESSES[0], 1.0]
    returns = all(
        abs(row["one_variable"]) <= TOLERANCE * excess for (excess, _), row in slopes.items()
    )
    stands = all(
        abs(slopes[excess, 0.0][model] - excess) <= TOLERANCE * excess
        for excess in EXCESSES
        for model in ("automaton", "pde")
    )
    tolerance = f"{TOLERANCE:.0%} {WHY}"
    return [
        Claim(
            "return to repose",
            "Returning to the repose slope needs no second layer.",
            Verdict.AGREE if returns else Verdict.DISAGREE,
            f"the control ends at S - Sc = {steep['one_variable']:g} from S0 - Sc = "
            f"{EXCESSES[-1]:g} and at {gentle['one_variable']:g} from {EXCESSES[0]:g}, where the "
            f"two-layer automaton keeps {gentle['automaton']:g} and BCRE {gentle['pde']:g}",
            tolerance,
        ),
        Claim(
            "decay of roughness",
            "Smoothing needs no second layer.",
            Verdict.AGREE if rough["one_variable"] < 1 - TOLERANCE else Verdict.DISAGREE,
            f"the RMS of rough_slope falls to {rough['one_variable']:g} of its start in the "
            f"control, to {rough['automaton']:g} in the two-layer automaton, and to "
            f"{rough['pde']:g} in BCRE with kappa = 0",
            tolerance,
        ),
        Claim(
            "uphill reach",
            "With the second layer the surface changes farther uphill of a pulse than without.",
            Verdict.AGREE
            if far["one_variable"] < far["automaton"] - TOLERANCE * abs(far["automaton"])
            else Verdict.DISAGREE,
            f"in figure 3 it changes from {far['one_variable']:g} above the pulse's centre in the "
            f"control, {far['automaton']:g} in the two-layer automaton, {far['pde']:g} in BCRE",
            tolerance,
        ),
        Claim(
            "second critical angle",
            "A slope that stands above repose until it is disturbed needs the second layer.",
            Verdict.AGREE if returns and stands else Verdict.DISAGREE,
            f"undisturbed, S0 - Sc = {EXCESSES[-1]:g} falls to "
            f"{slopes[EXCESSES[-1], 0.0]['one_variable']:g} in the control, so that Sc is its only "
            f"critical slope, and stays at {slopes[EXCESSES[-1], 0.0]['automaton']:g} in the "
            f"two-layer automaton and {slopes[EXCESSES[-1], 0.0]['pde']:g} in BCRE",
            tolerance,
        ),
    ]


def draw(tables: dict[str, pd.DataFrame]) -> Figure:
    """Final slope against initial slope, undisturbed and after a pulse."""
    table = tables["comparison"]
    figure, axes = style.panels(1, 2)
    looks = {
        "one_variable": {"color": "k", "marker": "D", "label": "height alone"},
        "automaton": {"color": style.MODELS["ca"]["color"], "marker": "o", "markersize": 10}
        | {"markerfacecolor": "none", "label": "two-layer automaton"},
        "pde": {"color": style.MODELS["pde"]["color"], "marker": "s", "label": "BCRE (PDE)"},
    }
    for axis, pulse in zip(axes, PULSES, strict=True):
        rows = table[table["case"].str.endswith(f"pulse {pulse:g}")]
        for column, look in looks.items():
            axis.plot(EXCESSES, rows[column], linestyle="", **look)
        axis.set_xlabel("S0 - Sc")
        axis.set_ylabel("final S - Sc")
        axis.set_title("undisturbed" if pulse == 0 else f"after a pulse of {pulse:g}", loc="left")
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return figure
