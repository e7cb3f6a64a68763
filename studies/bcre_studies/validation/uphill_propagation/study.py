r"""How avalanches propagate uphill: four mechanisms, each measured by itself.

The paper's third property. In BCRE with kappa = 0 (``bcre_pde.theory``)

    (a) rolling front    V = 2 sqrt(D sigma) - v, sigma = gamma (S - Sc), on a frozen slope S
    (b) surface wave     gamma R0, of u under a uniform rolling layer
    (c) scarp            c = gamma H - v, sharp and H high (mass balance)
    (d) reach            x_start - x_end, of the region that figure 3's pulse affects

and ``bcre_ca.theory`` has the automaton's (a) and (b). Only (a) needs a slope above Sd.

How each is measured stands in ``mechanisms``.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

import bcre_ca.theory
import bcre_pde.theory
from bcre_pde import simple_wave
from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.verdict import Verdict, worst
from bcre_studies.comparison.wording import sentences, when
from bcre_studies.models.bcre import problem_of
from bcre_studies.models.registry import AUTOMATON, BCRE, COMPARED
from bcre_studies.reporting import style
from bcre_studies.scenes.scene import load
from bcre_studies.sweeps.parallel import each
from bcre_studies.validation.uphill_propagation.mechanisms import (
    CELLS,
    EXCESSES,
    FRONT,
    HALF_WIDTH,
    HEIGHTS,
    LAYERS,
    QUANTITIES,
    REACH_H,
    REACH_R,
    SCARP,
    TOLERANCE,
    WAVE,
    WAVELENGTH,
    WHY,
    Row,
    front,
    reach,
    scarp,
    wave,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

THEORY_TOLERANCE = 0.005
THEORY_WHY = (
    "what remains of the expansion in 1/t after three frames at sigma t > 2 is well below 0.5 %"
)

Mechanism = tuple[Callable[..., list[Row]], tuple[float, ...]]


def run() -> dict[str, pd.DataFrame]:
    """All mechanisms at the paper's cells, d = 1, and at d = 1/4."""
    cases: list[Mechanism] = [(scarp, (d,)) for d in CELLS]
    cases += [(reach, (d,)) for d in CELLS]
    cases += [(front, (d, excess)) for d in CELLS for excess in EXCESSES]
    cases += [(wave, (d, R0)) for d in CELLS for R0 in LAYERS]
    rows = [row for rows in each(_case, cases, "uphill_propagation") for row in rows]
    rows.sort(key=lambda row: QUANTITIES.index(row["quantity"]))
    return {"comparison": pd.DataFrame(rows)}


def _case(case: Mechanism) -> list[Row]:
    function, arguments = case
    return function(*arguments)


def _of(table: pd.DataFrame, quantity: str, d: float = 1.0) -> pd.DataFrame:
    return table[(table["quantity"] == quantity) & (table["d"] == d)]


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """One claim a mechanism, on the paper's own cells, d = 1, and one on the closed form of (a)."""
    table = tables["comparison"]
    claims = (_front_claim, _front_theory_claim, _wave_claim, _scarp_claim, _reach_claim)
    return [claim(table) for claim in claims]


def _claim(name: str, statement: str, rows: pd.DataFrame, evidence: str) -> Claim:
    return Claim(name, statement, worst(rows["verdict"]), evidence, f"{TOLERANCE:.0%} {WHY}")


def _front_claim(table: pd.DataFrame) -> Claim:
    coarse, fine = (_of(table, FRONT, d) for d in CELLS)
    only = coarse[(coarse.automaton > 0) & (coarse.pde < 0)]
    return _claim(
        "rolling front",
        "The automaton's rolling layer climbs a steep slope at the speed of BCRE's.",
        coarse,
        sentences(
            f"largest difference relative to V + v: {coarse['difference'].max():.2g} at d = 1 and "
            f"{fine['difference'].max():.2g} at d = 1/4; with D_eff "
            f"{coarse['difference_effective'].max():.1g} and "
            f"{fine['difference_effective'].max():.1g}",
            *(
                f"at S - Sc = {row['value']:g} the automaton's front climbs (V = "
                f"{row.automaton:.4f}) where that of BCRE is swept down ({row.pde:.4f})"
                for _, row in only.iterrows()
            ),
        ),
    )


def _front_theory_claim(table: pd.DataFrame) -> Claim:
    rows = table[table["quantity"] == FRONT]
    scale = rows["pde_theory"] + load("figure1").material.v
    own, pde = (
        float(((rows[model.column] - rows[f"{model.column}_theory"]).abs() / scale).max())
        for model in (AUTOMATON, BCRE)
    )
    return Claim(
        name="rolling front closed forms",
        statement="In either model the rolling front moves as that model's closed form says.",
        verdict=Verdict.AGREE if max(own, pde) <= THEORY_TOLERANCE else Verdict.DISAGREE,
        evidence=f"relative to V + v within {own:.1g} in the automaton and {pde:.1g} in BCRE",
        tolerance=f"{THEORY_TOLERANCE:.1%}: {THEORY_WHY}",
    )


def _wave_claim(table: pd.DataFrame) -> Claim:
    coarse, fine = (_of(table, WAVE, d) for d in CELLS)
    return _claim(
        "surface wave",
        "Waves of the surface climb at gamma R0 in both models, on a slope at repose.",
        coarse,
        f"at wavelength {WAVELENGTH:g} and gamma R0 from {coarse['value'].min():g} to "
        f"{coarse['value'].max():g} the speeds differ by {coarse['difference'].max():.2g} at most "
        f"at d = 1 and {fine['difference'].max():.1g} at d = 1/4; the dispersion (k d)^2/6 of the "
        f"cells is {(2 * np.pi / WAVELENGTH) ** 2 / 6:.2g} at d = 1",
    )


def _scarp_claim(table: pd.DataFrame) -> Claim:
    rows = _of(table, SCARP)
    coarse, fine = (_of(table, SCARP, d).iloc[-1] for d in CELLS)
    return _claim(
        "scarp",
        "A scarp climbs in the automaton as fast as one of equal height does in BCRE.",
        rows,
        sentences(
            f"at H = {coarse['value']:g} c is {coarse.automaton:.3f} at d = 1 and "
            f"{fine.automaton:.3f} at d = 1/4, {coarse.pde:.3g} ± {coarse.pde_error:g} in BCRE, "
            f"and {coarse.pde_effective:.3f} and {fine.pde_effective:.3f} with D_eff and "
            f"kappa_eff; a sharp scarp would climb at {coarse.pde_theory:.3g}",
            when(
                worst(rows["verdict"]) is Verdict.EXPLAINED,
                "the automaton's scarp is some cells wide, so that less R stands where it climbs; "
                "kappa_eff makes BCRE's as wide",
            ),
        ),
    )


def _reach_claim(table: pd.DataFrame) -> Claim:
    rolling, surface = (_of(table, quantity).iloc[0] for quantity in (REACH_R, REACH_H))
    columns = [model.column for model in COMPARED]
    centre = HALF_WIDTH + surface[columns]
    return _claim(
        "reach in figure 3",
        "Figure 3's avalanche affects as much of the slope above its start in both models.",
        pd.DataFrame([rolling, surface]),
        sentences(
            f"the edge of R moves downhill by {-rolling.automaton:.1f} in the automaton, "
            f"{-rolling.pde:.1f} in BCRE and {-rolling.pde_effective:.1f} with D_eff; h changes "
            f"from {centre.automaton:.1f}, {centre.pde:.1f} and {centre.pde_effective:.1f} above "
            f"the pulse's centre, whose own edge was {HALF_WIDTH:.1f} above it",
            when(
                (rolling[columns] < 0).all() and (surface[columns] < 0).all(),
                "all is swept downhill: of the cells above the start only those change on which "
                "the pulse itself lay",
            ),
        ),
    )


def draw(tables: dict[str, pd.DataFrame]) -> Figure:
    """The four mechanisms: closed forms as lines, measurements as markers, hollow at d = 1/4."""
    table = tables["comparison"]
    figure, axes = style.panels(2, 2)
    labels = ("S - Sc", "gamma R0 (length/time)", "scarp height H (length)")
    titles = (
        "(a) rolling front",
        "(b) surface wave, S = Sc",
        "(c) scarp; line: sharp, c = gamma H - v",
    )
    for axis, quantity, label, title in zip(axes[:3], QUANTITIES, labels, titles, strict=False):
        _closed_forms(axis, quantity)
        for d in CELLS:
            rows = _of(table, quantity, d)
            for model in COMPARED:
                axis.plot(rows["value"], rows[model.column], **model.markers(hollow=d < 1))
        axis.set(xlabel=label, ylabel=f"{quantity} (length/time)")
        axis.set_title(title, loc="left")
    _draw_reach(axes[3], table)
    style.legend(figure, COMPARED, markers=True)
    return figure


def _closed_forms(axis: Axes, quantity: str) -> None:
    material = problem_of(load("figure1")).material
    v, D, gamma = material.v, material.D, material.gamma
    if quantity == FRONT:
        x = np.linspace(0.9 * EXCESSES[0], 1.03 * EXCESSES[-1], 60)
        axis.axhline(0, color="0.3", linewidth=0.8)
        for d in CELLS:
            speeds = [bcre_ca.theory.uphill_front_speed(v, D, gamma * S, d, 0.4 * d) for S in x]
            axis.plot(x, speeds, **AUTOMATON.line)
            axis.annotate(f"d = {d:g}", (x[-1], speeds[-1]), (3, 0), textcoords="offset points")
        lines = [bcre_pde.theory.uphill_front_speed(v, D, gamma * S) for S in x]
    elif quantity == WAVE:
        x = gamma * np.array([0.0, 1.05 * LAYERS[-1]])
        lines = list(x)
    else:
        x = np.array([0.9 * HEIGHTS[0], 1.03 * HEIGHTS[-1]])
        lines = [simple_wave.scarp_speed(material, H) for H in x]
    axis.plot(x, lines, **BCRE.line)


def _draw_reach(axis: Axes, table: pd.DataFrame) -> None:
    places = [(quantity, d) for quantity in (REACH_R, REACH_H) for d in CELLS]
    for place, (quantity, d) in enumerate(places):
        row = _of(table, quantity, d).iloc[0]
        for model in COMPARED:
            axis.plot(row[model.column], place, **model.markers(hollow=d < 1))
    axis.axvline(0, **style.START)
    names = {REACH_R: "R", REACH_H: "change of h"}
    axis.set_yticks(range(len(places)), [f"{names[quantity]}\nd = {d:g}" for quantity, d in places])
    axis.set_ylim(len(places) - 0.5, -0.5)
    axis.set_xlabel("reach above the pulse's edge (length)")
    axis.set_title("(d) reach in figure 3", loc="left")
