"""What becomes of pulses on figure 1's slope, and from which slope on they climb, in all models."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import pandas as pd

import bcre_ca
import bcre_pde
from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.compare import Comparison
from bcre_studies.comparison.rounding import to_error
from bcre_studies.comparison.verdict import Verdict, verdict_of, worst
from bcre_studies.comparison.wording import joined, sentences, when
from bcre_studies.models.effective import effective
from bcre_studies.models.registry import AUTOMATON, BCRE, COMPARED, EFFECTIVE
from bcre_studies.observables.outcome import Outcome
from bcre_studies.validation.second_critical_angle.climb import (
    CELLS,
    Bracket,
    climb,
    pulse_scene,
    threshold,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

TOLERANCE = 0.05
WHY = "of S - Sc: at figure 1's slopes under one degree, as near as a pile's angle is read"
OUTCOME_WHY = "the same word, by the definitions of ``outcome`` and at t = 3000"
OUTCOME, THRESHOLD = "runs to the top?", "threshold S0 - Sc"
FINER = "automaton d/4"
EXCESSES = (0.5, 0.8, 1.0, 1.2, 1.5, 1.8, 2.2, 2.7, 3.2)
PULSES = (1e-6, 1.0, 10.0)
THRESHOLD_PULSES = (1e-6, 1e-4, 1e-2, 0.1, 1.0, 10.0)
LOWEST, HIGHEST = 0.5, 2.75

Row = dict[str, Any]
Case = tuple[Callable[..., Row], tuple[Any, ...]]


def cases() -> list[Case]:
    """Functions that give a row, with their arguments; the slowest first."""
    thresholds: list[Case] = [(threshold_row, (pulse,)) for pulse in THRESHOLD_PULSES]
    return thresholds + [(outcome_row, (excess, pulse)) for excess in EXCESSES for pulse in PULSES]


def outcome_row(excess: float, pulse: float) -> Row:
    """yes, starts or no, in both models; BCRE on two grids."""
    grids = {AUTOMATON: CELLS, BCRE: 2 * CELLS, EFFECTIVE: 2 * CELLS}
    words = {model: climb(model, cells, excess, pulse) for model, cells in grids.items()}
    automaton, pde, effective = words.values()
    verdict = verdict_of(
        float(automaton != pde),
        climb(BCRE, 4 * CELLS, excess, pulse) == pde,
        float(automaton != effective),
        climb(EFFECTIVE, CELLS, excess, pulse) == effective,
        tolerance=0.0,
    )
    return {
        **{"quantity": OUTCOME, "case": "figure 1", "S0 - Sc": excess, "pulse": pulse},
        FINER: str(climb(AUTOMATON, 4 * CELLS, excess, pulse)),
        **{model.column: str(word) for model, word in words.items()},
        "verdict": str(verdict),
    }


def threshold_row(pulse: float) -> Row:
    """S0 - Sc from which on the pulse climbs, in both models."""
    whole = Bracket(LOWEST, HIGHEST)
    grids = {AUTOMATON: (CELLS,), BCRE: (CELLS, 2 * CELLS), EFFECTIVE: (CELLS, 2 * CELLS)}
    automaton, pde, effective = (
        threshold(model, cells, pulse, whole) for model, cells in grids.items()
    )
    finer = threshold(AUTOMATON, (4 * CELLS,), pulse, whole)
    return {
        **{"quantity": THRESHOLD, "case": "figure 1", "pulse": pulse},
        FINER: to_error(finer.value, finer.error),
        **Comparison(
            to_error(automaton.value, automaton.error),
            bcre_pde.Measured(pde.value, pde.error),
            bcre_pde.Measured(effective.value, effective.error),
            TOLERANCE,
        ).row(),
    }


def claims(outcomes: pd.DataFrame, thresholds: pd.DataFrame, sd: Any) -> list[Claim]:
    """Whether the same pulses climb in both models, and from the same slope on.

    ``sd`` is the row with Sd of figure 1's parameters.
    """
    return [_outcome_claim(outcomes), _threshold_claim(thresholds, sd)]


def _outcome_claim(rows: pd.DataFrame) -> Claim:
    differing = rows[rows.automaton != rows.pde]
    unresolved = int((rows["verdict"] == Verdict.UNRESOLVED).sum())
    cases = joined(
        f"{row['S0 - Sc']:g} and pulse {row['pulse']:g} ({row.automaton}/{row.pde}, "
        f"effective {row.pde_effective}, d = 1/4 {row[FINER]})"
        for _, row in differing.iterrows()
    )
    return Claim(
        "runs to the top",
        "An avalanche that runs to the top in the automaton does so in BCRE, and the other way "
        "round.",
        worst(rows["verdict"]),
        f"the same word in {len(rows) - len(differing)} of {len(rows)} cases, {unresolved} "
        f"unresolved. Automaton and BCRE differ at S0 - Sc = {cases}",
        OUTCOME_WHY,
    )


def _threshold_claim(rows: pd.DataFrame, sd: Any) -> Claim:
    small, large = rows.iloc[0], rows.iloc[-1]
    falls = all(
        (rows[column].diff().iloc[1:] <= 0).all() for column in (AUTOMATON.column, BCRE.column)
    )
    return Claim(
        "threshold against pulse",
        "A pulse of given size climbs from the same slope on in both models.",
        worst(rows["verdict"]),
        sentences(
            f"pulse {small['pulse']:g}: S0 - Sc = {small.automaton:.3g} in the automaton and "
            f"{small.pde:.3g} in BCRE, where Sd - Sc is {sd.automaton_theory:.4g} and "
            f"{sd.pde_theory:.4g}; pulse {large['pulse']:g}: {large.automaton:.3g} and "
            f"{large.pde:.3g}; with d = 1/4 the automaton's are {small[FINER]:.3g} and "
            f"{large[FINER]:.3g}",
            when(
                falls and large.automaton < sd.automaton_theory and large.pde < sd.pde_theory,
                "a finite pulse brings the pile down below Sd, and the more so the larger it is",
            ),
            f"largest difference {rows['difference'].max():.2g}, with D_eff and kappa_eff "
            f"{rows['difference_effective'].max():.1g}",
        ),
        f"{TOLERANCE:.0%} {WHY}",
    )


def draw_outcomes(axis: Axes, rows: pd.DataFrame) -> None:
    """Filled: yes; half: starts; hollow: no. Small shifts keep the three models apart."""
    fills = {Outcome.YES: "full", Outcome.STARTS: "left", Outcome.NO: "none"}
    for shift, model in zip((-0.25, 0.0, 0.25), COMPARED, strict=True):
        for word, fill in fills.items():
            chosen = rows[rows[model.column] == word]
            place = chosen["pulse"].map(PULSES.index) + shift
            look = model.markers(fillstyle=fill, markerfacecoloralt="white", markersize=6)
            axis.plot(place, chosen["S0 - Sc"], **look)
    axis.set_xticks(range(len(PULSES)), ["$10^{-6}$", "1", "10"])
    axis.set(xlim=(-0.6, len(PULSES) - 0.4), xlabel="pulse amplitude (length)", ylabel="S0 - Sc")
    axis.set_title("to the top? full: yes, half: starts, hollow: no", loc="left")


def draw_thresholds(axis: Axes, rows: pd.DataFrame) -> None:
    """The closed forms are the limit of small pulses."""
    scene = pulse_scene(0.0, 0.0)
    m, own = scene.material, effective(scene).material
    limits = (
        bcre_ca.theory.second_critical_excess(m.v, m.D, m.gamma, scene.d),
        bcre_pde.theory.second_critical_slope(m.v, m.D, m.gamma, 0.0),
        bcre_pde.theory.second_critical_slope(m.v, own.D, m.gamma, 0.0),
    )
    for model, limit in zip(COMPARED, limits, strict=True):
        axis.axhline(limit, **model.line | {"linewidth": 1.0})
        look = model.markers(markersize=6, fillstyle="none")
        axis.plot(rows["pulse"], rows[model.column], **look)
    axis.set(xscale="log", ylim=(0, 2.8), xlabel="pulse amplitude (length)")
    axis.set_ylabel("threshold S0 - Sc")
    axis.set_title("climbs from here on; lines: Sd - Sc", loc="left")
