"""What follows from the opening angles measured: one function a claim."""

from __future__ import annotations

import math
from collections.abc import Sequence

import pandas as pd

from bcre_studies.comparison.claim import Claim, quality_check
from bcre_studies.comparison.verdict import Verdict, worst
from bcre_studies.comparison.wording import joined, sentences, when
from bcre_studies.models.registry import AUTOMATON, BCRE, EFFECTIVE, Model

TOLERANCE = 0.05
WHY = "of the angle: one to three degrees, as near as the wedge of an experiment is read"
AUTOMATON_DEGREES, BCRE_DEGREES = 0.02, 0.2
SD_TOLERANCE = 0.01
TRACE_FACTOR, FRONT_FACTOR = 0.5, 1.5


def closed_form(rows: pd.DataFrame, model: Model, degrees: float) -> Claim:
    """Measured against derived, in one of the models."""
    column = model.column
    who = "the automaton" if model is AUTOMATON else "BCRE"
    gaps = (rows[column] - rows[f"{column}_theory"]).abs()
    holds = bool((gaps <= degrees).all())
    return quality_check(
        f"closed form of the opening angle, {who.removeprefix('the ')}",
        f"The opening angle measured in {who} is that of its closed form.",
        Verdict.AGREE if holds else Verdict.DISAGREE,
        f"{len(rows)} slopes and materials, {rows[column].min():.1f} to {rows[column].max():.1f} "
        f"degrees: largest difference {gaps.max():.1g} degrees, where the extrapolation's own "
        f"error is up to {rows[f'{column}_error'].max():.1g}",
        f"{degrees:g} degrees: the extrapolation leaves a few hundredths at the distances taken",
    )


def at_figure_1(rows: pd.DataFrame) -> Claim:
    """One material, cells of one size, four slopes."""
    return _same_angle(
        rows,
        "figure 1",
        "figure 1's parameters",
        joined(
            f"S - Sc = {row['S - Sc']:g}: {row.automaton:.1f} degrees in the automaton, "
            f"{row.pde:.1f} in BCRE, {row.pde_effective:.1f} in BCRE with D_x + v d/2"
            for _, row in rows.iterrows()
        ),
    )


def at_other_parameters(rows: pd.DataFrame) -> Claim:
    """Other materials, cells of other sizes."""
    peclet = rows["v"] * rows["d"] / rows["D"]
    left = rows[rows["difference_effective"] > TOLERANCE]
    numbers = sentences(
        f"{len(rows)} slopes and materials, cell Peclet numbers {peclet.min():g} to "
        f"{peclet.max():g}: relative difference {rows['difference'].min():.1%} to "
        f"{rows['difference'].max():.0%}, with D_x + v d/2 "
        f"{rows['difference_effective'].max():.1%} at most",
        when(
            len(left),
            "D_x + v d/2 does not reach "
            + joined(
                f"S - Sc = {row['S - Sc']:g} at Pe = {peclet[index]:g}"
                for index, row in left.iterrows()
            ),
        ),
    )
    return _same_angle(rows, "other materials", "other parameters", numbers)


def _same_angle(rows: pd.DataFrame, name: str, what: str, numbers: str) -> Claim:
    wider = bool((rows[AUTOMATON.column] > rows[BCRE.column]).all())
    return Claim(
        f"opening angle, {name}",
        f"At {what} an avalanche opens at the same angle in the automaton and in BCRE.",
        worst(rows["verdict"]),
        sentences(numbers, when(wider, "the automaton's wedge is the wider one everywhere")),
        f"{TOLERANCE:.0%} {WHY}",
    )


def direction(rows: pd.DataFrame) -> Claim:
    """Does an isotropic D_eff explain the automaton's angle?"""
    tangent = rows[[AUTOMATON.column, "isotropic", EFFECTIVE.column]].map(
        lambda degrees: math.tan(math.radians(degrees))
    )
    gaps = (rows["isotropic"] - rows[AUTOMATON.column]).abs() / rows[AUTOMATON.column]
    along = (rows[EFFECTIVE.column] - rows[AUTOMATON.column]).abs() / rows[AUTOMATON.column]
    ratio = tangent[AUTOMATON.column] / tangent["isotropic"]
    return Claim(
        "diffusion of the cells in all directions",
        "What the cells add to D acts across the flow as it does along.",
        Verdict.AGREE if (gaps <= TOLERANCE).all() else Verdict.DISAGREE,
        sentences(
            f"with v d/2 added to D in both directions the angle is off by up to {gaps.max():.0%}, "
            f"added along the flow alone by up to {along.max():.1%}",
            f"tan theta of the automaton is {ratio.min():.2f} to {ratio.max():.2f} of the "
            "isotropic one",
            when(along.max() < gaps.max(), "the cells' own diffusion has a direction"),
        ),
        f"{TOLERANCE:.0%} {WHY}",
    )


def right_angle(rows: pd.DataFrame) -> Claim:
    """Where the angle, continued, is 90 degrees."""
    pairs = [
        (row["case"], model.label, row[model.column], row[f"{model.column}_theory"])
        for _, row in rows.iterrows()
        for model in (AUTOMATON, BCRE)
        if row[model.column] == row[model.column]
    ]
    good = all(abs(found / expected - 1) <= SD_TOLERANCE for *_, found, expected in pairs)
    return Claim(
        "90 degrees at Sd",
        "An avalanche opens at 90 degrees from the second critical slope of the line on, in both "
        "models.",
        Verdict.AGREE if good and len(pairs) else Verdict.DISAGREE,
        "angles measured up to 0.7 (Sd - Sc) and continued reach 90 degrees at S - Sc = "
        + joined(
            f"{found:.4g} ({name}, {label}; Sd - Sc = {expected:.4g})"
            for name, label, found, expected in pairs
        ),
        f"{SD_TOLERANCE:.0%} of Sd - Sc: what is left out of the continuation is a tenth of it",
    )


def layers(rows: pd.DataFrame, places: Sequence[float]) -> Claim:
    """Avalanches that erode, against the closed form."""
    gaps = (rows[AUTOMATON.column] - rows["automaton_theory"]).abs()
    first, last = (f"at x = {x:g}" for x in (places[0], places[-1]))
    return Claim(
        "edge of a layer",
        "An avalanche that erodes a layer opens at the angle of a trace, whatever its pulse.",
        Verdict.AGREE if (gaps <= BCRE_DEGREES).all() else Verdict.DISAGREE,
        sentences(
            joined(
                f"S - Sc = {row['S - Sc']:g}, pulse {row['pulse']:g}: {row[first]:.1f} degrees "
                f"{first}, {row[last]:.1f} {last}, tends to {row.automaton:.2f} "
                f"+- {row.automaton_error:.1g} (closed form {row.automaton_theory:.2f})"
                for _, row in rows.iterrows()
            ),
            when(
                (rows[last] < rows["automaton_theory"]).all(),
                "the edge is narrower than the closed form at any length that one can run",
            ),
        ),
        f"{BCRE_DEGREES:g} degrees, as for BCRE",
    )


def slowness(rows: pd.DataFrame) -> Claim:
    """The factor of (1/n) ln x."""
    factors = rows["factor"]
    midway = (TRACE_FACTOR + FRONT_FACTOR) / 2
    return Claim(
        "how slowly an edge opens",
        "The edge of a layer falls behind its angle by (3/(2 n)) ln x, as a front that is pulled "
        "by its foot does.",
        Verdict.AGREE if (factors > midway).all() else Verdict.DISAGREE,
        f"factors of (1/n) ln x are {factors.min():.2g} to {factors.max():.2g}; a contour of a "
        f"trace would have {TRACE_FACTOR:g}",
        f"nearer to {FRONT_FACTOR:g} than to {TRACE_FACTOR:g}: terms beyond ln x count at this "
        "length",
    )


def pulses(rows: pd.DataFrame) -> Claim:
    """Thresholds on a plane against those on a line, in both models."""
    ratios = rows[[AUTOMATON.column, BCRE.column]] / rows[["line", "line_pde"]].to_numpy()
    steeper = ratios.stack() - 1
    return Claim(
        "finite pulses on a plane",
        "A finite pulse brings the top down from the same slope on, on a plane and on a line.",
        Verdict.AGREE if (steeper <= TOLERANCE).all() else Verdict.DISAGREE,
        sentences(
            "S0 - Sc on a line and on a plane: "
            + joined(
                (
                    f"pulse {row['pulse']:g} {row['line']:.3g} and {row[AUTOMATON.column]:.3g} in "
                    f"the automaton, {row['line_pde']:.3g} and {row[BCRE.column]:.3g} in BCRE"
                    for _, row in rows.iterrows()
                ),
                "; ",
            ),
            when(
                (steeper > 0).all(),
                "a pulse that spreads sideways needs a steeper slope, the more so the larger it is"
                if all(ratios[column].is_monotonic_increasing for column in ratios)
                else "a pulse that spreads sideways needs a steeper slope",
            ),
        ),
        f"{TOLERANCE:.0%} of S0 - Sc, as in the study of the second critical angle",
    )


def same_threshold(rows: pd.DataFrame) -> Claim:
    """Thresholds on a plane in the automaton against those in BCRE."""
    unresolved = rows.loc[rows["verdict"] == Verdict.UNRESOLVED, "pulse"]
    return Claim(
        "finite pulses on a plane in both models",
        "A finite pulse on a plane brings the top down from the same slope on in the automaton and "
        "in BCRE.",
        worst(rows["verdict"]),
        sentences(
            "S0 - Sc: "
            + joined(
                (
                    f"pulse {row['pulse']:g} {row[AUTOMATON.column]:.3g} in the automaton, "
                    f"{row[BCRE.column]:.3g} +- {row[f'{BCRE.column}_error']:.1g} in BCRE, "
                    f"{row[EFFECTIVE.column]:.3g} with D_x + v d/2 and kappa_x = gamma d/2"
                    for _, row in rows.iterrows()
                ),
                "; ",
            ),
            when(
                (rows[AUTOMATON.column] < rows[BCRE.column]).all(),
                "the automaton's cells bring slopes down that stand in BCRE",
            ),
            when(
                len(unresolved),
                "BCRE's error is not small enough to decide at pulse "
                + joined(f"{pulse:g}" for pulse in unresolved),
            ),
        ),
        f"{TOLERANCE:.0%} of S0 - Sc, as in the study of the second critical angle",
    )
