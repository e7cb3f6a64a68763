"""What the series say: of scales, of BCRE's oscillation, of its start slope and of the controls."""

from __future__ import annotations

import numpy as np
import pandas as pd

from bcre_pde import Measured
from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.compare import Comparison
from bcre_studies.comparison.verdict import Verdict, worst

NEARLY_ALL = 0.9
ALIKE = 0.25
WHY_SCALE = (
    f"sizes have a scale where the big avalanches carry {NEARLY_ALL:.0%} of the sand and their "
    f"standard deviation is at most {ALIKE:.0%} of their mean: a power law over as many decades "
    "has neither"
)

SAME_EXPONENT = 0.1
SIGNIFICANT = 0.1
WHY_LAW = (
    f"one law has exponents that are within {SAME_EXPONENT:g} of each other, and fits better than "
    f"a lognormal with a significance of {SIGNIFICANT:g}, as its authors ask for"
)

TOLERANCE = 0.05
WHY = "as in every comparison with BCRE"

SAND_ABOVE = 0.1
SMALL_ERROR = 0.05


def judge(tables: dict[str, pd.DataFrame], critical: tuple[float, float]) -> list[Claim]:
    """All claims; ``critical`` is Sd - Sc of the automaton and of BCRE."""
    table = tables["comparison"]
    of = {str(drive): rows.set_index("case") for drive, rows in table.groupby("drive")}
    lengths = of["tilting, length"]
    return [
        _tilting(pd.concat([lengths, of["tilting"]])),
        _feeding(of["feeding"]),
        _oscillation(of["tilting by 0.05"]),
        _start(pd.concat([lengths, of["tilting"]]), critical),
        _all_the_sand(lengths),
        _small(tables["small"]),
        _controls(of["tilting, height alone"], of["tilting, trigger at one place"]),
    ]


def _tilting(rows: pd.DataFrame) -> Claim:
    variation = rows["size_sd"] / rows["size"]
    scaled = (rows["share_of_sand"] >= NEARLY_ALL) & (variation <= ALIKE)
    thin = rows[rows.index.str.endswith("trigger 0.001")]
    if scaled[thin.index].all():
        verdict = Verdict.DISAGREE
    else:
        verdict = Verdict.UNRESOLVED if scaled.any() else Verdict.AGREE
    wide = variation.idxmax()
    return Claim(
        "sizes under tilting",
        "Under slow tilting avalanches have no size of their own, as in critical systems.",
        verdict,
        f"with a trigger of 0.001 big avalanches carry "
        f"{thin['share_of_sand'].min():.0%} to {thin['share_of_sand'].max():.0%} of the sand at "
        f"four lengths; their sizes vary by {(thin['size_sd'] / thin['size']).min():.0%} to "
        f"{(thin['size_sd'] / thin['size']).max():.0%}, and there is none for "
        f"{thin['empty_decades'].min():.1f} decades below. They broaden where the trigger is "
        f"as large as what it sets off: by {variation.max():.0%} ({wide})",
        WHY_SCALE,
    )


def _feeding(rows: pd.DataFrame) -> Claim:
    exponents = rows["exponent"]
    same = exponents.max() - exponents.min() <= SAME_EXPONENT
    decided = rows["p_lognormal"] <= SIGNIFICANT
    better, worse = (decided & (sign * rows["over_lognormal"] > 0) for sign in (1, -1))
    told = ", ".join(
        f"{row.exponent:.2f} +- {row.exponent_band:.2f} over {row.decades:.1f} decades ({name})"
        for name, row in rows.iterrows()
    )
    return Claim(
        "sizes under feeding",
        "Under slow feeding one power law holds at every length of the slope.",
        Verdict.AGREE if same and better.all() else Verdict.DISAGREE,
        f"the best fits have exponents {told}; "
        + f"than a lognormal a power law fits better at {better.sum()} of {len(rows)} lengths and "
        f"worse at {worse.sum()} (p = {', '.join(f'{p:.1g}' for p in rows['p_lognormal'])})"
        + ("" if same else ". The exponents differ, so that sizes do not scale with one of them"),
        WHY_LAW,
    )


def _oscillation(rows: pd.DataFrame) -> Claim:
    coarse, fine = rows.loc["BCRE, 24 cells"], rows.loc["BCRE, 48 cells"]
    with_own = rows.loc["effective, 48 cells"], rows.loc["effective, 24 cells"]
    own = rows.loc["automaton, d = 1"]
    comparisons = [
        Comparison(
            float(own[name]),
            Measured(float(fine[name]), abs(fine[name] - coarse[name])),
            Measured(float(with_own[0][name]), abs(with_own[0][name] - with_own[1][name])),
            TOLERANCE,
        )
        for name in ("start", "gap", "size")
    ]
    finest = rows.loc["automaton, d = 0.25"]
    slopes = "; ".join(
        f"{name} {own[column]:.3g} (d = 0.25: {finest[column]:.3g}), in BCRE {fine[column]:.3g}, "
        f"with D_eff and kappa_eff {with_own[0][column]:.3g}"
        for name, column in (("S - Sc at the start", "start"), ("tilts between", "gap"))
    )
    return Claim(
        "oscillation between two slopes",
        "Under slow tilting the slope rises to a start and falls back to repose, as BCRE's does.",
        worst(comparison.verdict for comparison in comparisons),
        f"{slopes}; size over L^2 {own['size']:.3g}, {finest['size']:.3g}, {fine['size']:.3g} and "
        f"{with_own[0]['size']:.3g}. The differences at d = 1 are "
        f"{', '.join(f'{comparison.difference:.0%}' for comparison in comparisons)}",
        f"{TOLERANCE:.0%} {WHY}",
    )


def _start(rows: pd.DataFrame, critical: tuple[float, float]) -> Claim:
    low, high = rows["start"].min(), rows["start"].max()
    near = (rows["start"] / critical[0] - 1).abs().max() <= TOLERANCE
    return Claim(
        "start at the second critical slope",
        "A slope that is tilted slowly starts at the second critical slope.",
        Verdict.AGREE if near else Verdict.DISAGREE,
        f"it starts anywhere from S - Sc = {low:.2f} ({rows['start'].idxmin()}) to {high:.2f} "
        f"({rows['start'].idxmax()}), where Sd - Sc is {critical[0]:.3f} in the automaton and "
        f"{critical[1]:g} in BCRE"
        + ("" if near else ": the start depends on length and trigger, not on the material alone"),
        f"{TOLERANCE:.0%} of Sd - Sc",
    )


def _all_the_sand(rows: pd.DataFrame) -> Claim:
    """A straight slope holds (S - Sc) L^2/2 above repose; it is tilted evenly, dS a time."""
    above = rows["gap"] * 0.01 / 2
    share = rows["size"] / above
    return Claim(
        "finite-size scaling",
        "A big avalanche is all the sand above repose: its size is (S - Sc) L^2/2 at every length.",
        Verdict.AGREE if (1 - share).abs().max() <= SAND_ABOVE else Verdict.DISAGREE,
        f"it is {share.min():.2f} to {share.max():.2f} of that at four lengths, with S - Sc the "
        f"mean slope that the tilts between two add up to. That slope itself falls from "
        f"{2 * above.max():.2f} to {2 * above.min():.2f}",
        f"{SAND_ABOVE:.0%}: what small avalanches carry off between two big ones",
    )


def _small(small: pd.DataFrame) -> Claim:
    error = float(np.sqrt(np.mean((small["measured"] - small["predicted"]) ** 2)))
    span = float(small["measured"].max() - small["measured"].min())
    return Claim(
        "small avalanches",
        "The small avalanches are amplified triggers, each predicted by its place and the slope.",
        Verdict.AGREE if error <= SMALL_ERROR * span else Verdict.DISAGREE,
        f"ln(size/trigger) of {len(small)} small avalanches is predicted to {error:.2f} (root mean "
        f"square) over a range of {span:.1f}, {span / np.log(10):.1f} decades of size, from "
        f"nothing but the slope and the place of the trigger",
        f"{SMALL_ERROR:.0%} of the range",
    )


def _controls(alone: pd.DataFrame, at_one_place: pd.DataFrame) -> Claim:
    stands, sticks = alone.loc["stands at repose"], alone.loc["start and stop"]
    oscillates = sticks["gap"] > 1 and sticks["share_of_sand"] >= NEARLY_ALL
    return Claim(
        "oscillation needs the second layer",
        "The oscillation needs the second layer.",
        Verdict.DISAGREE if oscillates else Verdict.AGREE,
        f"a pile of the height alone that stands at repose sheds the same at every tilt "
        f"(sd {stands['size_sd']:.1g} of L^2). With angles of start and stop big ones come "
        f"every {sticks['gap']:.0f} +- {sticks['gap_sd']:.0f} tilts, from the start that it is "
        f"given. With every trigger at one place the two-layer pile is strictly "
        f"periodic (gaps vary by {at_one_place['gap_sd'].max():.2g} tilts)",
        "the control must oscillate for the claim to fall",
    )
