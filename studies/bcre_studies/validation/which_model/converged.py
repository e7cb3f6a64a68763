"""Whether the slope from which on a pulse runs to the top is known, and to what it converges."""

from __future__ import annotations

import pandas as pd

from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.comparison.wording import joined, sentences, when
from bcre_studies.observables.outcome import FALLEN
from bcre_studies.validation.which_model.properties import LONGEST
from bcre_studies.validation.which_model.thresholds import EQUATION, NEAR, RULE


def thresholds_claim(rows: pd.DataFrame) -> Claim:
    """BCRE's thresholds do not move with its grid, and the automaton's come nearer to them."""
    usual = rows[(rows["t"] == LONGEST) & (rows["top loses"] == FALLEN)]
    bcre, rule = (_by_cells(usual, model) for model in (EQUATION, RULE))
    moved = float((bcre.iloc[-1] - bcre.iloc[-2]).abs().max())
    gaps = (rule - bcre.iloc[-1]).abs()
    nearer = bool((gaps.diff().dropna() < 0).all(axis=None))
    coarse = rows[(rows["model"] == RULE) & (rows["cells"] == rule.index[0])]
    by_part = coarse[coarse["t"] == LONGEST].groupby("pulse")["threshold"].agg(_range).max()
    by_time = coarse[coarse["top loses"] == FALLEN].pivot(
        index="t", columns="pulse", values="threshold"
    )
    sparse = _by_cells(usual, RULE, "first of sparse slopes").iloc[0]
    return Claim(
        "thresholds on finer cells",
        "The slope from which on a pulse brings the top down is converged in BCRE, and the "
        "automaton's converges to it.",
        Verdict.AGREE if moved <= NEAR and nearer else Verdict.DISAGREE,
        sentences(
            f"S0 - Sc for pulses of {joined(f'{pulse:g}' for pulse in bcre.columns)}: BCRE "
            + joined((f"{_row(bcre, n)} on {n:g} cells" for n in bcre.index), "; "),
            "The automaton " + joined((f"{_row(rule, n)} on {n:g}" for n in rule.index), "; "),
            f"At d = 1 it moves by {by_part:.2g} where another part of the excess height counts as "
            "down, and with the time allowed: "
            + joined((f"{_row(by_time, t)} by t = {t:g}" for t in by_time.index), "; "),
            when(
                (sparse > rule.iloc[0] + NEAR).all(),
                "Of the slopes of ``second_critical_angle``, which lie farther apart, the first "
                f"that comes down is {joined(f'{excess:g}' for excess in sparse)}",
            ),
        ),
        f"{NEAR:g} between the last two grids of BCRE, twice what a threshold is known to",
    )


def _by_cells(rows: pd.DataFrame, model: str, column: str = "threshold") -> pd.DataFrame:
    """Cells down, pulses across."""
    return rows[rows["model"] == model].pivot(index="cells", columns="pulse", values=column)


def _range(found: pd.Series) -> float:
    return float(found.max() - found.min())


def _row(table: pd.DataFrame, line: float) -> str:
    return joined(f"{value:g}" for value in table.loc[line])
