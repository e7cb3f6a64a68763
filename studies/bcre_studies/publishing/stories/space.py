"""The whole space of parameters, and piles that are driven slowly for long."""

from __future__ import annotations

from bcre_studies.comparison.wording import sentences
from bcre_studies.publishing.stories.story import Story, Tables
from bcre_studies.publishing.wording import fixed, of, percent, span, span_of


def _agreement(tables: Tables) -> list[str]:
    rows = tables["comparison"]
    shares = of(rows, quantity="share of scenes").set_index("case")["automaton"]
    right = of(rows, quantity="rule is right").set_index("case")["automaton"]
    slopes = rows[rows["quantity"].str.startswith("s at")]
    return [
        "Scenes drawn from a Latin hypercube of all dimensionless groups run in both models; "
        "rules that are derived beforehand are tried on them.",
        f"{percent(shares['agree'])} agree to 5 % in R, "
        f"{percent(shares['explained by cell size'])} "
        f"once D_eff and κ_eff are counted; width, place and mass of a thin pulse predict which in "
        f"{percent(right['width, place and mass'])}.",
        f"A finite pulse runs to the top from a slope on that is {span_of(slopes['difference'])} "
        "nearer to repose in the automaton.",
    ]


def _sensitivity(tables: Tables) -> list[str]:
    rows = tables["comparison"]
    leading = rows.loc[rows.groupby("observable")["total_order"].idxmax()].set_index("observable")
    cells = of(rows, parameter="d")["total_order"]
    step = of(rows, parameter="dt")["total_order"]
    return [
        "The variance of each property over the ranges of its eight parameters is shared out "
        "among them.",
        sentences(
            "; ".join(
                f"{name}: {row['parameter']} has part in {percent(row['total_order'])}"
                for name, row in leading.iterrows()
            )
        )
        + ".",
        f"The cells have part in {span_of(cells)}, the step in {span_of(step)}.",
    ]


def _avalanches(tables: Tables) -> list[str]:
    rows = tables["comparison"]
    lengths = of(rows, drive="tilting, length")
    tilted = rows[rows["drive"].isin(["tilting", "tilting, length"])]
    return [
        "A slope is tilted a little at a time, each time with a trigger at a random place, until "
        "nothing rolls; or it is fed grain by grain.",
        f"Tilted, with the thinnest trigger, its big avalanches carry "
        f"{span_of(lengths['share_of_sand'])} of the sand, and start from S − Sc = "
        f"{fixed(float(tilted['start'].min()))} to {fixed(float(tilted['start'].max()))}.",
        f"Fed, the best power law has the exponent "
        f"{span(list(of(rows, drive='feeding')['exponent']), 3)}, by the length of the slope.",
    ]


STORIES: dict[str, Story] = {
    "agreement_map": Story(
        "Where in the space of its parameters does the automaton do what BCRE does?",
        ("r = v d (1 - c) t/(w^2/2 + 2 D t)",),
        "Difference in R and in h over r and growth, the difference against its prediction, and "
        "the slope at which a pulse runs to the top over the cell Peclet number.",
        _agreement,
    ),
    "sensitivity": Story(
        "Which parameter moves which property?",
        ("S_i = Var(E(Y | p_i))/Var(Y)",),
        "First-order and total indices of eight parameters for four properties.",
        _sensitivity,
    ),
    "avalanche_statistics": Story(
        "Do avalanches under slow driving have a size of their own?",
        ("tilting: u + dS (L - x)",),
        "The sawtooth of the slope, also beside BCRE; start slopes over length; sizes under "
        "tilting and under feeding; small avalanches against their prediction.",
        _avalanches,
    ),
}
