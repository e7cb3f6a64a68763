r"""The paper's three figures, run in both models from the same initial condition.

Compared is the rolling layer R(x) at a fixed time: the relative L1 difference of the automaton,
with cells of d = 1, 1/2 and 1/4, from BCRE as it stands and from BCRE with the coefficients of the
automaton's modified equation (Warming and Hyett 1974; ``bcre_ca.theory``)

    D_eff = D + (v d/2)(1 - v dt/d)        kappa_eff = gamma d/2

The paper gives v, D and gamma of its figures 1 to 3; all else is ours and stands in the scenes.
Figures 2 and 3 are compared at their end, with dt = 0.2 d. Figure 1 (dt = 0.4 d) is compared at
t = 180 and 200, just after its climbing wave has steepened into a scarp at t = 175, on up to 3200
cells, and judged where they resolve BCRE. The time of the paper's picture, t = 250, is drawn, and
judged with D_eff and kappa_eff only.

A climb multiplies every early difference. Figure 1, above both critical slopes and between them, is
therefore also compared by a time that no shift changes: that in which the scarp climbs from 10 % to
90 % of the way from the pulse to the top (dt = 0.2).

The columns "upwind auto", "calibrated" and "limited" hold the difference from BCRE as it stands of
the automaton's three schemes (``bcre_ca.Rule``), each with the step that it chooses by itself.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.compare import compare
from bcre_studies.comparison.verdict import Verdict, worst
from bcre_studies.models.bcre import SHARE
from bcre_studies.models.registry import AUTOMATON, BCRE, COMPARED, MODELS, SCHEMES
from bcre_studies.models.run import frame_times
from bcre_studies.observables.fronts import climb_time
from bcre_studies.reporting import style
from bcre_studies.scenes.scene import load
from bcre_studies.sweeps.parallel import each
from bcre_studies.validation.paper_figures.layers import (
    PICTURE,
    PROFILE,
    REFINEMENTS,
    TOLERANCE,
    WHY,
    column_of,
    compared,
    figure_scene,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FIGURES = ("figure1", "figure2", "figure3")
FRAMES = 5
CLIMBS = {"figure1": "figure 1", "figure1_between": "figure 1 between the two critical slopes"}
CLIMB = "time from 10 % to 90 % of the climb"
Row = dict[str, Any]


def run() -> dict[str, pd.DataFrame]:
    """The table of differences, and the profiles that the figure shows."""
    rows = compared() + each(_compare_climb, tuple(CLIMBS), "paper_figures, climbs")
    return {
        "comparison": pd.DataFrame(rows),
        "profiles": pd.concat([_profiles(name) for name in FIGURES], ignore_index=True),
    }


def _compare_climb(name: str) -> Row:
    scene = load(name).with_changes(step=0.2)
    times = frame_times(scene, 201)
    result = compare(scene, times, climb_time, TOLERANCE, coarsest=50, finest=400)
    return {"quantity": CLIMB, "case": name, "t": np.nan, "d": scene.d, **result.row()}


def _profiles(name: str) -> pd.DataFrame:
    """Frames of the models; BCRE on 400 cells, four times the automaton's."""
    scene = figure_scene(name, 1)
    times = frame_times(scene, FRAMES)
    runs = [model.run(scene, times, None if model is AUTOMATON else 400) for model in COMPARED]
    return pd.concat([run.to_dataframe(figure=name) for run in runs])


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """One claim a figure, judged on the paper's own cells, d = 1; climbs; schemes; cells."""
    table = tables["comparison"]
    judged, picture, climbs = (table[table["quantity"] == q] for q in (PROFILE, PICTURE, CLIMB))
    return [
        *(_profile_claim(judged[judged["case"] == name], name) for name in FIGURES),
        _with_own(
            picture[picture["d"] == 1].iloc[0],
            "figure1 profile at t = 250, effective",
            "At t = 250 the automaton's rolling layer in figure1 is that of BCRE with D_eff and "
            "kappa_eff.",
        ),
        *(claim for name in CLIMBS for claim in _climb_claims(climbs[climbs["case"] == name])),
        *(_nearer_claim(judged, scheme) for scheme in SCHEMES if scheme != "upwind"),
        _cell_claim(judged),
    ]


def _profile_claim(rows: pd.DataFrame, name: str) -> Claim:
    own = rows[rows["d"] == 1]
    resolved = own[own["verdict"] != Verdict.UNRESOLVED]
    return Claim(
        name=f"{name} profile",
        statement=f"The automaton's rolling layer in {name} is that of BCRE, at the times at which "
        "BCRE is resolved.",
        verdict=worst(resolved["verdict"]) if len(resolved) else Verdict.UNRESOLVED,
        evidence="relative L1 difference from BCRE as it stands, and with D_eff and kappa_eff: "
        + "; ".join(
            f"t = {row['t']:g}, d = {row['d']:g}: {row['difference']:.3g} and "
            f"{row['difference_effective']:.2g}" + _doubt(row)
            for _, row in rows.iterrows()
            if row["d"] in (1, 1 / REFINEMENTS[-1])
        ),
        tolerance=f"{TOLERANCE:.0%} {WHY}",
    )


def _doubt(row: pd.Series[Any]) -> str:
    if row["verdict"] != Verdict.UNRESOLVED:
        return ""
    return f" (error of BCRE as it stands {row['difference_error']:.1g})"


def _with_own(row: pd.Series[Any], name: str, statement: str) -> Claim:
    """Judged by BCRE with D_eff and kappa_eff alone, where BCRE as it stands is not resolved.

    A gap that exceeds the tolerance by more than the error is a disagreement.
    """
    gap, error = row["difference_effective"], row["difference_effective_error"]
    resolved = error <= SHARE * max(gap, TOLERANCE) or gap - error > TOLERANCE
    good = Verdict.AGREE if gap <= TOLERANCE else Verdict.DISAGREE
    return Claim(
        name=name,
        statement=statement,
        verdict=good if resolved else Verdict.UNRESOLVED,
        evidence=f"relative difference {gap:.3g}, error of BCRE {error:.1g}",
        tolerance=f"{TOLERANCE:.0%}, as for the profiles",
    )


def _climb_claims(rows: pd.DataFrame) -> tuple[Claim, Claim]:
    """Against BCRE as it stands, and against BCRE with D_eff and kappa_eff."""
    row = rows.iloc[0]
    name = f"{row['case']} climb"
    statement = (
        f"The scarp of {CLIMBS[row['case']]} climbs in the automaton in the time it takes in BCRE"
    )
    nominal = Claim(
        name=name,
        statement=f"{statement}.",
        verdict=Verdict(row["verdict"]),
        evidence=f"from 10 % to 90 % of the climb: {row.automaton:.4g} in the automaton, "
        f"{row.pde:.3g} ± {row.pde_error:.1g} in BCRE with kappa = 0, "
        f"{row.pde_effective:.4g} ± {row.pde_effective_error:.1g} with D_eff and kappa_eff",
        tolerance=f"{TOLERANCE:.0%} of the time, as for the profiles",
    )
    return nominal, _with_own(row, f"{name}, effective", f"{statement} with D_eff and kappa_eff.")


def _nearer_claim(rows: pd.DataFrame, scheme: str) -> Claim:
    """In every profile that is judged, also where a scarp stands."""
    gain = rows[column_of("upwind")] - rows[column_of(scheme)]
    error = 2 * rows["difference_error"]
    nearer, farther = gain > error, gain < -error
    if nearer.all():
        verdict, shown = Verdict.AGREE, rows
    elif farther.any():
        verdict, shown = Verdict.DISAGREE, rows[farther]
    else:
        verdict, shown = Verdict.UNRESOLVED, rows[~nearer]
    listed = "; ".join(
        f"{row['case']}, t = {row['t']:g}, d = {row['d']:g}: {row[column_of(scheme)]:.2g} against "
        f"{row[column_of('upwind')]:.2g}"
        for _, row in shown.iterrows()
    )
    where = {Verdict.AGREE: "", Verdict.DISAGREE: ", where it is farther"}
    return Claim(
        name=f"{scheme} scheme",
        statement=f"The {scheme} scheme is nearer to BCRE as it stands than the paper's rule, on "
        "the same cells.",
        verdict=verdict,
        evidence=f"nearer in {nearer.sum()} of {len(rows)} profiles. Relative L1 difference of R, "
        f"{scheme} against the paper's rule{where.get(verdict, ', where none is nearer')}: "
        f"{listed}",
        tolerance="nearer in every profile by more than twice the error of BCRE, each scheme with "
        "the step that it chooses",
    )


def _cell_claim(rows: pd.DataFrame) -> Claim:
    """By the triangle inequality two runs differ by at least what their differences differ by."""
    ends = rows.set_index(["case", "t"])
    coarse, fine = (ends[ends["d"] == d] for d in (1.0, 1 / REFINEMENTS[-1]))
    error = coarse["difference_error"] + fine["difference_error"]
    apart = (coarse["difference"] - fine["difference"]).abs() - error
    return Claim(
        name="no matter of cells",
        statement="What the automaton computes does not depend on the length of its cells.",
        verdict=Verdict.AGREE if (apart <= TOLERANCE).all() else Verdict.DISAGREE,
        evidence="relative L1 difference of R from BCRE as it stands at d = 1 and d = 1/4: "
        + "; ".join(
            f"{case}, t = {t:g}: {coarse['difference'][case, t]:.2g} and "
            f"{fine['difference'][case, t]:.2g}"
            for case, t in coarse.index
        ),
        tolerance=f"{TOLERANCE:.0%} {WHY}; by the triangle inequality the two runs differ by at "
        "least as much as these two numbers",
    )


def draw(tables: dict[str, pd.DataFrame]) -> Figure:
    """The paper's figures again: h for figure 1, R for figures 2 and 3, both models."""
    table = tables["profiles"]
    figure, axes = style.panels(1, 3)
    for axis, name in zip(axes, FIGURES, strict=True):
        column = "h" if name == "figure1" else "R"
        frames = table[table["figure"] == name]
        for model, lines in frames.groupby("model", sort=False):
            for t, line in lines.groupby("t"):
                look = MODELS[str(model)].line if t > 0 else style.START
                axis.plot(line["x"], line[column], **look)
        if name == "figure1":
            _mark_unresolved(axis, tables["comparison"], frames)
        last = frames["t"].max()
        axis.set_title(f"Figure {name[-1]}: t = 0 to {last:g}", loc="left")
        axis.set_xlabel("x (downhill)")
        axis.set_ylabel("static layer h" if column == "h" else "rolling layer R")
    style.legend(figure, COMPARED, start=True)
    return figure


def _mark_unresolved(axis: Axes, table: pd.DataFrame, frames: pd.DataFrame) -> None:
    """Say at the steepest place of the last PDE profile that its place depends on the grid."""
    row = table[table["quantity"] == PICTURE].iloc[0]
    if row["verdict"] != str(Verdict.UNRESOLVED):
        return
    line = frames[(frames["model"] == BCRE.name) & (frames["t"] == frames["t"].max())]
    steepest = int(np.argmin(np.diff(line["h"])))
    place = (line["x"].iloc[steepest], line["h"].iloc[steepest] / 2)
    text = "BCRE unresolved:\nthe grid sets\nits place"
    axis.annotate(text, place, (-8, 0), textcoords="offset points", ha="right", fontsize=8)
