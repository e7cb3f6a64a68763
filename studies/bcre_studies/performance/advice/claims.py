"""Whether what is advised, extrapolated and cheapest is so."""

from __future__ import annotations

import pandas as pd

from bcre_studies.comparison.claim import Claim, quality_check
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.comparison.wording import joined
from bcre_studies.performance.advice.drawn import FEW
from bcre_studies.performance.advice.truth import OBSERVED, TOLERANCE
from bcre_studies.performance.record.record import recorded as recorded_tables

MET = 0.95
WHY_MET = "one scene in twenty may be missed, as with any 95 % statement"
DEARER = 2.0
IN_TIME = 0.9
WHY_DEARER = "a factor of 2 is what the predicted times themselves are good for"


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """Whether what is advised, extrapolated and cheapest is so."""
    table = tables["comparison"]
    return [
        *(_met(table[table["observable"] == name], name) for name in OBSERVED),
        _from_coarse_pilots(tables["extrapolated"]),
        _cheapest(tables["cheapest"]),
        _in_time(recorded_tables("advice")["advice"]),
    ]


def _met(table: pd.DataFrame, observable: str) -> Claim:
    judged = table[table["result"] != "unresolved"]
    met = judged[judged["result"] == "met"]
    share = len(met) / len(judged)
    off = (met["true_error"] / met["predicted_error"]).agg(["min", "max"])
    forms = judged["closed_form_error"].dropna()
    return quality_check(
        name=f"tolerance met in {observable}",
        statement=f"The advised model meets a tolerance of {TOLERANCE:.0%} of {observable} in at "
        f"least {MET:.0%} of random scenes.",
        verdict=Verdict.AGREE if share >= MET else Verdict.DISAGREE,
        evidence=f"{len(met)} of {len(judged)} scenes ({share:.0%}); {len(table) - len(judged)} "
        f"more are unresolved, {(judged['result'] == 'declined').sum()} got no advice; the true "
        f"error is {off['min']:.2g} to {off['max']:.2g} times the predicted one. {len(forms)} "
        f"have a closed form too, whose error is {forms.max():.2g} at most",
        tolerance=WHY_MET,
    )


def _from_coarse_pilots(table: pd.DataFrame) -> Claim:
    met = table[table["result"] == "met"]
    share = len(met) / len(table)
    far = (table["cells"] / FEW).max()
    return quality_check(
        name="extrapolated from coarse pilots",
        statement=f"Where pilots end at {FEW} cells, a scheme that is predicted to meet the "
        f"tolerance on finer ones meets it in at least {MET:.0%} of the cases.",
        verdict=Verdict.AGREE if share >= MET else Verdict.DISAGREE,
        evidence=f"{len(met)} of {len(table)} ({share:.0%}), on grids up to {far:.3g} times finer "
        f"than the finest pilot; the largest error is {table['true_error'].max():.2g}",
        tolerance=WHY_MET,
    )


def _cheapest(table: pd.DataFrame) -> Claim:
    judged = table[table["result"].isin(["met", "missed"])]
    good = judged[(judged["result"] == "met") & (judged["dearer"] <= DEARER)]
    honest = not (table["result"] == "not said").any()
    worst = judged.loc[judged["dearer"].idxmax()]
    silent = table.loc[table["result"] == "unresolved", "scene"]
    return quality_check(
        name="the cheapest",
        statement="In the built-in scenes and one more the advised model costs at most "
        f"{DEARER:g} times the cheapest that meets the tolerance, and where BCRE does not "
        "converge the advice says so.",
        verdict=Verdict.AGREE if honest and len(good) == len(judged) else Verdict.DISAGREE,
        evidence=f"{len(good)} of {len(judged)} scenes; the dearest advice costs "
        f"{worst['dearer']:.2g} times the cheapest ({worst['scene']}: {worst['advised']} on "
        f"{worst['cells']:.0f} cells, {worst['cheapest']} on {worst['cheapest_cells']:.0f}); in "
        f"steps alone, without the time that frames take, up to "
        f"{judged['dearer_in_steps'].max():.2g} times. Unresolved, and said to be: "
        f"{joined(silent)}",
        tolerance=f"{DEARER:g}: {WHY_DEARER}",
    )


def _in_time(times: pd.DataFrame) -> Claim:
    """Hits of the predicted times in the committed record of speed."""
    options = times[times["pilots"] == "all"]
    advised = options[options["advised"]]
    coarse = times[times["pilots"] == "coarse"]
    share = float(advised["hit"].mean())
    return quality_check(
        name="predicted time",
        statement=f"The predicted time of the advised model is within a factor of 2 of the "
        f"measured one in at least {IN_TIME:.0%} of random scenes.",
        verdict=Verdict.AGREE if share >= IN_TIME else Verdict.DISAGREE,
        evidence=f"{int(advised['hit'].sum())} of {len(advised)} scenes ({share:.0%}) in the "
        f"record of speed; of all models with pilots as fine as they are advised "
        f"{int(options['hit'].sum())} of {len(options)}, of those predicted from coarse pilots "
        f"{int(coarse['hit'].sum())} of {len(coarse)}",
        tolerance="a factor of 2: runs of a tenth of a millisecond differ by as much from one to "
        "the next",
    )
