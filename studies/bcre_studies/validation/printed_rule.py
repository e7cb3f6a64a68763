r"""The paper's printed rule, read in every way it can be read, on its own three figures.

Equations (4) to (6) of the paper leave three things open:

    sign    R gains -R gamma (dh - |Sc|) as printed, i.e. gamma R (S + |Sc|), or gamma R (S - Sc)
            as the text needs (flow runs to i + 1, so dh < 0 on a descending slope)
    order   every cell from the old state, or one after the other, downhill or uphill
    step    the literal d = dt = 1, or the largest stable one

Each of the twelve readings runs each figure. Drift and diffusion are those of a single cell's R
over one step without exchange, (d<x>/dt, d<(x - <x>)^2>/2 dt); the amplification is that of the
shortest wave, |G(pi/d)| = |1 - 2 v dt/d - 4 D dt/d^2| for the synchronous rule.

A caption is met where: figure 1, the static layer is eroded until less than a fifth of its area is
left and none of it is negative; figure 2, the pulse has moved downhill and spread,
R >= 0, and the slope is below Sc; figure 3, the same pulse, and the surface has changed
uphill of the pulse's centre by at least 1 % of the largest change.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

import bcre_ca
from bcre_ca.rule import Order, Sign
from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.rounding import significant
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.models.automaton import rule_of
from bcre_studies.reporting import style
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.scene import load
from bcre_studies.sweeps.parallel import each

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SIGNS: tuple[Sign, ...] = ("consistent", "printed")
ORDERS: tuple[Order, ...] = ("synchronous", "right", "left")
STEPS = ("literal", "stable")
FIGURES = ("figure1", "figure2", "figure3")
LEFT_OVER = 0.2
ENDED = 0.01
"""An avalanche has ended where R has fallen to this part of its largest total."""
PATIENCE = {"figure1": 3000.0, "figure2": 60.0, "figure3": 60.0}
"""How long it is waited for: three times what the drift takes from top to foot, or more."""
WHY = "yes or no, by the definitions in the study's text"

Row = dict[str, Any]


def run() -> dict[str, pd.DataFrame]:
    """One row a figure and reading."""
    readings = product(FIGURES, STEPS, SIGNS, ORDERS)
    return {"comparison": pd.DataFrame(each(_read, readings, "printed_rule"))}


def _read(reading: tuple[str, str, Sign, Order]) -> Row:
    return read(*reading)


def read(figure: str, step: str, sign: Sign, order: Order) -> Row:
    """Run a figure with one reading of the rule, and see what becomes of it."""
    scene = load(figure)
    rule = replace(rule_of(scene), sign=sign, order=order)
    rule = replace(rule, dt=1.0) if step == "literal" else rule
    drift, diffusion = moments(rule)
    start = bcre_ca.Pile(*scene.initial(scene.centres()))
    row: Row = {"figure": figure, "step": step, "sign": sign, "order": order, "dt": rule.dt}
    row |= {"drift": drift, "diffusion": diffusion, "amplification": shortest_wave(rule)}
    try:
        with np.errstate(over="ignore", invalid="ignore"):
            piles = _follow(start, rule, [scene.time.until, PATIENCE[figure]], step)
    except FloatingPointError:
        return row | {"finite": False, "R_not_negative": False, "ends": False, "caption": False}
    shown, last = piles[0], piles[-1]
    largest = max(pile.R.sum() for pile in piles)
    mass = start.mass(rule.d)
    return row | {
        "finite": True,
        "mass_error": round(abs(last.mass(rule.d) + last.outflow - mass) / mass, 12),
        "R_not_negative": bool(min(pile.R.min() for pile in piles) >= 0),
        "ends": bool(last.R.sum() < ENDED * largest),
        "caption": caption(figure, start, last if figure == FIGURES[0] else shown),
    }


def _follow(
    pile: bcre_ca.Pile, rule: bcre_ca.Rule, times: list[float], step: str
) -> list[bcre_ca.Pile]:
    """The pile at the given times, the literal step taken whatever comes of it."""
    if step == "stable":
        return list(bcre_ca.frames(pile, rule, times))
    piles = []
    for time in times:
        pile = bcre_ca.advance(pile, rule, round((time - pile.t) / rule.dt))
        piles.append(pile)
    return piles


def moments(rule: bcre_ca.Rule) -> tuple[float, float]:
    """Drift and diffusion per unit time of one wet cell, without exchange, over one step."""
    cells = 201
    R = np.zeros(cells)
    R[cells // 2] = 1.0
    _, R, _ = bcre_ca.step(np.zeros(cells), R, replace(rule, gamma=0.0), "periodic")
    x = (np.arange(cells) - cells // 2) * rule.d
    mean = float(R @ x)
    spread = float(R @ (x - mean) ** 2)
    return significant(mean / rule.dt, 4), significant(spread / rule.dt / 2, 4)


def shortest_wave(rule: bcre_ca.Rule) -> float:
    """Factor per step of R = 1, -1, 1, ... without exchange, in the middle of a long domain."""
    R = np.resize([1.0, -1.0], 200)
    _, after, _ = bcre_ca.step(np.zeros(200), R, replace(rule, gamma=0.0), "periodic")
    return significant(float(abs(after[100] / R[100])), 4)


def caption(figure: str, start: bcre_ca.Pile, end: bcre_ca.Pile) -> bool:
    """Whether one of :data:`FIGURES` shows what the paper's caption says of it."""
    scene = load(figure)
    x, Sc = scene.centres(), scene.material.Sc
    if (end.R < 0).any():
        return False
    if figure == "figure1":
        return bool((end.h >= 0).all() and end.h.sum() <= LEFT_OVER * start.h.sum())
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
    return [_reproducing(table), _printed_sign(table), _literal_step(table)]


def _reproducing(table: pd.DataFrame) -> Claim:
    stable = table[(table["step"] == "stable") & (table["sign"] == "consistent")]
    met = {order: bool(rows["caption"].all()) for order, rows in stable.groupby("order")}
    synchronous = stable[stable["order"] == "synchronous"].iloc[0]
    others = [stable[stable["order"] == order].iloc[0] for order in ("right", "left")]
    drifts = " and ".join(f"{row['drift']:g} ({row['order']})" for row in others)
    return Claim(
        name="the reading that reproduces",
        statement="Consistent sign, synchronous order, stable step: all captions are met.",
        verdict=Verdict.AGREE if met["synchronous"] else Verdict.DISAGREE,
        evidence=f"captions met on all three figures by: "
        f"{', '.join(order for order, good in met.items() if good) or 'none'}; only the "
        f"synchronous order keeps the drift, {synchronous['drift']:g} at figure 1, "
        f"against {drifts}",
        tolerance=WHY,
    )


def _printed_sign(table: pd.DataFrame) -> Claim:
    rows = table[(table["step"] == "stable") & (table["sign"] == "printed")]
    first = rows[rows["figure"] == "figure1"]
    fails = not bool(first["caption"].any())
    met = int(rows["caption"].sum())
    return Claim(
        name="the printed sign",
        statement="With the printed sign the rule cannot show what figure 1's caption says.",
        verdict=Verdict.AGREE if fails else Verdict.DISAGREE,
        evidence=f"it erodes at gamma (S + |Sc|), past repose and on until the surface rises "
        f"downhill at Sc: captions met in {met} of {len(rows)} stable runs, in "
        f"{int(first['caption'].sum())} of {len(first)} of figure 1; figures 2 and 3, which start "
        f"below repose and end soon, do not tell the signs apart",
        tolerance=WHY,
    )


def _literal_step(table: pd.DataFrame) -> Claim:
    rows = table[(table["step"] == "literal") & (table["figure"] != "figure1")]
    fails = not bool(rows["caption"].any())
    synchronous = rows[rows["order"] == "synchronous"].iloc[0]
    return Claim(
        name="the literal step",
        statement="With d = dt = 1 and v = 2.5, as printed, figures 2 and 3 cannot have been made.",
        verdict=Verdict.AGREE if fails else Verdict.DISAGREE,
        evidence=f"the Courant number is 2.5, the shortest wave grows by "
        f"{synchronous['amplification']:g} a step and the effective diffusion is "
        f"{synchronous['diffusion']:g}; of {len(rows)} readings {int(rows['finite'].sum())} stay "
        f"finite and {int(rows['caption'].sum())} meet their caption",
        tolerance=WHY,
    )


def draw(tables: dict[str, pd.DataFrame]) -> Figure:
    """Figures 1 to 3 by the twelve readings: caption met, finite only, or not even that."""
    table = tables["comparison"]
    figure, axes = style.panels(1, 1)
    figure.set_size_inches(8.2, 4.2)
    readings = list(product(STEPS, SIGNS, ORDERS))
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
