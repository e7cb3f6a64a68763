r"""How fast roughness decays: rates and phase speeds of single Fourier modes, and a rough slope.

The paper's second property. A mode e^(j k x + s t) of small amplitude on the repose slope has

    of u = h + Sc x, under a uniform rolling layer R0:    s = j gamma R0 k - kappa R0 k^2
    of R:                                                 s = -j v k - D k^2

in BCRE (``bcre_pde.theory``): with kappa = 0 roughness of the surface is carried uphill at gamma R0
and does not decay at all. The automaton's rates are exact too (``bcre_ca.theory``): its one-sided
slope smooths, to first order as

    kappa_eff = (gamma d/2)(1 - c), c = gamma R0 dt/d        D_eff = D + (v d/2)(1 - v dt/d)

* Decay rates are compared relative to the automaton's own, since BCRE's may be zero; phase speeds
  relative to gamma R0 and v.
* The scene ``rough_slope`` has waves of finite height: compared is the root mean square of u.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.compare import compare_each
from bcre_studies.comparison.rounding import significant
from bcre_studies.comparison.verdict import Verdict, worst
from bcre_studies.comparison.wording import sentences, when
from bcre_studies.models.registry import AUTOMATON, BCRE, COMPARED, EFFECTIVE, MODELS, Model
from bcre_studies.models.run import Run
from bcre_studies.observables import fronts
from bcre_studies.reporting import style
from bcre_studies.scenes.scene import load
from bcre_studies.scenes.terms import NOISE_WAVES
from bcre_studies.sweeps.parallel import each
from bcre_studies.validation.roughness_decay.modes import (
    CELLS,
    R_DECAY,
    R_SPEED,
    TOLERANCE,
    U_DECAY,
    U_SPEED,
    WHY,
    mode_rates,
    mode_rows,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LONG = 2 * np.pi / 12
"""Largest k d of a long wave, twelve cells: up to there the automaton differs from its modified
equation by less than 5 %, by the part (k d)^2/12 of its decay and (k d)^2/6 of its speed."""
THEORY_TOLERANCE = 1e-3
THEORY_WHY = "both sides are linear; what is left is the finite height of the waves and rounding"

HEIGHT = 0.1
"""Root mean square of the noise in the scene ``rough_slope``."""
TIMES = tuple(float(t) for t in np.linspace(0, 200, 21))
SHOWN = (50.0, 100.0, 200.0)

RMS = "RMS of u on rough_slope"
Row = dict[str, Any]


def run() -> dict[str, pd.DataFrame]:
    """Modes of u and R at d = 1 and d = 1/2, and the rough slope."""
    cases: list[tuple[str, float]] = [(field, d) for field in "uR" for d in CELLS]
    modes = each(mode_rows, cases, "roughness_decay")
    table, series = _rough_slope()
    return {
        "comparison": pd.DataFrame([row for rows in modes for row in rows] + table),
        "rough_slope": series,
    }


def _rough_slope() -> tuple[list[Row], pd.DataFrame]:
    """RMS of u at some times, compared; and at all times, with the linear closed forms."""
    scene = load("rough_slope").with_changes(step=1.0)
    k = 2 * np.pi * np.arange(1, NOISE_WAVES + 1) / scene.domain.length

    def linear(model: Model, t: float) -> float:
        decays = [mode_rates("u", scene.d, wave)[model].real for wave in k]
        return float(HEIGHT * np.sqrt(np.mean(np.exp(2 * t * np.array(decays)))))

    def measured(run: Run) -> list[float]:
        return [fronts.roughness(u) for u in run.u[1:]]

    results = compare_each(
        scene, [0.0, *SHOWN], measured, [HEIGHT] * len(SHOWN), TOLERANCE, finest=800
    )
    table = [
        {
            "quantity": RMS,
            "d": scene.d,
            "k": np.nan,
            "k d": np.nan,
            "t": t,
            **result.row(linear(AUTOMATON, t), linear(BCRE, t)),
        }
        for t, result in zip(SHOWN, results, strict=True)
    ]
    runs = {
        model: model.run(scene, TIMES, None if model is AUTOMATON else 400) for model in COMPARED
    }
    series = pd.DataFrame(
        {
            "model": model.name,
            "t": t,
            "RMS": significant(fronts.roughness(u), 4),
            "closed form": significant(linear(model, t), 4),
        }
        for model, run in runs.items()
        for t, u in zip(run.t, run.u, strict=True)
    )
    return table, series


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """Long waves of u and of R, short waves, the closed forms, and the rough slope."""
    table = tables["comparison"]
    modes = table[table["quantity"] != RMS]
    long, short = modes[modes["k d"] <= LONG], modes[modes["k d"] > LONG]
    return [
        _surface_claim(long[long["quantity"] == U_DECAY]),
        _rolling_claim(long[long["quantity"] == R_DECAY]),
        *(_cause_claim(long[long["quantity"] == q], where) for q, where in CAUSES),
        _speed_claim(long[long["quantity"].isin([U_SPEED, R_SPEED])]),
        _short_claim(short),
        _theory_claim(modes),
        _rough_slope_claim(table[table["quantity"] == RMS]),
    ]


def _claim(name: str, statement: str, rows: pd.DataFrame, evidence: str) -> Claim:
    verdict = worst(rows["verdict"])
    return Claim(name, statement, verdict, evidence, f"{TOLERANCE:.0%} {WHY}")


def _surface_claim(rows: pd.DataFrame) -> Claim:
    coarse = rows[rows["d"] == 1].iloc[-1]
    fine = rows[(rows["d"] < 1) & (rows["k"] == coarse["k"])].iloc[0]
    still = rows.pde.abs().max()
    verdict = worst(rows["verdict"])
    return _claim(
        "roughness of the surface, long waves",
        "Roughness of the surface decays in the automaton as it does in BCRE.",
        rows,
        sentences(
            f"largest decay rate in BCRE with kappa = 0: {still:.0e}; in the automaton at "
            f"k = {coarse['k']:.2g}: {coarse.automaton:.2g} at d = 1 and {fine.automaton:.2g} at "
            f"d = {fine['d']:g}; with kappa_eff = (gamma d/2)(1 - c) BCRE's rates differ by "
            f"{rows['difference_effective'].max():.1g} at most",
            when(
                (rows.pde.abs() < TOLERANCE * rows.automaton).all(),
                "BCRE only carries roughness of the surface uphill",
            ),
            when(
                verdict is Verdict.EXPLAINED and fine.automaton < coarse.automaton,
                "the automaton's smoothing goes with its cell and is no property of sand",
            ),
        ),
    )


def _rolling_claim(rows: pd.DataFrame) -> Claim:
    nominal, left = (rows.groupby("d")[f"difference{kind}"].max() for kind in ("", "_effective"))
    return _claim(
        "roughness of the rolling layer, long waves",
        "Roughness of the rolling layer decays in the automaton as it does in BCRE.",
        rows,
        f"smallest decay rates {rows.automaton.min():.2g} in the automaton and {rows.pde.min():.2g}"
        f" in BCRE; of the automaton's rate D alone leaves out {nominal[CELLS[0]]:.2g} at d = 1 "
        f"and {nominal[CELLS[1]]:.2g} at d = {CELLS[1]:g}, D_eff at most {left.max():.1g}",
    )


CAUSES = ((U_DECAY, "surface"), (R_DECAY, "rolling layer"))


def _cause_claim(rows: pd.DataFrame, where: str) -> Claim:
    """BCRE with kappa = 0 has no other term that could smooth."""
    share = rows.pde / rows.automaton
    return Claim(
        f"diffusion smooths the {where}",
        f"The diffusion term of the model smooths the {where}.",
        Verdict.AGREE if (share >= TOLERANCE).all() else Verdict.DISAGREE,
        f"of the automaton's decay rate BCRE with kappa = 0 has {share.min():.2g} to "
        f"{share.max():.2g}",
        f"at least {TOLERANCE:.0%} of the automaton's rate: less would not be seen in it",
    )


def _speed_claim(rows: pd.DataFrame) -> Claim:
    largest = rows.groupby("quantity")["difference"].max()
    return _claim(
        "speeds, long waves",
        "Roughness of u is carried uphill at gamma R0, that of R downhill at v, in both models.",
        rows,
        f"largest difference {largest[U_SPEED]:.2g} for u and {largest[R_SPEED]:.1g} for R, at "
        f"k d up to {rows['k d'].max():.2g}",
    )


def _short_claim(rows: pd.DataFrame) -> Claim:
    shortest = rows[(rows["k d"] == rows["k d"].max())].set_index("quantity")
    return _claim(
        "short waves",
        "Waves of less than twelve cells decay and travel in the automaton as in BCRE.",
        rows,
        f"at k d = {shortest['k d'].iloc[0]:.2g}, automaton against BCRE with D_eff and kappa_eff: "
        + "; ".join(
            f"{quantity} {shortest.automaton[quantity]:.2g} against "
            f"{shortest.pde_effective[quantity]:.2g}"
            for quantity in (U_DECAY, U_SPEED, R_DECAY, R_SPEED)
        ),
    )


def _theory_claim(rows: pd.DataFrame) -> Claim:
    decays = rows["quantity"].isin([U_DECAY, R_DECAY])
    scale = rows.automaton_theory.where(decays, rows.pde_theory)
    own, pde = (
        float(((rows[model.column] - rows[f"{model.column}_theory"]).abs() / scale).max())
        for model in (AUTOMATON, BCRE)
    )
    agrees = own <= THEORY_TOLERANCE and pde <= TOLERANCE
    return Claim(
        name="closed forms",
        statement="Every mode decays and travels in either model as that model's closed form says.",
        verdict=Verdict.AGREE if agrees else Verdict.DISAGREE,
        evidence=f"relative to its scale within {own:.0e} in the automaton and {pde:.0e} in BCRE",
        tolerance=(
            f"{THEORY_TOLERANCE:.1%} for the automaton: {THEORY_WHY}; {TOLERANCE:.0%} for BCRE, "
            "whose grid is refined only until it resolves the difference"
        ),
    )


def _rough_slope_claim(rows: pd.DataFrame) -> Claim:
    last = rows.iloc[-1]
    return _claim(
        "rough slope under steady flow",
        "A rough slope under a steady rolling layer gets as smooth in the automaton as in BCRE.",
        rows,
        f"of a root mean square of {HEIGHT:g} at the start {last.automaton:.2g} is left at "
        f"t = {last['t']:g} in the automaton, {last.pde:.3g} in BCRE with kappa = 0 and "
        f"{last.pde_effective:.2g} with D_eff and kappa_eff (at most "
        f"{rows['difference_effective'].max():.1g} of the start off at any time). The automaton's "
        f"linear modes give {last.automaton_theory:.2g}",
    )


def draw(tables: dict[str, pd.DataFrame]) -> Figure:
    """Closed forms as lines, measurements as markers; hollow at d = 1/2."""
    table = tables["comparison"]
    figure, axes = style.panels(2, 2)
    panels = ((U_DECAY, "1/time"), (U_SPEED, "length/time"), (R_DECAY, "1/time"))
    for axis, (quantity, unit) in zip(axes, panels, strict=False):
        for d in CELLS:
            _draw_modes(axis, table[(table["quantity"] == quantity) & (table["d"] == d)], quantity)
        axis.set(xlabel="wavenumber k (1/length)", ylabel=f"{quantity} ({unit})")
    for name, line in tables["rough_slope"].groupby("model", sort=False):
        model = MODELS[str(name)]
        axes[3].plot(line["t"], line["closed form"], **model.line)
        axes[3].plot(line["t"], line["RMS"], **model.markers())
    axes[3].set(xlabel="t", ylabel="root mean square of u (length)")
    axes[3].set_ylim(bottom=0)
    titles = ("(a) surface", "(b) surface", "(c) rolling layer", "(d) rough_slope, d = 1")
    for axis, title in zip(axes, titles, strict=True):
        axis.set_title(title, loc="left")
    style.legend(figure, COMPARED, markers=True)
    return figure


def _draw_modes(axis: Axes, rows: pd.DataFrame, quantity: str) -> None:
    d = float(rows["d"].iloc[0])
    k = np.linspace(0.01, 1.03 * rows["k"].max(), 80)
    rates = [
        mode_rates("u" if quantity in (U_DECAY, U_SPEED) else "R", d, float(each)) for each in k
    ]
    for model in (BCRE, EFFECTIVE, AUTOMATON):
        values = np.array([rate[model] for rate in rates])
        line = values.imag / k if quantity == U_SPEED else -values.real
        axis.plot(k, line, **model.line)
        axis.plot(rows["k"], rows[model.column], **model.markers(hollow=d < 1))
    axis.annotate(
        f"d = {d:g}", (k[-1], line[-1]), (3, 2 if d == 1 else -9), textcoords="offset points"
    )
