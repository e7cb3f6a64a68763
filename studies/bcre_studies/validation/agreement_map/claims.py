"""The word for all of the space, for the rules that predict it, and for the thresholds."""

from __future__ import annotations

import pandas as pd

from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.models.registry import BCRE
from bcre_studies.validation.agreement_map.comparison import FIT_SEED, TEST_SEED
from bcre_studies.validation.agreement_map.measured import FAILED, TOLERANCE, WHY
from bcre_studies.validation.agreement_map.prediction import largest_broadening
from bcre_studies.validation.agreement_map.pulses import Pulse
from bcre_studies.validation.agreement_map.rules import THICK, Rule, judged, missed, rules
from bcre_studies.validation.agreement_map.thresholds import PECLETS, THICKNESSES

ACCURATE = 0.95
WHY_ACCURATE = "of the scenes: a rule that a user trusts may be wrong once in twenty"

Tables = dict[str, pd.DataFrame]


def judge(tables: Tables) -> list[Claim]:
    """The word for all of the space, the rules that tell where they agree, the thresholds."""
    table = tables["comparison"].set_index(["quantity", "case"])
    scenes = tables["scenes"]
    fitted, tested = (judged(scenes[scenes["seed"] == seed]) for seed in (FIT_SEED, TEST_SEED))
    of_rule = rules(fitted)
    return [
        _agreement(table),
        _one_number(table, of_rule, len(fitted), tested),
        _three_terms(table, of_rule),
        _slopes(tables["comparison"]),
    ]


def _one_number(
    table: pd.DataFrame, of_rule: list[Rule], fitted: int, tested: list[tuple[Pulse, str]]
) -> Claim:
    by_peclet, by_r, *_ = of_rule
    too_strict, too_lax = missed(by_r, tested)
    changing = sum(abs(pulse.growth) > 1 for pulse in too_lax)
    return _rule_claim(
        "bound on r",
        "One number, r, tells whether the automaton agrees with BCRE.",
        table.loc[("rule is right", by_r.name)],
        f"r = v d (1 - c) t/(w^2/2 + 2 D t) <= {largest_broadening(TOLERANCE):.3f} is right of "
        f"{{share}}; a bound on Pe alone, the best of {fitted} other scenes, of "
        f"{_share(table.loc[('rule is right', by_peclet.name)])}. Beyond the bound on r "
        f"{len(too_strict)} scenes agree; within it {len(too_lax)} do not, {changing} of "
        "which grow or decay by more than e, |G| > 1",
    )


def _three_terms(table: pd.DataFrame, of_rule: list[Rule]) -> Claim:
    *_, by_terms, by_moments = of_rule
    exact = table.loc[("rule is right", by_moments.name)]
    words = table.loc[("verdict is right", "exact moments, which of three words")]
    thick = [table.loc[("rule is right", f"{rule.name}; a e^G > {THICK[1]:g}")] for rule in of_rule]
    bound = largest_broadening(TOLERANCE)
    return _rule_claim(
        "cell size and time step",
        "Cell size and time step tell whether the automaton agrees with BCRE.",
        table.loc[("rule is right", by_terms.name)],
        f"the width r, the lag c d G and the lost mass G^2 dt/(2 t), their squares added, are "
        f"right of {{share}}; exact moments of {_share(exact)}, and they tell the three words "
        f"apart in {_share(words)}. Of thick pulses, a e^G > {THICK[1]:g}, the two are "
        f"right of {_share(thick[-2])} and {_share(thick[-1])}. How fine must d be? "
        f"For {TOLERANCE:.0%} in R, d (1 - c) must not exceed {bound:.2g} (w^2/2 + 2 D t)/(v t), "
        f"which is {2 * bound:.2g} D/v once diffusion has outgrown the pulse, and where the pulse "
        f"grows dt must not exceed {2 * TOLERANCE:g} t/G^2",
    )


def _share(row: pd.Series) -> str:
    return f"{row['automaton']:.1%} ({row['low']:.1%} to {row['high']:.1%})"


def _agreement(table: pd.DataFrame) -> Claim:
    of = {word: table.loc[("share of scenes", word)] for word in (*map(str, Verdict), FAILED)}
    agree, explained = of[Verdict.AGREE], of[Verdict.EXPLAINED]
    if agree["low"] >= ACCURATE:
        verdict = Verdict.AGREE
    elif agree["automaton"] + explained["automaton"] >= ACCURATE:
        verdict = Verdict.EXPLAINED
    else:
        verdict = Verdict.DISAGREE
    evidence = "; ".join(
        f"{word} {row['count'].split()[0]}, {_share(row)}" for word, row in of.items()
    )
    return Claim(
        "whole space",
        "The automaton does what BCRE does, wherever in the space of its parameters.",
        verdict,
        f"of the scenes {evidence}. The change of h differs by at most {TOLERANCE:.0%} in "
        f"{_share(table.loc[('share of scenes', 'h within the tolerance')])}. The shares are those "
        f"of the ranges that were drawn from",
        f"{TOLERANCE:.0%} {WHY}; {ACCURATE:.0%} {WHY_ACCURATE}",
    )


def _rule_claim(name: str, statement: str, row: pd.Series, evidence: str) -> Claim:
    return Claim(
        name,
        statement,
        Verdict.AGREE if row["automaton"] >= ACCURATE else Verdict.DISAGREE,
        evidence.format(share=_share(row)),
        f"{ACCURATE:.0%} {WHY_ACCURATE}; agreement is {TOLERANCE:.0%} {WHY}",
    )


def _slopes(comparison: pd.DataFrame) -> Claim:
    rows = comparison[comparison["quantity"].str.startswith("s at")].set_index("case")
    finest = rows.loc[[f"a = {a:g}, Pe = {PECLETS[0]:g}" for a in THICKNESSES]]
    coarse = rows.loc[[f"a = {a:g}, Pe = 1" for a in THICKNESSES]]
    worst = rows["difference"].max()
    return Claim(
        "slope at which a pulse runs to the top",
        "A finite pulse needs the same slope to run to the top in the automaton as in BCRE.",
        Verdict.AGREE if worst <= TOLERANCE else Verdict.DISAGREE,
        f"with a = {', '.join(f'{a:g}' for a in THICKNESSES)} it takes s = "
        f"{', '.join(f'{s:.2f}' for s in coarse[BCRE.column])} in BCRE, "
        f"{', '.join(f'{s:.2f}' for s in coarse['automaton'])} in the automaton at Pe = 1 and "
        f"{', '.join(f'{s:.2f}' for s in finest['automaton'])} at Pe = {PECLETS[0]:g}. The "
        f"automaton's differ by {rows['difference'].min():.0%} to {worst:.0%}",
        f"{TOLERANCE:.0%} of the slope's excess over repose",
    )
