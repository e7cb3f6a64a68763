"""Rules that predict whether the automaton agrees with BCRE, and how often they are right."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import pandas as pd
from scipy.stats import binomtest

from bcre_studies.comparison.rounding import significant
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.validation.agreement_map import prediction
from bcre_studies.validation.agreement_map.measured import FAILED, TOLERANCE
from bcre_studies.validation.agreement_map.pulses import Pulse

CONFIDENCE = 0.95

THICK = (0.05, 0.3)
"""a e^G below which a pulse counts as thin, and above which as thick."""

Row = dict[str, Any]


@dataclass(frozen=True)
class Rule:
    """Says of a pulse, before anything is run, whether the models will agree."""

    name: str
    agrees: Callable[[Pulse], bool]


def rules(fitted: list[tuple[Pulse, str]]) -> list[Rule]:
    """From the simplest to the exact; the first is fitted to scenes, the others are derived."""
    largest_peclet = _best_bound(fitted)
    largest_r = prediction.largest_broadening(TOLERANCE)
    return [
        Rule(f"Pe <= {largest_peclet:.2g} (fitted)", lambda pulse: pulse.peclet <= largest_peclet),
        Rule(f"r <= {largest_r:.3f}", lambda pulse: pulse.broadening <= largest_r),
        Rule(
            "width, place and mass",
            lambda pulse: prediction.by_width_place_and_mass(pulse) <= TOLERANCE,
        ),
        Rule(
            "exact moments",
            lambda pulse: prediction.by_moments(pulse, TOLERANCE) is Verdict.AGREE,
        ),
    ]


def judged(table: pd.DataFrame) -> list[tuple[Pulse, str]]:
    """The pulses that were run to their end, and their verdicts."""
    names = [field.name for field in fields(Pulse)]
    ran = table[table["verdict"] != FAILED]
    pulses = [Pulse(**values) for values in ran[names].to_dict("records")]
    return list(zip(pulses, ran["verdict"], strict=True))


def shares(table: pd.DataFrame, tolerance: float) -> list[Row]:
    """How many scenes ended in each word, with the interval of the share; in how many h agrees."""
    words = [str(word) for word in (*Verdict, FAILED)]
    rows = [_row("share of scenes", word, table["verdict"] == word) for word in words]
    near = table["difference_h"] <= tolerance
    return [*rows, _row("share of scenes", "h within the tolerance", near)]


def accuracies(rule: Rule, scenes: list[tuple[Pulse, str]]) -> list[Row]:
    """How often the rule is right about agree or not: of all scenes, and by their thickness."""
    right = np.array([rule.agrees(pulse) == (word == Verdict.AGREE) for pulse, word in scenes])
    thickness = np.array([pulse.final_thickness for pulse, _ in scenes])
    thin, thick = THICK
    parts = {
        rule.name: np.ones_like(right),
        f"{rule.name}; a e^G < {thin:g}": thickness < thin,
        f"{rule.name}; a e^G > {thick:g}": thickness > thick,
    }
    return [_row("rule is right", name, right[part]) for name, part in parts.items()]


def three_words(scenes: list[tuple[Pulse, str]]) -> Row:
    """How often exact moments tell all three words apart."""
    right = [prediction.by_moments(pulse, TOLERANCE) == word for pulse, word in scenes]
    return _row("verdict is right", "exact moments, which of three words", np.array(right))


def missed(rule: Rule, scenes: list[tuple[Pulse, str]]) -> tuple[list[Pulse], list[Pulse]]:
    """Pulses that agree though the rule says no, and that do not though it says yes."""
    too_strict, too_lax = [], []
    for pulse, word in scenes:
        if rule.agrees(pulse) and word != Verdict.AGREE:
            too_lax.append(pulse)
        if not rule.agrees(pulse) and word == Verdict.AGREE:
            too_strict.append(pulse)
    return too_strict, too_lax


def _row(quantity: str, case: str, true: Any) -> Row:
    """A share with its Wilson interval."""
    count, total = int(np.sum(true)), len(true)
    interval = binomtest(count, total).proportion_ci(CONFIDENCE, method="wilson")
    return {
        "quantity": quantity,
        "case": case,
        "count": f"{count} of {total}",
        "automaton": significant(count / total, 3),
        "low": significant(float(interval.low), 3),
        "high": significant(float(interval.high), 3),
    }


def _best_bound(scenes: list[tuple[Pulse, str]]) -> float:
    """The bound on Pe that is right most often: between two scenes, or beside all."""
    peclet = np.array([pulse.peclet for pulse, _ in scenes])
    agree = np.array([word == Verdict.AGREE for _, word in scenes])
    order = np.argsort(peclet)
    right = np.concatenate([[0], np.cumsum(np.where(agree[order], 1, -1))])
    best = int(np.argmax(right))
    edges = np.concatenate([[0.0], peclet[order], [np.inf]])
    return float(np.sqrt(edges[best] * edges[best + 1])) if 0 < best < len(order) else edges[best]
