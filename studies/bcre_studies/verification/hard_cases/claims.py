"""Finite numbers, mass, failures that say where, and layers that stay positive."""

from __future__ import annotations

import math

import pandas as pd

from bcre_studies.comparison.claim import Claim, quality_check
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.comparison.wording import sentences, when
from bcre_studies.models.registry import AUTOMATON
from bcre_studies.verification.hard_cases import adaptive_step, scarp_grids
from bcre_studies.verification.hard_cases.attempts import FAILS, REFUSED, SURVIVES
from bcre_studies.verification.hard_cases.hard_scenes import long_run

MASS = 1e-12


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
