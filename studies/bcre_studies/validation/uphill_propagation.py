r"""How avalanches propagate uphill: four mechanisms, each measured by itself.

The paper's third property. In BCRE with kappa = 0 (``bcre_pde.theory``)

    (a) rolling front    V = 2 sqrt(D sigma) - v, sigma = gamma (S - Sc), on a frozen slope S
    (b) surface wave     gamma R0, of u under a uniform rolling layer
    (c) scarp            c = gamma H - v, sharp and H high (mass balance)
    (d) reach            x_start - x_end, of the region that figure 3's pulse affects

and ``bcre_ca.theory`` has the automaton's (a) and (b). Only (a) needs a slope above Sd.

* (a) starts from R = 1e-150, so that the full equations stay linear, and follows the level
  R = const t^(-1/2). Differences are relative to V + v, the speed against the drift: V itself
  vanishes at Sd.
* (b) takes the phase of a Fourier mode after a quarter of a turn.
* (c) compares at equal height: at equal time the climb multiplies every early difference. The
  pulse is so thick that gamma R far exceeds V and raises a scarp at once; with D = 1 that scarp
  is resolved without kappa.
* (d) The edge lies where R, or the change of h, first exceeds 1 % of its largest value, and the
  reach is how far uphill of the pulse's own edge at the start that is. Negative: swept downhill.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

import bcre_ca.theory
import bcre_pde.theory
from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.compare import compare_each
from bcre_studies.comparison.rounding import significant
from bcre_studies.comparison.verdict import Verdict, worst
from bcre_studies.models.automaton import rule_of
from bcre_studies.models.registry import AUTOMATON, BCRE, COMPARED
from bcre_studies.models.run import Run
from bcre_studies.observables import fronts
from bcre_studies.reporting import style
from bcre_studies.scenes.domain import Domain
from bcre_studies.scenes.scene import Scene, Time, load
from bcre_studies.scenes.terms import Incline, Sine, Uniform
from bcre_studies.sweeps.parallel import each

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

TOLERANCE = 0.05
WHY = (
    "of the speed: over the 100 lengths of the paper's figures an arrival 5 lengths apart; "
    "of the initial pulse's half-width for the reach, under half of the automaton's cell"
)
THEORY_TOLERANCE = 0.005
THEORY_WHY = (
    "what remains of the expansion in 1/t after three frames at sigma t > 2 is well below 0.5 %"
)

FRONT, WAVE, SCARP = "front speed V", "surface wave speed", "scarp speed c"
REACH_R, REACH_H = "reach of R", "reach of the change of h"
QUANTITIES = (FRONT, WAVE, SCARP, REACH_R, REACH_H)

CELLS = (1.0, 0.25)
EXCESSES = (1.2, 2.1, 3.2, 5.0)
LAYERS = (1.0, 2.0, 5.0, 10.0, 20.0)
HEIGHTS = (30.0, 40.0, 50.0)
WAVELENGTH = 20.0
EDGE = 0.01
FIGURE3_EXCESS, PULSE_WIDTH = -0.02, 4.0
HALF_WIDTH = PULSE_WIDTH * math.sqrt(-math.log(EDGE))
"""From the centre of figure 3's pulse to its edge at the start."""

Row = dict[str, Any]
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


def front(d: float, excess: float) -> list[Row]:
    """(a) on the slope Sc + excess, from 2.4 to 9.6 or more growth times after the release."""
    scene = load("figure1").with_changes(
        **{"length": 160.0, "cells": round(160 / d), "until": 800.0, "step": 0.4 * d},
        **{
            "surface.0.slope": 0.5 + excess,
            "rolling.0.amplitude": 1e-150,
            "rolling.0.centre": 120.0,
        },
    )
    times = [200.0, 400.0, 800.0]
    v, D, sigma = scene.material.v, scene.material.D, scene.material.gamma * excess
    width = 3.0
    release = 1e-150 * width / (2 * np.sqrt(D * times[0]))
    theory = bcre_pde.theory.uphill_front_speed(v, D, sigma)
    (result,) = compare_each(
        scene,
        times,
        lambda run: [fronts.front_speed(run, release)],
        [v + theory],
        TOLERANCE,
        coarsest=80,
        finest=640,
    )
    own_theory = bcre_ca.theory.uphill_front_speed(v, D, sigma, d, 0.4 * d)
    return [_row(FRONT, d, "S - Sc", excess, result.row(own_theory, theory))]


def wave(d: float, R0: float) -> list[Row]:
    """(b) for one wave of 20 lengths, 1e-6 high, under R0."""
    material = load("rough_slope").material
    theory = material.gamma * R0
    k = 2 * np.pi / WAVELENGTH
    span = WAVELENGTH / theory / 4
    scene = Scene(
        title="One wave of the surface under a uniform rolling layer",
        material=material,
        domain=Domain(length=WAVELENGTH, cells=round(WAVELENGTH / d), ends="periodic"),
        time=Time(until=span, step=0.4 * d),
        surface=(
            Incline(kind="incline", slope=material.Sc),
            Sine(kind="sine", amplitude=1e-6, wavelength=WAVELENGTH),
        ),
        rolling=(Uniform(kind="uniform", amplitude=R0),),
    )
    rule = rule_of(scene)

    def speed(run: Run) -> list[float]:
        return [fronts.mode_rate(run.x, run.u[0], run.u[1], span, k).imag / k]

    (result,) = compare_each(
        scene,
        [0.0, span],
        speed,
        [theory],
        TOLERANCE,
        coarsest=20,
        finest=160,
    )
    own_theory = bcre_ca.theory.surface_mode_rate(rule.gamma, R0, d, rule.dt, k).imag / k
    return [_row(WAVE, d, "gamma R0", theory, result.row(own_theory, theory))]


def scarp(d: float) -> list[Row]:
    """(c) above a pulse 100 high at the foot of a slope Sc + 1, at several heights."""
    scene = load("figure1").with_changes(
        **{"D": 1.0, "length": 80.0, "cells": round(80 / d), "until": 280.0},
        **{"step": 0.4 if d == 1 else 0.4 * d**2, "surface.0.slope": 1.5},
        **{"rolling.0.amplitude": 100.0, "rolling.0.centre": 70.0},
    )
    times = [float(t) for t in np.arange(0.0, 281.0, 2.0)]
    material = scene.material
    laws = [bcre_pde.theory.scarp_speed(material.v, material.gamma, H) for H in HEIGHTS]
    results = compare_each(
        scene,
        times,
        lambda run: [fronts.scarp_speed(run, H) for H in HEIGHTS],
        laws,
        TOLERANCE,
        coarsest=80,
        finest=640,
    )
    return [
        _row(SCARP, d, "H", H, result.row(np.nan, law))
        for H, law, result in zip(HEIGHTS, laws, results, strict=True)
    ]


def reach(d: float) -> list[Row]:
    """(d) in figure 3."""
    scene = load("figure3").with_changes(cells=round(100 / d), step=0.2 * d)

    def reaches(run: Run) -> list[float]:
        change = np.abs(run.u[1] - run.u[0])
        start, *ends = (
            fronts.exponential_edge(run.x, values, EDGE * values.max())
            for values in (run.R[0], run.R[1], change)
        )
        return [start - end for end in ends]

    results = compare_each(
        scene, [0.0, scene.time.until], reaches, [HALF_WIDTH] * 2, TOLERANCE, finest=800
    )
    theory = closed_reaches(scene, scene.material.D)
    rule = rule_of(scene)
    own_theory = closed_reaches(scene, rule.effective_diffusion(), rule.dt)
    return [
        _row(quantity, d, "", np.nan, result.row(own, nominal))
        for quantity, result, own, nominal in zip(
            (REACH_R, REACH_H), results, own_theory, theory, strict=True
        )
    ]


def closed_reaches(scene: Scene, D: float, dt: float = 0.0) -> tuple[float, float]:
    """Reach of R and of the change of h on a frozen slope, where the pulse stays Gaussian.

    Its squared width is w^2 + 4 D t, its centre v t downhill; h changes as the integral of R over
    time, which explicit steps of dt take at their beginnings.
    """
    material, until = scene.material, scene.time.until
    x, t = np.linspace(-50, 50, 4001), np.linspace(0, until, 501)[:, None]
    square = PULSE_WIDTH**2 + 4 * D * t
    sigma = material.gamma * FIGURE3_EXCESS
    R = np.exp(sigma * t - (x - material.v * t) ** 2 / square) / np.sqrt(square)
    change = np.trapezoid(R, t, axis=0) + dt / 2 * (R[0] - R[-1])
    start, end, changed = (
        fronts.edge(x, values, EDGE * values.max()) for values in (R[0], R[-1], change)
    )
    return start - end, start - changed


def _row(quantity: str, d: float, argument: str, value: float, row: Row) -> Row:
    value = significant(value, 5)
    return {"quantity": quantity, "d": d, "argument": argument, "value": value, **row}


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
    evidence = (
        f"relative to V + v it climbs up to {coarse['difference'].max():.2g} faster at d = 1 and "
        f"{fine['difference'].max():.2g} at d = 1/4, as upwind differences spread R by v d/2 more; "
        f"once D_eff is counted {coarse['difference_effective'].max():.1g} and "
        f"{fine['difference_effective'].max():.1g} are left"
    )
    for _, row in coarse[coarse.automaton * coarse.pde < 0].iterrows():
        evidence += (
            f". At S - Sc = {row['value']:g}, between the two Sd, the automaton's front climbs "
            f"(V = {row.automaton:.4f}) where that of BCRE is swept down ({row.pde:.4f})"
        )
    statement = "The automaton's rolling layer climbs a steep slope at the speed of BCRE's."
    return _claim("rolling front", statement, coarse, evidence)


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
        f"at wavelength {WAVELENGTH:g} the automaton is slower by {coarse['difference'].max():.2g} "
        f"at most at d = 1 and {fine['difference'].max():.1g} at d = 1/4, the dispersion (k d)^2/6 "
        f"of its cells, for gamma R0 from {coarse['value'].min():g} to {coarse['value'].max():g}",
    )


def _scarp_claim(table: pd.DataFrame) -> Claim:
    coarse, fine = (_of(table, SCARP, d).iloc[-1] for d in CELLS)
    return _claim(
        "scarp",
        "A scarp climbs in the automaton as fast as one of equal height does in BCRE.",
        _of(table, SCARP),
        f"at H = {coarse['value']:g} c is {coarse.automaton:.3f} at d = 1 and "
        f"{fine.automaton:.3f} at d = 1/4, but {coarse.pde:.3g} ± {coarse.pde_error:g} in "
        f"BCRE: the automaton's scarp is some cells wide, so that less R stands where it climbs. "
        f"kappa_eff makes BCRE's as wide: {coarse.pde_effective:.3f} and "
        f"{fine.pde_effective:.3f}. A sharp scarp would climb at {coarse.pde_theory:.3g}; "
        f"BCRE's own is {1 - coarse.pde / coarse.pde_theory:.0%} slower, as R runs ahead by "
        f"D/(v + c) and erodes the slope above it",
    )


def _reach_claim(table: pd.DataFrame) -> Claim:
    rolling, surface = (_of(table, quantity).iloc[0] for quantity in (REACH_R, REACH_H))
    centre = HALF_WIDTH + surface[[model.column for model in COMPARED]]
    return _claim(
        "reach in figure 3",
        "Figure 3's avalanche affects as much of the slope above its start in both models.",
        pd.DataFrame([rolling, surface]),
        f"the edge of R ends {-rolling.automaton:.1f} downhill of its start in the automaton, "
        f"{-rolling.pde:.1f} in BCRE, {-rolling.pde_effective:.1f} with D_eff: S is below Sd "
        f"and all is swept down. h changes from {centre.automaton:.1f} above the pulse's centre "
        f"in the automaton, {centre.pde:.1f} in BCRE, {centre.pde_effective:.1f} with D_eff; "
        f"the automaton besides takes R at the beginning of each step, v dt/2 uphill. "
        f"These are cells on which the pulse itself lay (its edge was {HALF_WIDTH:.1f} above its "
        f"centre), and in this sense alone the region affected includes cells above the start",
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
    material = load("figure1").material
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
        lines = [bcre_pde.theory.scarp_speed(v, gamma, H) for H in x]
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
