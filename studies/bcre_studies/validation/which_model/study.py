r"""Which model has which property? The models that the paper cites, beside BCRE and the automaton.

The four observations of the paper, in one model after another:

* *returns to Sc*: S - Sc at t = 2000 of figure 1 (S0 - Sc = 3.2) undisturbed, after a pulse of 1,
  and after the same on S0 - Sc = 0.5;
* *smooths*: the part of the RMS of ``rough_slope`` that is left, kappa = 0;
* *goes uphill*: how far above the pulse of figure 3 the surface changes;
* *second critical slope*: the gentlest slope, of those a tenth apart up to S0 - Sc = 4, on which a
  pulse of 1e-6 brings the top of figure 1 down by t = 6000; pulses of 1 and 10 likewise.

The models, in u = h + Sc x and s = S - Sc, with the scenes' v, D and gamma:

    height alone         f = (1/4) max(0, h(i) - h(i+1) - Sc d), the pulse laid on
    Hwa-Kardar           u_t = D u_xx - (v/2) (u^2)_x, the pulse laid on
    Prigozhin-Zaltzman   S <= Sc, h_t + q_x = 0, q > 0 only at Sc
    BCRE                 R_t + (v R - D R_x)_x = gamma R s = -h_t; de Gennes 1995 has D = 0
    Aradian et al.       R_t + (v R + gamma R^2/2 - D R_x)_x = s gamma R/(1 + gamma R/v) = -h_t
    Hadeler-Kuttler      R_t + (v R S/Sc)_x = gamma R (abs(S) - Sc) = -h_t

The automaton of a closure is the two-layer rule with that flux and that exchange. Its R(x) is
compared with that of the model, as it stands and with D_eff and kappa_eff of the cells.

The top has come down where its upper tenth has lost half of the excess height (S0 - Sc) L. The
slope from which on a pulse brings it down is found to 0.01 on finer and finer cells.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import pandas as pd

from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.verdict import Verdict, worst
from bcre_studies.comparison.wording import joined, sentences, when
from bcre_studies.reporting import style
from bcre_studies.sweeps.parallel import each
from bcre_studies.validation.which_model.closures import CLOSURES, SCENES, TOLERANCE, pair, profile
from bcre_studies.validation.which_model.converged import thresholds_claim
from bcre_studies.validation.which_model.picture import draw_table
from bcre_studies.validation.which_model.properties import (
    NEVER,
    PULSES,
    SUBJECTS,
    WORDS,
    YES,
    properties,
)
from bcre_studies.validation.which_model.thresholds import CASES, thresholds

if TYPE_CHECKING:
    from matplotlib.figure import Figure

CONTINUOUS = tuple(subject.name for subject in SUBJECTS if subject.closure and not subject.is_rule)
"""The two-layer models that are equations."""

VANISHING = f"least, pulse {PULSES[0]:g}"
WORD_WHY = "a word, by the definitions of ``properties``"


def run() -> dict[str, pd.DataFrame]:
    """The properties of every model, R(x) of every closure, and thresholds on finer cells."""
    rows = each(properties, range(len(SUBJECTS)), "which_model")
    cases = [(closure, name) for closure in CLOSURES for name in SCENES]
    profiles = each(profile, cases, "which_model, profiles")
    found = each(thresholds, CASES, "which_model, thresholds")
    return {
        "comparison": pd.DataFrame(rows),
        "profiles": pd.DataFrame(profiles),
        "thresholds": pd.DataFrame([row for rows in found for row in rows]),
    }


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """Whether the continuous models share the four observations, and their automata those."""
    table = tables["comparison"].set_index("model")
    models = table.loc[list(CONTINUOUS)]
    return [
        _shared(
            models,
            "return to repose",
            "returns to Sc",
            "Continuous two-layer models return to repose after an avalanche.",
            models["returns to Sc"] != NEVER,
            "after a pulse",
        ),
        _shared(
            models,
            "smoothing",
            "smooths",
            "Continuous two-layer models smooth the surface.",
            models["smooths"] == YES,
            "roughness left",
        ),
        _shared(
            models,
            "second critical slope",
            "second critical slope",
            "Continuous two-layer models have a second critical slope.",
            models["second critical slope"] == YES,
            VANISHING,
        ),
        _closures_claim(table),
        _profiles_claim(tables["profiles"]),
        thresholds_claim(tables["thresholds"]),
    ]


def _shared(
    models: pd.DataFrame, name: str, column: str, statement: str, has: pd.Series, number: str
) -> Claim:
    """A property that all continuous two-layer models would have to share."""
    cells = joined(
        f"{model}: {row[column]} ({_number(number, row[number])})"
        for model, row in models.iterrows()
    )
    return Claim(
        name,
        statement,
        Verdict.AGREE if bool(has.all()) else Verdict.DISAGREE,
        f"{int(has.sum())} of {len(has)} do. {cells}",
        WORD_WHY,
    )


def _number(name: str, value: float) -> str:
    if name == "after a pulse":
        return f"S - Sc = {value:g} in the end"
    if name == "roughness left":
        return f"{value:g} left"
    return f"from S0 - Sc = {value:g} on" if math.isfinite(value) else "up to S0 - Sc = 4 on none"


def _closures_claim(table: pd.DataFrame) -> Claim:
    """Whether the words of each automaton are those of its model."""
    other: list[str] = []
    for closure in CLOSURES:
        model, rule = pair(closure)
        for word in WORDS:
            here, there = table.loc[model.name, word], table.loc[rule.name, word]
            if here != there:
                other.append(f"{rule.name} {word}: {there}, its model: {here}")
    bare = table.loc["automaton, D = 0"]
    return Claim(
        "automaton of each closure",
        "The two-layer automaton has the properties of the model whose closure it is given.",
        Verdict.DISAGREE if other else Verdict.AGREE,
        sentences(
            f"{len(CLOSURES) * len(WORDS) - len(other)} of {len(CLOSURES) * len(WORDS)} are the "
            "same",
            when(other, "; ".join(other)),
            when(
                bare["second critical slope"] == YES,
                "D_eff of the cells makes a second critical slope even where D = 0: there a "
                f"vanishing pulse climbs from S0 - Sc = {bare[VANISHING]:g} on",
            ),
        ),
        WORD_WHY,
    )


def _profiles_claim(rows: pd.DataFrame) -> Claim:
    cells = joined(
        f"{row.closure}, {row.scene}: {row.difference:g}, with D_eff and kappa_eff "
        f"{row.difference_effective:g}"
        for row in rows.itertuples()
    )
    return Claim(
        "profiles of each closure",
        "The automaton of a closure has the rolling layer of its model.",
        worst(rows["verdict"]),
        f"Differences of R: {cells}",
        f"{TOLERANCE:.0%} of the area under R, as in ``paper_figures``",
    )


def draw(tables: dict[str, pd.DataFrame]) -> Figure:
    """The table of models and properties, with the numbers that decide."""
    style.use()
    return draw_table(tables["comparison"])
