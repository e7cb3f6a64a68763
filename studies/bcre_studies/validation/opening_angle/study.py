r"""The angle at which an avalanche opens on a tilted plane, x downhill and y across.

R_t + (v R - D_x R_x)_x - (D_y R_y)_y = E. Below Sd what starts at a point stays within a wedge of
half-angle theta. At Sd theta is 90 degrees, and the avalanche climbs (Bouchaud and Cates, Granular
Matter 1 (1998) 101). With Pe = v d/D_x, a = D_y/D_x and
q(m) = Pe (1 - e^-m) - 2 (cosh m - 1) - sigma d^2/D_x,

    BCRE        tan^2 theta = (D_y/D_x) (S - Sc)/(Sd - S)
    automaton   cot theta = max over m of (2/m) asinh( (1/2) sqrt(q(m)/a) )     for any stable dt

(:func:`bcre_ca.plane.theory.edge`).

* ``theta``: measured from a trace that changes no slope (``trace``), with the error of the
  extrapolation. "effective" has D_x + v d/2, what the cells add in a sum over time. "isotropic"
  adds it across as well. Both are closed forms, which BCRE is measured to have.
* ``Sd - Sc where theta is 90``: cot^2 theta is nearly straight over 1/(S - Sc) in both models. A
  parabola through three measured angles gives where it is 0.
* ``edge of a layer``: avalanches that do erode, in a layer of thickness 0.2 on a rigid base, from
  pulses of three sizes (``layer``). The angle between x - 20 and x + 20, and what it tends to.
* ``threshold S0 - Sc``: from which slope on a finite pulse on a plane brings the top down, and in
  the columns "line" a ridge as high and wide (``pulses``). "effective" has kappa_x = gamma d/2 too,
  because a finite pulse erodes.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from bcre_ca.plane.theory import edge
from bcre_ca.theory import second_critical_excess
from bcre_pde import Measured
from bcre_pde.plane import Material, theory
from bcre_pde.theory import second_critical_slope
from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.compare import Comparison
from bcre_studies.comparison.rounding import significant, to_error
from bcre_studies.models.registry import AUTOMATON, BCRE
from bcre_studies.sweeps.parallel import each
from bcre_studies.validation.opening_angle import claims, layer, pictures, pulses, trace

if TYPE_CHECKING:
    from matplotlib.figure import Figure

THETA, CRITICAL, EDGE, THRESHOLD = (
    "theta",
    "Sd - Sc where theta is 90",
    "edge of a layer",
    "threshold S0 - Sc",
)
QUANTITIES = (THETA, CRITICAL, EDGE, THRESHOLD)
FIGURE_1, OTHERS = "figure 1", "other materials"
SC = 0.5

MATERIALS = {
    FIGURE_1: Material(0.1, 0.1, 0.1, 0.01, SC),
    "fast": Material(0.3, 0.1, 0.1, 0.05, SC),
    "a quarter across": Material(0.1, 0.1, 0.025, 0.01, SC),
    "four times across": Material(0.1, 0.1, 0.4, 0.01, SC),
    "three times across": Material(0.25, 0.1, 0.3, 0.03, SC),
}
ANGLES = (
    *((FIGURE_1, 1.0, excess) for excess in (0.3, 0.5, 1.0, 1.5)),
    *(("fast", 1.0, excess) for excess in (0.3, 1.0, 1.5)),
    *((FIGURE_1, 0.25, excess) for excess in (0.5, 1.0, 1.5)),
    ("a quarter across", 1.0, 0.5),
    ("four times across", 1.0, 0.5),
    ("three times across", 0.8, 0.7),
)
"""Material, cell length, S - Sc."""

NEAR_SD = (0.4, 0.55, 0.7)
"""Parts of Sd - Sc at which the angles are measured that are continued to 90 degrees."""

LENGTH = 500
LAYERS = ((0.3, 1.0), (0.5, 1.0), (0.5, 10.0), (0.5, 100.0), (1.0, 1.0))
"""S - Sc and the pulse."""
PLACES = (100.0, 200.0, 400.0)
DRAWN = (0.5, 1.0)
PULSES = (0.1, 1.0, 10.0, 100.0)

Row = dict[str, Any]
Result = tuple[list[Row], dict[str, pd.DataFrame]]
Case = tuple[Callable[..., Result], tuple[Any, ...]]


def run() -> dict[str, pd.DataFrame]:
    """All rows, the slow ones measured first; the edges of the layers, and one of them as a map."""
    cases: list[Case] = [(threshold, (pulse,)) for pulse in PULSES]
    cases += [(angle, case) for case in sorted(ANGLES, key=lambda case: case[1])]
    cases += [(edge_of_layer, case) for case in LAYERS]
    cases += [(critical, (name, model)) for name in (FIGURE_1, "fast") for model in (True, False)]
    found = each(_case, cases, "opening_angle")
    rows = sorted((row for rows, _ in found for row in rows), key=_place)
    tables = {"comparison": pd.DataFrame(rows)}
    for name in ("edges", "eroded"):
        tables[name] = pd.concat([more[name] for _, more in found if name in more])
    return tables


def _place(row: Row) -> tuple[int, str, float]:
    return QUANTITIES.index(row["quantity"]), row["case"], -row.get("d", 0.0)


def _case(case: Case) -> Result:
    function, arguments = case
    return function(*arguments)


def angle(name: str, d: float, excess: float) -> Result:
    """theta in both models on one slope."""
    m = MATERIALS[name]
    own = trace.measured_in_automaton(m, excess, d)
    pde = trace.measured_in_bcre(m, excess)
    effective, isotropic = (
        theory.opening_angle(trace.with_diffusion_of_cells(m, d, across), m.Sc + excess)
        for across in (False, True)
    )
    expected = edge(m.v, m.D_x, m.D_y, m.gamma * excess, d).theta
    result = Comparison(
        round(own.theta, 4), Measured(*pde), Measured(effective, 0.0), claims.TOLERANCE
    ).row(expected, theory.opening_angle(m, m.Sc + excess))
    row = {
        **_head(THETA, FIGURE_1 if name == FIGURE_1 and d == 1 else OTHERS, m),
        "d": d,
        "S - Sc": excess,
        "automaton_error": significant(own.error, 1),
        "isotropic": significant(isotropic, 5),
        **result,
    }
    return [row], {}


def critical(name: str, in_automaton: bool) -> Result:
    """S - Sc at which theta becomes 90 degrees, continued from below, in one of the models."""
    m = MATERIALS[name]
    if in_automaton:
        column, expected = AUTOMATON.column, second_critical_excess(m.v, m.D_x, m.gamma, 1.0)
    else:
        column, expected = BCRE.column, second_critical_slope(m.v, m.D_x, m.gamma, 0.0)
    excesses = np.array([part * expected for part in NEAR_SD])
    angles = [
        trace.measured_in_automaton(m, excess, 1.0)
        if in_automaton
        else trace.measured_in_bcre(m, excess)
        for excess in excesses
    ]
    squares = [1 / math.tan(math.radians(found.theta)) ** 2 for found in angles]
    row = {
        **_head(CRITICAL, name, m),
        "d": 1.0,
        column: significant(zero_of(excesses, squares), 4),
        f"{column}_theory": significant(expected, 5),
    }
    return [row], {}


def zero_of(excesses: Any, squares: Any) -> float:
    """S - Sc where the parabola through cot^2 theta over 1/(S - Sc) is 0, beyond the slopes."""
    roots = np.roots(np.polyfit(1 / np.asarray(excesses), squares, 2))
    beyond = [1 / root.real for root in roots if abs(root.imag) < 1e-9 and root.real > 0]
    return min((s for s in beyond if s > max(excesses)), default=math.nan)


def edge_of_layer(excess: float, pulse: float) -> Result:
    """The angle of what an avalanche leaves in a layer, near and far."""
    m = MATERIALS[FIGURE_1]
    found = layer.triangle(m, excess, pulse, LENGTH)
    opened = layer.opening(m, excess, found)
    row = {
        **_head(EDGE, FIGURE_1, m),
        "d": 1.0,
        "S - Sc": excess,
        "pulse": pulse,
        **{f"at x = {x:g}": round(layer.angle_at(found, x), 2) for x in PLACES},
        AUTOMATON.column: round(opened.theta.value, 2),
        "automaton_error": significant(opened.theta.error, 1),
        f"{AUTOMATON.column}_theory": significant(
            edge(m.v, m.D_x, m.D_y, m.gamma * excess, 1.0).theta, 5
        ),
        "factor": significant(opened.slowness, 2),
    }
    shown = found.x >= 0
    side = pd.DataFrame({"x": found.x[shown], "y": found.side[shown].round(3)})
    tables = {"edges": side[9::10].assign(excess=excess, pulse=pulse)}
    if (excess, pulse) == DRAWN:
        tables["eroded"] = pictures.table_of(found)
    return [row], tables


def threshold(pulse: float) -> Result:
    """From which slope on the pulse brings the top down, on a plane and on a line."""
    m = MATERIALS[FIGURE_1]
    own, line = (pulses.in_automaton(m, pulse, columns) for columns in (pulses.PLANE, pulses.LINE))
    pde, line_pde = (pulses.in_bcre(m, pulse, is_line) for is_line in (False, True))
    effective = pulses.in_bcre(pulses.with_cells(m), pulse, False)
    row = {
        **_head(THRESHOLD, FIGURE_1, m),
        "d": 1.0,
        "pulse": pulse,
        "automaton_error": significant(own.error, 1),
        **Comparison(to_error(own.value, own.error), pde, effective, claims.TOLERANCE).row(),
        "line": to_error(line.value, line.error),
        "line_pde": to_error(line_pde.value, line_pde.error),
    }
    return [row], {}


def _head(quantity: str, case: str, m: Material) -> Row:
    numbers = {"v": m.v, "D": m.D_x, "D across": m.D_y, "gamma": m.gamma}
    return {"quantity": quantity, "case": case, **numbers}


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """Closed forms, the two models against each other, 90 degrees, layers, finite pulses."""
    table = tables["comparison"]
    angles, critical, layers, thresholds = (
        table[table["quantity"] == quantity] for quantity in QUANTITIES
    )
    return [
        claims.closed_form(angles, AUTOMATON, claims.AUTOMATON_DEGREES),
        claims.closed_form(angles, BCRE, claims.BCRE_DEGREES),
        claims.at_figure_1(angles[angles["case"] == FIGURE_1]),
        claims.at_other_parameters(angles[angles["case"] == OTHERS]),
        claims.direction(angles),
        claims.right_angle(critical),
        claims.layers(layers, PLACES),
        claims.slowness(layers),
        claims.pulses(thresholds),
        claims.same_threshold(thresholds),
    ]


def draw(tables: dict[str, pd.DataFrame]) -> Figure:
    """See :func:`bcre_studies.validation.opening_angle.pictures.draw`."""
    table = tables["comparison"]
    by_quantity = {q: table[table["quantity"] == q] for q in QUANTITIES}
    return pictures.draw(
        by_quantity[THETA], by_quantity[THRESHOLD], tables["edges"], tables["eroded"]
    )
