"""Who knows beforehand where a step stops being stable."""

from __future__ import annotations

import pandas as pd

from bcre_studies.comparison.claim import Claim, quality_check
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.comparison.wording import sentences, when
from bcre_studies.models.registry import AUTOMATON
from bcre_studies.verification.stability.beyond import TEN
from bcre_studies.verification.stability.boundaries import GOAL, WHY


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """Who knows beforehand where a step stops being stable."""
    table = tables["comparison"]
    limited = table["variant"] == "limited"
    dop853 = table["variant"] == "DOP853"
    automaton = table["model"] == AUTOMATON.name
    return [
        _predicted("the automaton's rules", table[automaton & ~limited], ""),
        _predicted("the flux-limited rule", table[limited], LIMITED),
        _predicted("BCRE by runge-kutta and RK45", table[~automaton & ~dop853], EXPLICIT, True),
        _predicted("BCRE by DOP853", table[dop853], DOP853, True),
        _bounds(table, tables["positivity"]),
        _implicit_methods(tables["implicit"]),
    ]


LIMITED = (
    "The prediction is that of a limiter that passes every difference or none. What it does to "
    "noise lies between; beyond v dt/d = 1 with much diffusion, where no step may be taken "
    "anyway, this keeps noise calm that either limiter alone would let grow"
)
EXPLICIT = (
    "Fehlberg's method lets smooth waves of 10 to 50 cells grow from v dt/dx = 1.44 on, but by "
    "less than 1e-4 a step up to 1.51, too slowly to be seen in the steps taken"
)
DOP853 = (
    "What the limiter of the differences does changes between its twelve stages, so that the step "
    "is no polynomial of the spectrum; SciPy's error control, not this boundary, keeps its steps "
    "short"
)


def _predicted(what: str, rows: pd.DataFrame, why: str, quality: bool = False) -> Claim:
    wrong, farthest = int(rows["predicted_stable_but_grows"].sum()), rows["distance_percent"].max()
    worst = rows.loc[rows["distance_percent"].idxmax()]
    good = wrong == 0 and farthest <= 100 * GOAL
    return Claim(
        name=f"boundary of {what}",
        statement=f"Of {what} no step predicted stable lets noise grow, and the boundary lies "
        f"within {GOAL:.0%} of the predicted one.",
        verdict=Verdict.AGREE if good else Verdict.DISAGREE,
        evidence=sentences(
            f"{wrong} of {rows['points'].sum()} points are predicted stable but grow; the "
            f"boundary is at most {farthest:g} % away ({worst['variant']}, {worst['plane']}), and "
            f"{rows['distance_visible_percent'].max():g} % from where growth by 10 in the steps "
            "taken is predicted",
            when(not good, why),
        ),
        tolerance=WHY,
        quality=quality,
    )


def _bounds(table: pd.DataFrame, positivity: pd.DataFrame) -> Claim:
    passed = int(table["accepted_but_grows"].sum())
    least = positivity.loc[positivity["least_percent_of_bound"].idxmin()]
    limited = positivity[positivity["variant"] == "limited"].iloc[0]
    good = passed == 0 and (positivity["verdict"] == str(Verdict.AGREE)).all()
    pde = table[table["variant"] == "runge-kutta"]
    return quality_check(
        name="known before it happens",
        statement="No step that a model's own bound lets pass is unstable, and none of the "
        "automaton's makes a layer negative.",
        verdict=Verdict.AGREE if good else Verdict.DISAGREE,
        evidence=f"{passed} of {table['points'].sum()} points are accepted but grow. A rough layer "
        f"stays >= 0 up to {least['least_percent_of_bound']:g} % of the bound ({least['variant']}) "
        f"or more; the limited rule's, which allows for the worst, could be passed by "
        f"{limited['least_percent_of_bound'] - 100:.0f} %. The bound of BCRE's runge-kutta is "
        f"{pde['bound_percent_least'].min()} to {pde['bound_percent_most'].max()} % of the "
        "measured boundary",
        tolerance="none: a bound that is passed once is no bound",
    )


def _implicit_methods(table: pd.DataFrame) -> Claim:
    good = (table["verdict"] == str(Verdict.AGREE)).all()
    return quality_check(
        name="methods without a boundary",
        statement=f"LSODA and BDF stay bounded at {TEN} times the explicit step.",
        verdict=Verdict.AGREE if good else Verdict.DISAGREE,
        evidence="; ".join(
            f"{row['method']}: {'bounded' if row['bounded'] else 'not bounded'}, in steps that are "
            f"{'' if row['mean_step_at_least_ten'] else 'not '}at least {TEN} explicit ones long "
            "in the mean"
            for _, row in table.iterrows()
        ),
        tolerance="no deviation may exceed the largest one at the start",
    )
