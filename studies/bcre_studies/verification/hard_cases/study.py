r"""Hard scenes in both models: what happens, and what a model that fails says of it.

Every scene (``hard_scenes``) runs in the automaton with the schemes upwind,
calibrated and limited, with the step that follows its bounds and where named with a fixed one, and
in BCRE with its default method on the same cells. It ends in one of

    survives                                    finite layers at the end
    survives with the step lowered N times      the same, and "auto" had to shorten its step
    refused before the start                    a step or a grid that is known to be impossible
    fails                                       stopped on the way: where, when and by which bound

Both models know flow in one direction only. Where the surface rises in x, S < 0, the exchange
gamma R (S - Sc) deposits, the faster the steeper, while R is still carried on in x, there uphill,
and dies out over a length v/(gamma (Sc - S)). So what crosses the bottom of a valley is laid down
as a wedge on its far side, and what falls before a hill mostly does not reach the top. Neither is
what sand does there; it is what the equations say, in both models.

Past the shock of the climbing wave, and for the scarp of figure 1, BCRE with kappa = 0 has
no solution that its grid would converge to. The table ``scarp`` refines both: max R and place of
the scarp at t = 250 with kappa = 0 and kappa = 0.005, and the automaton, whose cell takes the
part of the curvature term, kappa_eff = gamma d/2, so that it too depends on its grid.

The tables ``scarp`` and ``adaptive_step`` are those of the modules ``scarp_grids`` and
``adaptive_step``.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple, cast, get_args

import numpy as np
import pandas as pd

import bcre_ca
import bcre_pde
from bcre_ca.rule import Scheme
from bcre_studies.comparison.claim import Claim, quality_check
from bcre_studies.comparison.rounding import significant
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.comparison.wording import sentences, when
from bcre_studies.models.registry import AUTOMATON, BCRE, Look
from bcre_studies.reporting import style
from bcre_studies.scenes.domain import Array
from bcre_studies.sweeps.parallel import each
from bcre_studies.verification.hard_cases import adaptive_step, scarp_grids
from bcre_studies.verification.hard_cases.hard_scenes import HardScene, long_run, scenes

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SCHEMES: tuple[Scheme, ...] = get_args(Scheme)
MASS = 1e-12
SURVIVES, REFUSED, FAILS = "survives", "refused before the start", "fails"
FRAMES = 5
LEAST_MASS_ERROR = 1e-13
"""Smaller values count as equal: rounding differs from processor to processor."""


Row = dict[str, Any]


class Attempt(NamedTuple):
    """A scene in one model; ``scheme`` and ``step`` are the automaton's."""

    scene: str
    model: str
    scheme: Scheme = "upwind"
    step: float | str = "auto"


def run() -> dict[str, pd.DataFrame]:
    """One row a scene and model; the scarp, grid by grid; steps that adapt."""
    cases = [case for scene in [*scenes().values(), long_run()] for case in _cases(scene)]
    return {
        "comparison": pd.DataFrame(each(_try, cases, "hard_cases")),
        "scarp": scarp_grids.run(),
        "adaptive_step": adaptive_step.run(),
    }


def _cases(scene: HardScene) -> list[Attempt]:
    automaton = [
        Attempt(scene.name, AUTOMATON.name, s, step) for s in SCHEMES for step in scene.steps
    ]
    return (
        automaton if scene.name == long_run().name else [*automaton, Attempt(scene.name, BCRE.name)]
    )


class Summary(NamedTuple):
    """What is read off a run: of all frames the smallest and the largest R, of the last one h."""

    x: Array
    mass_error: float
    smallest_R: float
    largest_R: float
    h: Array
    lowered: int = 0


def _try(attempt: Attempt) -> Row:
    scene = long_run() if attempt.scene == long_run().name else scenes()[attempt.scene]
    row = {"scene": attempt.scene, "model": attempt.model}
    row |= {"scheme": "", "step": ""}
    if attempt.model == AUTOMATON.name:
        row |= {"scheme": attempt.scheme, "step": str(attempt.step)}
    try:
        with np.errstate(all="ignore"):
            end = _automaton(scene, attempt) if attempt.model == AUTOMATON.name else _pde(scene)
    except (bcre_pde.SolveError, FloatingPointError, ValueError) as failure:
        return row | _refusal(failure)
    verdict = SURVIVES
    if end.lowered:
        verdict += f" with the step lowered {end.lowered} times"
    return row | {
        "verdict": verdict,
        "mass_error_at_most": _decade(end.mass_error),
        "smallest_R": significant(_cut(end.smallest_R, end.largest_R), 1),
        "largest_R": significant(end.largest_R, 3),
        "end_slope": _slope(end),
        "message": "",
    }


def _refusal(failure: Exception) -> Row:
    """What is known of a run without an end; the failure's text says where and by which bound."""
    before = isinstance(failure, ValueError) or getattr(failure, "time", None) == 0
    blank = dict.fromkeys(("mass_error_at_most", "smallest_R", "largest_R", "end_slope"), "")
    return {"verdict": REFUSED if before else FAILS} | blank | {"message": str(failure)}


def _cut(smallest: float, largest: float) -> float:
    """Rounding errors of R are 0."""
    return 0.0 if abs(smallest) < 1e-12 * largest else smallest


def _decade(error: float) -> float:
    """The power of ten above; its digits are those of rounding errors."""
    return float(f"1e{math.ceil(math.log10(max(error, LEAST_MASS_ERROR)))}")


def _slope(end: Summary) -> float | str:
    if end.x.size < 2:
        return ""
    return round(float(-np.polyfit(end.x, end.h, 1)[0]), 3) + 0.0


def rule_for(scene: HardScene, scheme: Scheme) -> bcre_ca.Rule:
    """The scene's automaton with dt = 1; the step is chosen by :func:`bcre_ca.frames`."""
    m = scene.problem.material
    return bcre_ca.Rule(m.v, m.D, m.gamma, m.Sc, scene.d, 1.0, scheme=scheme, kappa=m.kappa)


def _automaton(scene: HardScene, attempt: Attempt) -> Summary:
    rule, x = rule_for(scene, attempt.scheme), scene.centres()
    start = bcre_ca.Pile(*scene.problem.initial(x))
    times = [scene.until * (part + 1) / FRAMES for part in range(FRAMES)]
    step = cast("Any", attempt.step)
    piles = [start, *bcre_ca.frames(start, rule, times, scene.problem.ends, step)]
    end = piles[-1]
    balance = abs(end.mass(rule.d) + end.outflow - start.mass(rule.d))
    return Summary(
        x,
        balance / _sand(start.h, start.R, rule.d),
        min(float(pile.R.min()) for pile in piles),
        max(float(pile.R.max()) for pile in piles),
        end.h,
        end.lowered,
    )


def _sand(h: Array, R: Array, d: float) -> float:
    return d * float(np.abs(h).sum() + R.sum())


def _pde(scene: HardScene) -> Summary:
    times = [scene.until * part / FRAMES for part in range(FRAMES + 1)]
    end = bcre_pde.solve(scene.problem, times, scene.cells)
    mass = end.mass()
    balance = abs(mass[-1] + end.outflow[-1] - mass[0])
    return Summary(
        end.x,
        balance / _sand(end.h[0], end.R[0], end.dx),
        float(end.R.min()),
        float(end.R.max()),
        end.h[-1],
    )


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """Finite numbers, mass, failures that say where; the scarp; steps that adapt."""
    table = tables["comparison"]
    return [
        _finite(tables),
        _mass(table),
        _says_where(table),
        _not_negative(table),
        scarp_grids.claim(tables["scarp"]),
        adaptive_step.claim(tables["adaptive_step"]),
    ]


def _word(good: object) -> Verdict:
    return Verdict.AGREE if good else Verdict.DISAGREE


def _finite(tables: dict[str, pd.DataFrame]) -> Claim:
    cells = [cell for table in tables.values() for cell in table.to_numpy(object).ravel()]
    numbers = [float(cell) for cell in cells if isinstance(cell, int | float)]
    bad = sum(not math.isfinite(number) for number in numbers)
    missing = sum(cell is None for cell in cells)
    return quality_check(
        name="finite",
        statement="No NaN or infinity in any table of this study.",
        verdict=_word(bad == 0 and missing == 0),
        evidence=f"{bad} of {len(numbers)} numbers are not finite",
        tolerance="none",
    )


def _mass(table: pd.DataFrame) -> Claim:
    long = table[table["scene"] == long_run().name]["mass_error_at_most"]
    known = [float(error) for error in table["mass_error_at_most"] if error != ""]
    return quality_check(
        name="mass",
        statement=f"The mass error is at most {MASS:g} after 10^7 steps.",
        verdict=_word(len(long) and all(error != "" and float(error) <= MASS for error in long)),
        evidence=f"at most {long.max():.0e} of the sand in {len(long)} schemes; at most "
        f"{max(known):.0e} in all {len(known)} runs that come to their end",
        tolerance=f"{MASS:g} of the sand at the start: rounding, with outflow summed exactly",
    )


def _says_where(table: pd.DataFrame) -> Claim:
    failing = table[table["verdict"] == FAILS]
    refused = table[table["verdict"] == REFUSED]
    where = [all(part in text for part in ("t = ", "cell ", " = ")) for text in failing["message"]]
    what = ["must" in text and " = " in text for text in refused["message"]]
    survived = table["verdict"].str.startswith(SURVIVES).sum()
    return quality_check(
        name="each failing model says where",
        statement="Each failing model says in which cell, when and by which bound, and each that "
        "refuses to start names what is not allowed.",
        verdict=_word(all(where) and all(what)),
        evidence=f"of {len(table)} runs {survived} survive, {len(refused)} are refused before the "
        f"start, {sum(what)} of them by name, and {len(failing)} fail on the way, {sum(where)} of "
        f"them with cell, time and bound: {', '.join(sorted(set(failing['scene'])))}",
        tolerance="a text without one of them counts as silent",
    )


def _not_negative(table: pd.DataFrame) -> Claim:
    ran = table[table["smallest_R"] != ""]
    negative = ran[ran["smallest_R"].astype(float) < 0]
    share = -negative["smallest_R"].astype(float) / negative["largest_R"].astype(float)
    most = f", at most {share.max():.1%} of the largest R" if len(negative) else ""
    scene = f" ({negative.loc[share.idxmax(), 'scene']})" if len(negative) else ""
    automaton = int((negative["model"] == AUTOMATON.name).sum())
    return Claim(
        name="R >= 0",
        statement="R stays >= 0 in both models.",
        verdict=_word(len(negative) == 0),
        evidence=sentences(
            f"{automaton} runs of the automaton and {len(negative) - automaton} of BCRE have R < 0 "
            f"somewhere{most}{scene}",
            when(
                len(negative) > automaton,
                "BCRE's differences of high order undershoot ahead of a scarp that a cell cannot "
                "resolve, and exchange nothing there",
            ),
        ),
        tolerance="1e-12 of the largest R: rounding",
    )


def draw(tables: dict[str, pd.DataFrame]) -> Figure:
    """What came of every scene and model; the scarp on finer and finer grids."""
    from matplotlib.figure import Figure

    style.use()
    figure = Figure(figsize=(11.0, 7.4), layout="constrained")
    axes = figure.subplot_mosaic([["runs", "max_R"], ["runs", "place"]], width_ratios=[1.25, 1])
    _draw_runs(axes["runs"], tables["comparison"])
    for key, label in (("max_R", "max R"), ("place", "place of the scarp x")):
        scarp_grids.draw(axes[key], tables["scarp"], key, label)
    axes["max_R"].set_title("figure 1 at t = 250, on finer and finer grids", loc="left")
    axes["max_R"].legend()
    return figure


COLUMNS = {
    (AUTOMATON.name, scheme, step): scheme if step == "auto" else f"{scheme}, fixed"
    for step in ("auto", "fixed")
    for scheme in SCHEMES
} | {(BCRE.name, "", ""): BCRE.label}
MARKS: dict[str, Look] = {
    "survives": {"marker": "o", "color": "#3b8f5a"},
    "survives, step lowered": {"marker": "v", "color": "#c9962b"},
    REFUSED: {"marker": "s", "color": "#1f5a99", "markerfacecolor": "none"},
    FAILS: {"marker": "X", "color": "#a01c1c"},
}


def _draw_runs(axis: Axes, table: pd.DataFrame) -> None:
    names = list(dict.fromkeys(table["scene"]))
    columns = list(COLUMNS)
    found: dict[str, list[tuple[int, int]]] = {mark: [] for mark in MARKS}
    for row in table.itertuples():
        step = "fixed" if row.step not in ("", "auto") else row.step
        word = str(row.verdict)
        mark = "survives, step lowered" if "lowered" in word else word
        place = columns.index((row.model, row.scheme, step)), names.index(row.scene)
        found[mark].append(place)
    for mark, places in found.items():
        if places:
            x, y = zip(*places, strict=True)
            axis.plot(x, y, linestyle="", markersize=7, label=mark, **MARKS[mark])
    axis.set_xticks(range(len(columns)), list(COLUMNS.values()), rotation=35, ha="right")
    axis.set_yticks(range(len(names)), names)
    axis.set(xlim=(-0.5, len(columns) - 0.5), ylim=(len(names) - 0.5, -0.5))
    axis.legend(loc="lower center", bbox_to_anchor=(0.3, 1.0), ncols=2)
