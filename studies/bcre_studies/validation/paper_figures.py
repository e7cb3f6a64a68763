r"""The paper's three figures, run in both models from the same initial condition.

Compared is the rolling layer R(x) at the end: the relative L1 difference of the automaton, with
cells of d = 1, 1/2 and 1/4, from BCRE as it stands and from BCRE with the coefficients of the
automaton's modified equation (Warming and Hyett 1974; ``bcre_ca.theory``)

    D_eff = D + (v d/2)(1 - v dt/d)        kappa_eff = gamma d/2

The paper gives v, D and gamma of its figures 1 to 3; all else is ours and stands in the scenes.
Figure 1 is compared at t = 250, in mid-climb, with dt = 0.4 d; figures 2 and 3 at their end. Since
a climb multiplies every early difference, figure 1 (above both critical slopes, and between them)
is also compared by what no shift in time changes: the time in which the scarp climbs from 10 % to
90 % of the way from the pulse to the top.

The columns "difference calibrated" and "difference limited" are those of the automaton's two other
schemes (``bcre_ca.Rule``) from BCRE as it stands, each with the step that it chooses ("auto").
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.compare import Measure, compare, refine
from bcre_studies.comparison.difference import relative_difference
from bcre_studies.comparison.error import relative_error
from bcre_studies.comparison.rounding import significant
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.models.effective import effective
from bcre_studies.models.registry import AUTOMATON, BCRE, COMPARED, MODELS
from bcre_studies.models.run import Run, frame_times
from bcre_studies.observables.fronts import scarps
from bcre_studies.reporting import style
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.scene import Scene, load
from bcre_studies.sweeps.parallel import each

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

TOLERANCE = 0.05
WHY = (
    "of the area under R: about the width of a line in the paper's figures, below which "
    "its reader could not tell the two apart"
)
REFINEMENTS = (1, 2, 4)
FIGURES = ("figure1", "figure2", "figure3")
SCHEMES = ("calibrated", "limited")
"""The automaton's schemes besides the paper's."""
FRAMES = 5
STANDING = 0.01
"""A scarp stands once it has this part of its final height."""
CLIMBS = ("figure1", "figure1_between")
PROFILE, CLIMB = "R(x) at the end", "time from 10 % to 90 % of the climb"


def figure_scene(name: str, refinement: int) -> Scene:
    """The scene of one of the paper's figures on cells ``refinement`` times smaller."""
    scene = load(name)
    cells = scene.domain.cells * refinement
    if name == "figure1":
        return scene.with_changes(cells=cells, until=250.0, step=0.4 / refinement)
    return scene.with_changes(cells=cells, step=0.2 / refinement)


def run() -> dict[str, pd.DataFrame]:
    """The table of differences, and the profiles that the figure shows."""
    cases = [(name, refinement) for name in FIGURES for refinement in REFINEMENTS]
    cases += [(name, 0) for name in CLIMBS]
    rows = each(_compare_case, cases, "paper_figures")
    return {
        "comparison": pd.DataFrame(rows),
        "profiles": pd.concat([_profiles(name) for name in FIGURES], ignore_index=True),
    }


def _compare_case(case: tuple[str, int]) -> dict[str, Any]:
    name, refinement = case
    if refinement == 0:
        return _compare_climb(name)
    scene = figure_scene(name, refinement)
    x, times, grids = scene.centres(), [scene.time.until], {"coarsest": 200, "finest": 800}

    def measure(run: Run) -> Array:
        return run.sample(x)

    result = compare(scene, times, measure, TOLERANCE, **grids)
    with_D_eff = effective(scene, with_curvature=False)
    spread = refine(with_D_eff, times, measure, result.automaton, TOLERANCE, **grids)
    return {
        "quantity": PROFILE,
        "case": name,
        "d": scene.d,
        **result.row(),
        "difference_with_D_eff": significant(
            relative_difference(result.automaton, spread.value), 3
        ),
        "difference_with_D_eff_error": significant(relative_error(spread), 1),
        **_of_schemes(scene, times, measure, result.pde.value),
    }


def _of_schemes(
    scene: Scene, times: Sequence[float], measure: Measure, pde: ArrayLike
) -> dict[str, float]:
    """Relative difference of the automaton from BCRE as it stands, in its other schemes."""
    runs = {
        scheme: AUTOMATON.run(scene.with_changes(scheme=scheme, step="auto"), times)
        for scheme in SCHEMES
    }
    return {
        f"difference_{scheme}": significant(relative_difference(measure(run), pde), 3)
        for scheme, run in runs.items()
    }


def _compare_climb(name: str) -> dict[str, Any]:
    scene = load(name).with_changes(step=0.2)
    times = frame_times(scene, 201)
    result = compare(scene, times, climb_time, TOLERANCE, coarsest=100, finest=400)
    return {
        "quantity": CLIMB,
        "case": name,
        "d": scene.d,
        **result.row(),
        **_of_schemes(scene, times, climb_time, result.pde.value),
    }


def climb_time(run: Run) -> float:
    """Time in which the scarp climbs from 10 % to 90 % of the way from the pulse to the top."""
    heights, places = scarps(run)
    start = float(run.x[np.argmax(run.R[0])])
    climbed = np.where(heights > STANDING * heights.max(), (start - places) / start, 0.0)
    highest = np.maximum.accumulate(climbed)
    if highest[-1] < 0.9:
        return math.nan
    before, after = (float(np.interp(part, highest, run.t)) for part in (0.1, 0.9))
    return after - before


def _profiles(name: str) -> pd.DataFrame:
    """Frames of the models; BCRE on 400 cells, four times the automaton's."""
    scene = figure_scene(name, 1)
    times = frame_times(scene, FRAMES)
    runs = [model.run(scene, times, None if model is AUTOMATON else 400) for model in COMPARED]
    return pd.concat([run.to_dataframe(figure=name) for run in runs])


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """One claim a figure, judged on the paper's own cells, d = 1."""
    table = tables["comparison"]
    claims = []
    for name in FIGURES:
        rows = table[(table["case"] == name) & (table["quantity"] == PROFILE)]
        coarse, fine = rows.iloc[0], rows.iloc[-1]
        claims.append(
            Claim(
                name=f"{name} profile",
                statement=f"The automaton's rolling layer in {name} is that of BCRE.",
                verdict=Verdict(coarse["verdict"]),
                evidence=(
                    f"relative L1 difference at d = 1: {coarse['difference']:.3g} from BCRE as it "
                    f"stands, "
                    f"{coarse['difference_effective']:.2g} from BCRE with D_eff and kappa_eff; "
                    f"at d = 1/4: {fine['difference']:.3g} and {fine['difference_effective']:.2g}"
                ),
                tolerance=f"{TOLERANCE:.0%} {WHY}",
            )
        )
    return [*claims, *(_climb_claim(table, name) for name in CLIMBS), _schemes_claim(table)]


def _schemes_claim(table: pd.DataFrame) -> Claim:
    """Judged where BCRE as it stands is resolved."""
    rows = table[(table["quantity"] == PROFILE) & (table["verdict"] != str(Verdict.UNRESOLVED))]
    columns = [f"difference_{scheme}" for scheme in SCHEMES]
    nearer = bool((rows[columns].max(axis=1) < rows["difference"]).all())
    listed = "; ".join(
        f"{row['case']}, d = {row['d']:g}: {row['difference']:.2g}, "
        + ", ".join(f"{row[column]:.2g}" for column in columns)
        for _, row in rows.iterrows()
    )
    return Claim(
        name="other schemes",
        statement="The calibrated and the limited scheme are nearer to BCRE as it stands than the "
        "paper's, on the same cells.",
        verdict=Verdict.UNRESOLVED if rows.empty else Verdict.AGREE if nearer else Verdict.DISAGREE,
        evidence=f"relative L1 difference of R from BCRE as it stands, of the paper's, the "
        f"calibrated and the limited scheme: {listed or 'none is resolved'}",
        tolerance="nearer in every resolved row: a scheme that is not would be of no use",
    )


def _climb_claim(table: pd.DataFrame, name: str) -> Claim:
    row = table[(table["case"] == name) & (table["quantity"] == CLIMB)].iloc[0]
    return Claim(
        name=f"{name} climb",
        statement=f"The scarp of {name} climbs in the automaton in the time it takes in BCRE.",
        verdict=Verdict(row["verdict"]),
        evidence=f"from 10 % to 90 % of the climb: {row.automaton:.4g} in the automaton, "
        f"{row.pde:.3g} ± {row.pde_error:.1g} in BCRE with kappa = 0, "
        f"{row.pde_effective:.4g} ± {row.pde_effective_error:.1g} with D_eff and kappa_eff",
        tolerance=f"{TOLERANCE:.0%} of the time, as for the profiles",
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
        _mark_unresolved(axis, tables["comparison"], frames, name)
        last = frames["t"].max()
        axis.set_title(f"Figure {name[-1]}: t = 0 to {last:g}", loc="left")
        axis.set_xlabel("x (downhill)")
        axis.set_ylabel("static layer h" if column == "h" else "rolling layer R")
    style.legend(figure, COMPARED, start=True)
    return figure


def _mark_unresolved(axis: Axes, table: pd.DataFrame, frames: pd.DataFrame, name: str) -> None:
    """Say at the steepest place of the last PDE profile where its position is the grid's."""
    row = table[(table["case"] == name) & (table["quantity"] == PROFILE)].iloc[0]
    if row["verdict"] != str(Verdict.UNRESOLVED):
        return
    line = frames[(frames["model"] == BCRE.name) & (frames["t"] == frames["t"].max())]
    steepest = int(np.argmin(np.diff(line["h"])))
    place = (line["x"].iloc[steepest], line["h"].iloc[steepest] / 2)
    text = "BCRE unresolved:\nits place is the grid's"
    axis.annotate(text, place, (-8, 0), textcoords="offset points", ha="right", fontsize=8)
