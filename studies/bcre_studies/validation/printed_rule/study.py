r"""The paper's printed rule, read in every way it can be read, on its own three figures.

Equations (4) to (6) of the paper leave three things open:

    sign    R gains -R gamma (dh - |Sc|) as printed, i.e. gamma R (S + |Sc|), or gamma R (S - Sc)
            as the text needs (flow runs to i + 1, so dh < 0 on a descending slope)
    order   every cell from the old state, or one after the other, downhill ("right") or uphill
            ("left"); and whether (5) and (6) use R as it was, or as (4) has just updated it
    step    the literal d = dt = 1, or the largest stable one (0.2 where R is used as updated)

Each of the twenty readings runs each figure. Drift and diffusion are those of a single cell's R
over one step without exchange, (d<x>/dt, d<(x - <x>)^2>/2 dt); the amplification is that of the
shortest wave, |G(pi/d)| = |1 - 2 v dt/d - 4 D dt/d^2| for the synchronous rule.

A caption is met where: figure 1, none of the static layer is negative and no more of its area is
left than a slope at repose holds, Sc/S0 + (1 - Sc/S0) d/L (the last cell keeps its height);
figure 2, the pulse has moved downhill and spread, R >= 0, and the slope is below Sc; figure 3, the
same pulse, and the surface has changed uphill of the pulse's centre by at least 1 % of the largest
change.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING, Any, cast

import numpy as np
import pandas as pd

import bcre_ca
from bcre_ca.rule import Order, Sign
from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.rounding import significant
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.comparison.wording import joined, sentences, when
from bcre_studies.models.automaton import rule_of
from bcre_studies.reporting import style
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.scene import load
from bcre_studies.sweeps.parallel import each
from bcre_studies.validation.printed_rule.updated import march

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIGNS: tuple[Sign, ...] = ("consistent", "printed")
ORDERS: tuple[Order, ...] = ("synchronous", "right", "left")
UPDATED = ("synchronous, R updated", "right, R updated")
"""(5) and (6) use what (4) has made of R (``updated``)."""
ALL_ORDERS = (*ORDERS, *UPDATED)
STEPS = ("literal", "stable")
FIGURES = ("figure1", "figure2", "figure3")
AT_REPOSE = 0.001
"""More area than at repose that may be left, over that at the start: S = Sc to three digits."""
ENDED = 0.01
"""An avalanche has ended where R has fallen to this part of its largest total."""
PATIENCE = {"figure1": 3000.0, "figure2": 60.0, "figure3": 60.0}
"""How long it is waited for: three times what the drift takes from top to foot, or more."""
FIXED = 0.2
"""dt where R is used as updated: stable in all three figures by the bounds of the other orders."""
CONSERVED = 1e-6
WHY = "yes or no, by the definitions in the study's text"

Row = dict[str, Any]


def run() -> dict[str, pd.DataFrame]:
    """One row a figure and reading."""
    readings = product(FIGURES, STEPS, SIGNS, ALL_ORDERS)
    return {"comparison": pd.DataFrame(each(_read, readings, "printed_rule"))}


def _read(reading: tuple[str, str, Sign, str]) -> Row:
    return read(*reading)


def read(figure: str, step: str, sign: Sign, order: str) -> Row:
    """Run a figure with one reading of the rule, and see what becomes of it."""
    scene = load(figure)
    start = bcre_ca.Pile(*scene.initial(scene.centres()))
    rule = replace(rule_of(scene), sign=sign)
    if order in UPDATED:
        rule = replace(rule, dt=FIXED)
    else:
        rule = replace(rule, order=cast("Order", order))
    rule = replace(rule, dt=1.0) if step == "literal" else rule
    drift, diffusion = moments(rule, order)
    row: Row = {"figure": figure, "step": step, "sign": sign, "order": order, "dt": rule.dt}
    row |= {"drift": drift, "diffusion": diffusion, "amplification": shortest_wave(rule, order)}
    try:
        with np.errstate(over="ignore", invalid="ignore"):
            shown, last = _follow(start, rule, (scene.time.until, PATIENCE[figure]), step, order)
    except FloatingPointError:
        return row | {"finite": False, "R_not_negative": False, "ends": False, "caption": False}
    largest = max(start.R.sum(), shown.R.sum(), last.R.sum())
    mass, kept = start.mass(rule.d), last.mass(rule.d) + last.outflow
    return row | {
        "finite": True,
        "mass_error": round(abs(kept - mass) / mass, 12),
        "R_not_negative": bool(min(shown.R.min(), last.R.min()) >= 0),
        "ends": bool(last.R.sum() < ENDED * largest),
        "left": significant(float(last.h.sum() / start.h.sum()), 4),
        "caption": caption(figure, start, last if figure == FIGURES[0] else shown),
    }


def _follow(
    pile: bcre_ca.Pile, rule: bcre_ca.Rule, times: tuple[float, float], step: str, order: str
) -> tuple[bcre_ca.Pile, bcre_ca.Pile]:
    """The pile at two times; the literal step is taken whatever comes of it."""
    if step == "stable" and order not in UPDATED:
        shown, last = bcre_ca.frames(pile, rule, times)
        return shown, last
    piles = [pile]
    for time in times:
        before, steps = piles[-1], round((time - piles[-1].t) / rule.dt)
        piles.append(_advanced(before, rule, steps, order))
    return piles[1], piles[2]


def _advanced(pile: bcre_ca.Pile, rule: bcre_ca.Rule, steps: int, order: str) -> bcre_ca.Pile:
    """Marched rather than advanced: a layer that an unstable step made negative is no start."""
    if order in UPDATED:
        h, R, left = march(pile.h, pile.R, rule, steps, in_place=order == UPDATED[1])
    else:
        h, R = pile.h.copy(), pile.R.copy()
        left = bcre_ca.march(h, R, rule, steps)
    if not np.isfinite([h, R]).all():
        raise FloatingPointError("not finite")
    return bcre_ca.Pile(h, R, pile.t + steps * rule.dt, pile.outflow + rule.d * left)


def _one_step(R: Array, rule: bcre_ca.Rule, order: str) -> Array:
    """R after a step without exchange; what happens at the ends must not matter."""
    rule = replace(rule, gamma=0.0)
    if order in UPDATED:
        return np.asarray(march(0 * R, R, rule, 1, in_place=order == UPDATED[1])[1])
    return bcre_ca.step(0 * R, R, rule, "periodic")[1]


def moments(rule: bcre_ca.Rule, order: str = "") -> tuple[float, float]:
    """Drift and diffusion per unit time of one wet cell, without exchange, over one step."""
    cells = 201
    R = np.zeros(cells)
    R[cells // 2] = 1.0
    R = _one_step(R, rule, order)
    if not (total := float(R.sum())):
        return np.nan, np.nan
    x = (np.arange(cells) - cells // 2) * rule.d
    mean = float(R @ x / total)
    spread = float(R @ (x - mean) ** 2 / total)
    return significant(mean / rule.dt, 4), significant(spread / rule.dt / 2, 4)


def shortest_wave(rule: bcre_ca.Rule, order: str = "") -> float:
    """Factor per step of R = 1, -1, 1, ... without exchange, in the middle of a long domain."""
    R = np.resize([1.0, -1.0], 200)
    return significant(float(abs(_one_step(R, rule, order)[100] / R[100])), 4)


def caption(figure: str, start: bcre_ca.Pile, end: bcre_ca.Pile) -> bool:
    """Whether one of :data:`FIGURES` shows what the paper's caption says of it."""
    scene = load(figure)
    x, Sc = scene.centres(), scene.material.Sc
    if (end.R < 0).any():
        return False
    if figure == "figure1":
        steepness = Sc * (x[-1] - x[0]) / (start.h[0] - start.h[-1])
        most = steepness + (1 - steepness) / x.size + AT_REPOSE
        return bool((end.h >= 0).all() and end.h.sum() <= most * start.h.sum())
    (centre, width), (later, wider) = (_place(x, pile.R) for pile in (start, end))
    travelled = later > centre and wider > width
    if figure == "figure2":
        fall = float(end.h[0] - end.h[-1]) / float(x[-1] - x[0])
        return bool(travelled and fall < Sc)
    change = np.abs(end.h - start.h)
    return bool(travelled and change[x < centre - scene.d].max() >= 0.01 * change.max())


def _place(x: Array, R: Array) -> tuple[float, float]:
    mean = float(R @ x / R.sum())
    return mean, float(np.sqrt(R @ (x - mean) ** 2 / R.sum()))


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """Which reading reproduces the paper, and which cannot."""
    table = tables["comparison"]
    return [_reproducing(table), _printed_sign(table), _literal_step(table), _updated(table)]


def _met(rows: pd.DataFrame) -> str:
    return f"{int(rows['caption'].sum())} of {len(rows)}"


def _reproducing(table: pd.DataFrame) -> Claim:
    stable = table[(table["step"] == "stable") & (table["sign"] == "consistent")]
    met = {order: bool(rows["caption"].all()) for order, rows in stable.groupby("order")}
    first = stable[stable["figure"] == "figure1"].set_index("order")
    v = load("figure1").material.v
    kept = [order for order, drift in first["drift"].items() if abs(drift - v) <= 1e-3 * v]
    left = first["left"]["synchronous"]
    return Claim(
        name="the reading that reproduces",
        statement="Consistent sign, synchronous order, stable step: all captions are met.",
        verdict=Verdict.AGREE if met["synchronous"] else Verdict.DISAGREE,
        evidence=sentences(
            "captions of all three figures met by: "
            + joined(order for order in ALL_ORDERS if met.get(order)),
            "drift at figure 1, where v = "
            f"{v:g}: " + ", ".join(f"{first['drift'][order]:g} ({order})" for order in first.index),
            when(kept == ["synchronous"], "only the synchronous order keeps the drift"),
            f"{left:.1%} of figure 1's static layer is left with the synchronous order",
        ),
        tolerance=WHY,
    )


def _printed_sign(table: pd.DataFrame) -> Claim:
    rows = table[(table["step"] == "stable") & (table["sign"] == "printed")]
    first, others = rows[rows["figure"] == "figure1"], rows[rows["figure"] != "figure1"]
    fails = not bool(first["caption"].any())
    return Claim(
        name="the printed sign",
        statement="With the printed sign the rule cannot show what figure 1's caption says.",
        verdict=Verdict.AGREE if fails else Verdict.DISAGREE,
        evidence=sentences(
            f"captions met in {_met(first)} stable runs of figure 1 and in {_met(others)} of "
            "figures 2 and 3",
            when(fails, "the rule erodes at gamma (S + |Sc|), past repose to the reverse slope"),
            when(others["caption"].any(), "figures 2 and 3 do not tell the signs apart"),
        ),
        tolerance=WHY,
    )


def _literal_step(table: pd.DataFrame) -> Claim:
    fast = table[table["figure"] != "figure1"]
    rows, stable = fast[fast["step"] == "literal"], fast[fast["step"] == "stable"]
    wave = rows[rows["order"] == "synchronous"].iloc[0]
    bound = rule_of(load("figure2")).max_stable_step()
    return Claim(
        name="the literal step",
        statement="With d = dt = 1 and v = 2.5, as printed, figures 2 and 3 cannot have been made.",
        verdict=Verdict.DISAGREE if rows["caption"].any() else Verdict.AGREE,
        evidence=f"at d = dt = 1 the Courant number is 2.5, the shortest wave changes by a factor "
        f"of {wave['amplification']:g} a step and the diffusion is {wave['diffusion']:g}; "
        f"{int(rows['finite'].sum())} of {len(rows)} runs stay finite and {_met(rows)} meet their "
        f"caption, against {_met(stable)} with a stable step, which is {bound:.3f} at most",
        tolerance=WHY,
    )


def _updated(table: pd.DataFrame) -> Claim:
    literal = table[table["order"].isin(UPDATED) & (table["step"] == "literal")]
    rows = table[table["order"].isin(UPDATED) & (table["step"] == "stable")]
    others = table[table["order"].isin(ORDERS) & (table["step"] == "stable")]
    errors = rows["mass_error"].fillna(np.inf)
    good = bool((errors > CONSERVED).all())
    return Claim(
        name="R updated between the equations",
        statement="Read so that (5) and (6) use the R that (4) has just updated, the rule does not "
        "conserve sand.",
        verdict=Verdict.AGREE if good else Verdict.DISAGREE,
        evidence=f"part of the sand lost or made: {errors.min():.1g} to {errors.max():.1g} in "
        f"{len(rows)} stable runs, at most {others['mass_error'].max():.0e} with R as it was; "
        f"captions met in {_met(rows)}, and in {_met(literal)} with d = dt = 1",
        tolerance=f"{CONSERVED:g} of the sand: a million times rounding",
    )


def draw(tables: dict[str, pd.DataFrame]) -> Figure:
    """Figures 1 to 3 by the twenty readings: caption met, finite only, or not even that."""
    table = tables["comparison"]
    figure, axes = style.panels(1, 1)
    figure.set_size_inches(8.2, 5.8)
    readings = list(product(STEPS, SIGNS, ALL_ORDERS))
    marks = {2: ("o", "#3b8f5a"), 1: ("D", "#c9962b"), 0: ("x", "#b5480f")}
    for row in table.itertuples():
        state = 2 if row.caption else int(row.finite)
        marker, color = marks[state]
        place = readings.index((row.step, row.sign, row.order))
        axes[0].plot(FIGURES.index(row.figure), place, marker, color=color, markersize=9)
    axes[0].set_xticks(range(3), [f"Figure {name[-1]}" for name in FIGURES])
    axes[0].set_yticks(range(len(readings)), [", ".join(reading) for reading in readings])
    axes[0].set_xlim(-0.5, 2.5)
    axes[0].invert_yaxis()
    axes[0].set_title("step, sign and order of the reading", loc="left")
    for state, text in (
        (2, "shows what its caption says"),
        (1, "runs, but does not"),
        (0, "breaks"),
    ):
        marker, color = marks[state]
        axes[0].plot([], [], marker, color=color, label=text)
    figure.legend(loc="outside lower center", ncols=3)
    return figure
