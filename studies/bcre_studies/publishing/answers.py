"""The answer in five sentences that hang on the headline's numbers, and how sure it is.

A sentence that draws a conclusion is under the condition that makes it true.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from bcre_studies.publishing.headline import SMALL, Headline
from bcre_studies.publishing.wording import figure_name, fixed, listed, number, percent, span

LEAST = 1e-4
"""Smaller errors are given as this."""


@dataclass(frozen=True)
class Answer:
    """One of the five sentences: what it is about, and what came out."""

    about: str
    text: str


def short_answer(found: Headline) -> str:
    """Yes or no in one sentence."""
    judged = [gap for gap in found.gaps if gap.resolved]
    if judged and all(gap.difference <= SMALL for gap in judged):
        return "Yes: at the paper’s parameters it predicts what BCRE predicts."
    if judged and all(gap.left <= SMALL for gap in judged):
        return (
            "Not as it stands. Nearly all of the difference between the rolling layers comes from "
            "the size of the automaton’s cells."
        )
    return "No: at the paper’s parameters it differs, and its cells do not explain all of it."


def answers(found: Headline) -> list[Answer]:
    """The five sentences of the first screen."""
    return [
        Answer("What the rule is", _rule(found)),
        Answer("What that changes", _change(found)),
        Answer("The second critical slope", _critical(found)),
        Answer("What one pulse does", _pulse(found)),
        Answer("When it is faster", _speed(found)),
    ]


def _rule(found: Headline) -> str:
    most = max(found.diffusion, key=lambda row: row.acting / row.D)
    return (
        "The rule is a first-order upwind scheme of BCRE. Its cells, of length d, add v d/2 to the "
        "diffusion D of the rolling sand, which moves at speed v. They also smooth the surface by "
        "γ d/2, where γ is the rate of exchange between the layers. In "
        f"{figure_name(most.figure)}, D = {number(most.D)} acts as {number(most.acting)}."
    )


def _change(found: Headline) -> str:
    judged = [gap for gap in found.gaps if gap.resolved]
    unjudged = [figure_name(gap.figure) for gap in found.gaps if not gap.resolved]
    if not judged:
        return "BCRE is unresolved in every figure, so nothing can be said."
    apart = listed([f"{percent(gap.difference)} in {figure_name(gap.figure)}" for gap in judged])
    most = percent(max(gap.left for gap in judged))
    text = (
        f"At the paper’s parameters the rolling layers differ by {apart}. With both terms added to "
        f"BCRE, at most {most} is left."
    )
    for gap in judged:
        if gap.until is not None:
            text += (
                f" In {figure_name(gap.figure)} that is at t = {number(gap.until)}; later BCRE is "
                "unresolved."
            )
    if unjudged:
        text += f" {listed(unjudged).capitalize()} cannot be judged: BCRE is unresolved there."
    return text


def _critical(found: Headline) -> str:
    slopes = found.slopes
    lead = (
        "Both have a slope Sd above which any disturbance, however small, brings the whole slope "
        "down. In figure 1 it lies "
    )
    if abs(slopes.automaton / slopes.bcre - 1) <= SMALL:
        return lead + f"{fixed(slopes.automaton)} above repose in both."
    nearer = abs(slopes.finer - slopes.bcre) < abs(slopes.automaton - slopes.bcre)
    finer = f"; cells a quarter as long give {fixed(slopes.finer)}" if nearer else ""
    return (
        lead + f"{fixed(slopes.automaton)} above the repose slope Sc in the automaton and "
        f"{fixed(slopes.bcre)} in BCRE{finer}. Between these slopes the two disagree."
    )


def _pulse(found: Headline) -> str:
    pulses = found.pulses
    start, end = pulses.most_steepened
    start_bcre, end_bcre = pulses.most_steepened_bcre
    in_bcre = ""
    if end_bcre > start_bcre:
        in_bcre = f" (in BCRE from {fixed(start_bcre)} to {fixed(end_bcre)})"
    text = (
        f"In {pulses.cases} runs on slopes above repose, one pulse brought {pulses.came_down} down "
        f"to repose ({pulses.came_down_bcre} in BCRE)."
    )
    if pulses.steeper:
        text += (
            f" In {pulses.steeper} the slope became steeper, at most from {fixed(start)} to "
            f"{fixed(end)} above repose{in_bcre}."
        )
    if pulses.below:
        return text + f" {pulses.below} ended below repose."
    return text + " None ended below repose, although the paper says that they do."


def _speed(found: Headline) -> str:
    coarse, fine = found.coarse, found.fine
    parts: list[str] = []
    if coarse.won:
        parts.append(
            f"Where an error of {percent(coarse.error)} is enough, the automaton is faster in "
            f"{coarse.won} of {coarse.scenes} scenes, by a factor of {span(coarse.by)}."
        )
    finite = [value for value in fine.lost_by if math.isfinite(value)]
    if finite:
        parts.append(
            f"At {percent(fine.error)} BCRE’s solver is faster in {len(fine.lost_by)} of "
            f"{fine.scenes}, by a factor of {number(min(finite), 2)} or more."
        )
    elif fine.won == fine.scenes:
        parts.append(f"At {percent(fine.error)} it is faster in all {fine.scenes}.")
    if fine.better_won:
        parts.append(
            "With a calibrated or a flux-limited step the automaton is the faster in "
            f"{fine.better_won} of {fine.scenes} there too."
        )
    return " ".join(parts) or "Nowhere: BCRE’s solver is the faster at every error asked for."


def certainty(found: Headline) -> list[Answer]:
    """How sure the answer is: three facts."""
    judged = [gap for gap in found.gaps if gap.resolved]
    worst = max((gap.own_error for gap in judged), default=math.inf)
    automaton, bcre = found.orders
    same, tried = found.choices
    facts = []
    if math.isfinite(worst):
        facts.append(
            Answer(
                f"± {percent(max(worst, LEAST))}",
                "at most is BCRE’s own numerical error in these differences; where it is not "
                "small, the verdict is “unresolved”",
            )
        )
    facts += [
        Answer(
            f"± {percent(max(found.slopes.theory_gap, LEAST))}",
            "at most separates a measured Sd from its closed form, in either model",
        ),
        Answer(
            f"{fixed(automaton, 1)} and {fixed(bcre, 1)}",
            "are the orders at which the automaton and BCRE’s solver converge to exact solutions",
        ),
        Answer(
            f"{same} of {tried}",
            "times a verdict stays when a choice of ours is halved or doubled: length, slopes, "
            "pulse, cells",
        ),
    ]
    return facts
