r"""When does a scene need no rolling layer? BCRE and the automaton beside their quasi-static limit.

Prigozhin and Zaltzman's sand rolls only where the slope is at repose, and takes no time to roll:
h_t + q_x = w, S <= Sc, q > 0 only where S = Sc. A step of any length is the isotonic regression of
u = h + Sc x. A heap on level ground, fed with Q at its closed top, has then the height
A = sqrt(2 Sc Q t) and the length l = A/Sc. Two numbers tell BCRE's heap from it:

    eps = v/(gamma Sc l)        tau = Q/(v A)

* eps: where the heap rises at A', v R_x = -A' and gamma R (Sc - S) = A', so that Sc - S is
  v/(gamma (l - x)). The slope falls short of Sc by the part eps l/(l - x) of it: between 0.2 l and
  0.6 l by eps ln(2)/0.4 in the mean. The sand lies farther out, its mean place by the part 1.5 eps.
* tau: the layer R = A' (l - x)/v holds the part tau of the sand. What lies is a heap with as much
  less sand, its slope is the same, and its mean place nearer by the part tau/2.

Orders and coefficients are measured from the three smallest numbers, the latter free of the second
order.
The paper's figures have l = the length on which the surface changes, A = Sc l, and their thickest
layer for Q/v.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pandas as pd

from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.comparison.wording import joined, sentences, when
from bcre_studies.models.registry import BCRE
from bcre_studies.sweeps.parallel import each
from bcre_studies.validation.quasi_static_limit.drawing import draw_map
from bcre_studies.validation.quasi_static_limit.heaps import (
    EPS,
    FIGURES,
    HEAPS,
    MODELS,
    TAU,
    of_figure,
    of_other_material,
    on_map,
)
from bcre_studies.validation.quasi_static_limit.rates import extrapolated, rates

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FIRST_ORDER = 0.1
COEFFICIENT = 0.05
WHY_ORDER = (
    f"orders within {FIRST_ORDER:g} of 1 and coefficients within {COEFFICIENT:.0%} of the closed "
    "form, since eps^2 ln eps is left over and the smallest eps is an eightieth"
)
LIMIT = 0.005
TOLERANCE = 0.05
WEIGHT = 2.0
"""Of eps in the rule: the mean distance of h grows by about 1.5 eps, and by tau."""
WHY_TOLERANCE = "5 % of h, as in ``paper_figures``"


def run() -> dict[str, pd.DataFrame]:
    """The map of eps and tau, the rates along it, heaps of other materials, and the figures."""
    cases = [(name, eps, tau) for name in MODELS for eps in EPS for tau in TAU]
    table = pd.DataFrame(each(on_map, cases, "quasi_static_limit, map"))
    others = each(of_other_material, range(HEAPS), "quasi_static_limit, heaps")
    return {
        "comparison": table,
        "rates": pd.DataFrame(rates(table)),
        "heaps": pd.DataFrame(others),
        "figures": pd.DataFrame([of_figure(name) for name in FIGURES]),
    }


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """Both rates, their signs, what is left in the limit, the rule, and the paper's figures."""
    table, found = tables["comparison"], tables["rates"]
    return [
        _rate_claim(found, "eps", "A slow exchange flattens the heap in proportion to eps"),
        _rate_claim(found, "tau", "A rolling layer takes sand from the heap in proportion to tau"),
        _signs_claim(found, table),
        _limit_claim(table),
        _rule_claim(table, tables["heaps"]),
        _figures_claim(tables["figures"]),
    ]


def _rate_claim(found: pd.DataFrame, number: str, said: str) -> Claim:
    rows = found[found["number"] == number]
    off = (rows["coefficient"] / rows["expected"] - 1).abs()
    good = bool(((rows["order"] - 1).abs() <= FIRST_ORDER).all() and (off <= COEFFICIENT).all())
    cells = joined(
        f"{row.quantity} ({row.model}) {row.coefficient:g} {number} where {row.expected:g} is "
        f"derived, order {row.order:g}"
        for row in rows.itertuples()
    )
    return Claim(
        f"rate in {number}",
        f"{said}, in BCRE and in the automaton.",
        Verdict.AGREE if good else Verdict.DISAGREE,
        cells,
        WHY_ORDER,
    )


def _signs_claim(found: pd.DataFrame, table: pd.DataFrame) -> Claim:
    reach = found[found["quantity"] == "reach"].pivot(
        index="model", columns="number", values="coefficient"
    )
    pde = table[table["model"] == BCRE.name]
    least = pde["eps"].min()
    line = pde[pde["eps"] == least].sort_values("tau")
    (thin, thick), (fewer, more) = line["tau"].iloc[:2], line["error of h + R"].iloc[:2]
    opposite = bool((reach["eps"] * reach["tau"] < 0).all())
    cells = joined(f"{row.eps:+g} eps {row.tau:+g} tau ({row.Index})" for row in reach.itertuples())
    return Claim(
        "opposite signs",
        "The two numbers move the sand in opposite directions.",
        Verdict.AGREE if opposite else Verdict.DISAGREE,
        sentences(
            f"The mean place of the sand at rest moves by {cells} of its distance",
            when(opposite, "so a small error of one quantity does not show that both are small"),
            when(
                fewer > more,
                f"Of h + R the error of BCRE at eps = {least:g} is {fewer:.2g} where tau = "
                f"{thin:g} and {more:.2g} where tau = {thick:g}: the two cancel in part",
            ),
        ),
        "a sign",
    )


def _limit_claim(table: pd.DataFrame) -> Claim:
    left = {
        (model, quantity): extrapolated(group, quantity)
        for model, group in table.groupby("model", sort=False)
        for quantity in ("at rest", "slope", "reach")
    }
    worst = max(abs(value) for value in left.values())
    cells = joined(
        f"{quantity} ({model}) {value:+.1g}" for (model, quantity), value in left.items()
    )
    grid = table["grid error"].max()
    return Claim(
        "the limit",
        "Where both numbers vanish BCRE and the automaton are the isotonic regression.",
        Verdict.AGREE if worst <= LIMIT else Verdict.DISAGREE,
        f"Relative to it, extrapolated to eps = tau = 0: {cells}. BCRE's grid adds {grid:.1g} at "
        "the most",
        f"{LIMIT:g}, the second order of the smallest numbers on the map",
    )


def _rule_claim(table: pd.DataFrame, heaps: pd.DataFrame) -> Claim:
    points = pd.concat([table, heaps], ignore_index=True)
    bound = WEIGHT * points["eps"] + points["tau"]
    admitted = points[bound <= TOLERANCE]
    above = points[points["error"] > bound]
    good = above.empty and not admitted.empty and bool((admitted["error"] <= TOLERANCE).all())
    return Claim(
        "when no rolling layer is needed",
        f"A heap needs no rolling layer to {TOLERANCE:.0%} of h where {WEIGHT:g} eps + tau is at "
        "most that.",
        Verdict.AGREE if good else Verdict.DISAGREE,
        sentences(
            f"{len(admitted)} of {len(points)} heaps are admitted, with errors up to "
            f"{admitted['error'].max():.2g}",
            f"on all of them, {len(heaps)} with other materials and diffusion, the error is "
            f"{(points['error'] / bound).min():.2g} to {(points['error'] / bound).max():.2g} times "
            f"{WEIGHT:g} eps + tau",
        ),
        WHY_TOLERANCE,
    )


def _figures_claim(figures: pd.DataFrame) -> Claim:
    bound = WEIGHT * figures["eps"] + figures["tau"]
    outside = bool(((bound > TOLERANCE) & (figures["error"] > TOLERANCE)).all())
    cells = joined(
        f"{row.figure} eps = {row.eps:g}, tau = {row.tau:g}, error {row.error:g}"
        for row in figures.itertuples()
    )
    return Claim(
        "the paper's figures",
        "Every figure of the paper needs its rolling layer.",
        Verdict.AGREE if outside else Verdict.DISAGREE,
        f"Errors are of h at any recorded time, over its mean change: {cells}",
        WHY_TOLERANCE,
    )


def draw(tables: dict[str, pd.DataFrame]) -> Figure:
    """The error on the map of eps and tau, and the rates along two lines of it."""
    return draw_map(tables["comparison"], tables["heaps"], tables["figures"], TOLERANCE, WEIGHT)
