r"""Which flow rules keep a heap round, and converge to the radial solution?

R_t + div(v R n - D grad R) = E on a free surface, with n = -grad h/|grad h| and
E = gamma R (|grad h| - Sc). Three rules send sand down: ``split4`` shares it out among the lower
ones of four neighbours, ``facet8`` follows the steepest of eight triangular facets (Tarboton, Water
Resour. Res. 33 (1997) 309), and ``d8`` goes straight to the steepest of eight neighbours, as games
and drainage maps do.

* ``poured heap``: sand falls on a disc on level ground. The relative L1 difference of h from
  radially symmetric BCRE, and how far the foot reaches at 0, 22.5 and 45 degrees to the axes, over
  that of the radial solution. The foot is where h is a twentieth of its height.
* ``silo``: R in a round silo that fills, against R = w (a^2 - r^2)/(2 v r).
* ``collapse``: a cone of slope 1.2, set rolling at its tip.
* ``rills``: growth rate of ripples across an eroding sheet against l^2 + l (D K - sigma)
  - sigma v R0 K/S = 0, K = 2 (1 - cos k d)/d^2. With D = 0 it grows with k without bound as d -> 0:
  the problem is ill posed, and the cells choose the rills.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from bcre_ca.plane.setting import Flows
from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.rounding import significant
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.comparison.wording import joined, sentences, when
from bcre_studies.sweeps.parallel import each
from bcre_studies.validation.poured_heap import heaps, pictures, rills

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FLOWS: tuple[Flows, ...] = ("split4", "facet8", "d8")
POURED, SILO, COLLAPSE, RILLS = "poured heap", "silo", "collapse", "rills"
MADE = {POURED: heaps.POURED, COLLAPSE: heaps.COLLAPSE}
CELLS = {POURED: (1.0, 0.5, 0.25), SILO: (1.0, 0.5, 0.25), COLLAPSE: (1.0, 0.5)}
RINGS = {POURED: (120, 240), COLLAPSE: (240, 480)}
"""Two grids of the radial solution: their difference is its error, the finer one the reference."""

DIRECTIONS = (0.0, 22.5, 45.0)
FOOT = 0.05
"""Part of the height at which the foot is."""

MAPPED = 0.5
"""Cell length of the heaps that are drawn."""

WAVES = ((8, 0.0), (16, 0.0), (8, 0.002), (16, 0.002))
"""Ripples across the plane, and D."""

TOLERANCE, WHY = 0.01, "of the sand at d = 1/4, and no less than 1.5 times better than at d = 1/2"
FALL = 1.5
SILO_TOLERANCE, COLLAPSE_TOLERANCE, RILL_TOLERANCE = 0.03, 0.02, 0.05

Row = dict[str, Any]
Result = tuple[list[Row], pd.DataFrame | None]
Case = tuple[Callable[..., Result], tuple[Any, ...]]


def run() -> dict[str, pd.DataFrame]:
    """All rows, and the poured heaps as maps."""
    references = dict(zip(MADE, each(reference, tuple(MADE), "poured_heap"), strict=True))
    cases: list[Case] = [
        (heap, (quantity, flow, d, references[quantity]))
        for quantity in MADE
        for d in reversed(CELLS[quantity])
        for flow in reversed(FLOWS)
    ]
    cases += [(silo, (flow, d)) for d in CELLS[SILO] for flow in FLOWS]
    cases += [(rill, (flow, waves, D)) for waves, D in WAVES for flow in FLOWS]
    found = each(_case, cases, "poured_heap")
    rows = sorted((row for rows, _ in found for row in rows), key=_place)
    maps = [table for _, table in found if table is not None][::-1]
    return {"comparison": pd.DataFrame(rows), "maps": pd.concat(maps, ignore_index=True)}


def _place(row: Row) -> tuple[int, int, float]:
    quantity, flow = (POURED, SILO, COLLAPSE, RILLS).index(row["quantity"]), row["flow"]
    return quantity, FLOWS.index(flow), -row.get("d", 0.0)


def _case(case: Case) -> Result:
    function, arguments = case
    return function(*arguments)


def reference(quantity: str) -> tuple[Any, Any, float]:
    """r and h of the radial solution, and its own relative error."""
    (r, coarse), (fine_r, fine) = (heaps.reference(MADE[quantity], n) for n in RINGS[quantity])
    apart = np.abs(np.interp(r, fine_r, fine) - coarse)
    return fine_r, fine, float((r * apart).sum() / (r * coarse).sum())


def heap(quantity: str, flow: Flows, d: float, radial: tuple[Any, Any, float]) -> Result:
    """A heap against the radial solution; a map of it where it is to be drawn."""
    made = MADE[quantity]
    r, expected, error = radial
    h = heaps.heap(made, flow, d)
    level = FOOT * float(expected.max())
    at = float(r[int(np.argmax(expected < level))])
    inner, outer = expected[expected >= level][-1], expected[expected < level][0]
    at -= float(r[1] - r[0]) * (level - outer) / (inner - outer)
    row = {
        "quantity": quantity,
        "flow": flow,
        "d": d,
        "difference": significant(heaps.difference(h, d, r, expected), 2),
        "reference_error": significant(error, 1),
        "top": significant(float(h[0, 0]) / float(np.interp(0.7 * d, r, expected)), 3),
    }
    if quantity == POURED:
        for degrees in DIRECTIONS:
            row[f"foot at {degrees:g}"] = round(heaps.foot(h, d, degrees, level) / at, 4)
    is_mapped = quantity == POURED and d == MAPPED
    own = np.interp(heaps.radii(made.radius, d), r, expected)
    return [row], pictures.table_of(flow, h, own) if is_mapped else None


def silo(flow: Flows, d: float) -> Result:
    """R in a silo against its closed form."""
    error = significant(heaps.silo(flow, d), 2)
    return [{"quantity": SILO, "flow": flow, "d": d, "difference": error}], None


def rill(flow: Flows, waves: int, D: float) -> Result:
    """Growth of a ripple against its closed form."""
    k, expected, measured = rills.growth(flow, D, waves)
    row = {"quantity": RILLS, "flow": flow, "d": rills.d, "D": D, "k": significant(k, 4)}
    row |= {
        "growth": significant(round(measured, 6) + 0.0, 3),
        "growth_theory": significant(expected, 3),
    }
    return [row], None


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """One claim a flow rule for heaps and silos; collapse; rills."""
    table = tables["comparison"]
    of = {quantity: rows.set_index("flow") for quantity, rows in table.groupby("quantity")}
    claims = [_poured(flow, of[POURED].loc[flow].set_index("d")) for flow in FLOWS]
    claims += [_silo(flow, of[SILO].loc[flow].set_index("d")) for flow in FLOWS]
    claims += [_collapse(flow, of[COLLAPSE].loc[flow].set_index("d")) for flow in FLOWS]
    return [*claims, *(_rills(flow, of[RILLS].loc[flow]) for flow in FLOWS)]


def _poured(flow: Flows, rows: pd.DataFrame) -> Claim:
    errors = rows["difference"]
    feet = rows.loc[0.25, [f"foot at {degrees:g}" for degrees in DIRECTIONS]].astype(float)
    good = errors[0.25] <= TOLERANCE and errors[0.5] / errors[0.25] >= FALL
    return Claim(
        f"poured heap, {flow}",
        f"A heap poured with {flow} converges to the round one of BCRE.",
        Verdict.AGREE if good else Verdict.DISAGREE,
        sentences(
            "the surface is off by "
            + joined(f"{error:.2%} at d = {d:g}" for d, error in errors.items())
            + f" (the radial solution by {rows['reference_error'].iloc[0]:.0e})",
            f"at d = 1/4 the foot reaches {feet.iloc[0] - 1:+.1%} along the axes, "
            f"{feet.iloc[1] - 1:+.1%} at 22.5 degrees and {feet.iloc[2] - 1:+.1%} on the diagonal",
            when(
                errors[0.25] > TOLERANCE and errors[1.0] / errors[0.25] < FALL,
                "smaller cells do not help: its heaps are octagons",
            ),
        ),
        f"{TOLERANCE:.0%} {WHY}",
    )


def _silo(flow: Flows, rows: pd.DataFrame) -> Claim:
    errors = rows["difference"]
    return Claim(
        f"silo, {flow}",
        f"In a round silo that fills, R of {flow} is w (a^2 - r^2)/(2 v r).",
        Verdict.AGREE if errors[0.25] <= SILO_TOLERANCE else Verdict.DISAGREE,
        "R is off by " + joined(f"{error:.1%} at d = {d:g}" for d, error in errors.items()),
        f"{SILO_TOLERANCE:.0%} at d = 1/4, a fiftieth of the radius",
    )


def _collapse(flow: Flows, rows: pd.DataFrame) -> Claim:
    errors = rows["difference"]
    return Claim(
        f"collapse, {flow}",
        f"A cone steeper than Sc collapses to the same heap in {flow} and in BCRE.",
        Verdict.AGREE if errors[0.5] <= COLLAPSE_TOLERANCE else Verdict.DISAGREE,
        "h is off by "
        + joined(f"{error:.1%} at d = {d:g}" for d, error in errors.items())
        + f" (the radial solution by {rows['reference_error'].iloc[0]:.0e})",
        f"{COLLAPSE_TOLERANCE:.0%} at d = 1/2: steps of first order on forty cells",
    )


def _rills(flow: Flows, rows: pd.DataFrame) -> Claim:
    gaps = (rows["growth"] / rows["growth_theory"] - 1).abs()
    free = rows[rows["D"] == 0].sort_values("k")["growth"]
    return Claim(
        f"rills, {flow}",
        f"Ripples across a sheet that erodes grow in {flow} at the rate of the closed form.",
        Verdict.AGREE if (gaps <= RILL_TOLERANCE).all() else Verdict.DISAGREE,
        sentences(
            joined(
                f"wavenumber {row['k']:g}, D = {row['D']:g}: {row['growth']:.3g} where "
                f"{row['growth_theory']:.3g} is predicted"
                for _, row in rows.iterrows()
            ),
            when(
                len(free) > 1 and free.iloc[0] > 0 and free.is_monotonic_increasing,
                "without D the shorter ripple grows faster, so the cells choose the rills",
            ),
            when((rows["growth"].abs() < 1e-3).all(), "it has no rills"),
        ),
        f"{RILL_TOLERANCE:.0%}: the sheet grows by a tenth meanwhile",
    )


def draw(tables: dict[str, pd.DataFrame]) -> Figure:
    """See :func:`bcre_studies.validation.poured_heap.pictures.draw`."""
    table = tables["comparison"]
    return pictures.draw(table[table["quantity"] == POURED], tables["maps"])
