r"""Where a step stops being stable: measured by stepping, and predicted by closed forms.

A small periodic pile under a uniform layer on the repose line is disturbed by noise and stepped; it
is unstable where the disturbance grows (``growth``). This is done over two planes
of numbers per step,

    drift and spread    (v dt/d, D dt/d^2) without exchange
    climb and drift     (gamma R dt/d, v dt/d) without diffusion

for every order and scheme of the automaton, and for the explicit methods of BCRE with fixed steps,
on 40 x 40 points; and along 40 rays, each a material whose step is lengthened, the boundary is
found by bisection. The prediction is von Neumann's, |G| <= 1 for every wave: for the automaton
``amplification``, where for the synchronous upwind and calibrated rules it is
also the condition that no weight is negative; for BCRE :func:`bcre_pde.theory.stable`, the
stability polynomial of the method over the spectrum of the differences in space.

Besides, the bound by which a model itself refuses or limits its steps is put to the test, before
anything has happened: :func:`bcre_ca.largest_stable_step` and
:func:`bcre_pde.largest_explicit_step`. For the automaton it must also keep R >= 0, which small
waves do not show: thousands of layers with dry cells take one step of it, and the longest step that
leaves none of them negative is found.

LSODA and BDF change their step and order as they go and are implicit where it is stiff: no fixed
boundary belongs to them. That they stay bounded at ten times the explicit step is measured.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np
import pandas as pd
from scipy.optimize import bisect

import bcre_ca
import bcre_pde
from bcre_pde import Method, theory
from bcre_pde.explicit import ExplicitMethod
from bcre_studies.comparison.claim import Claim, quality_check
from bcre_studies.comparison.rounding import significant
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.comparison.wording import sentences, when
from bcre_studies.models.registry import AUTOMATON, BCRE, MODELS, Look
from bcre_studies.reporting import style
from bcre_studies.sweeps.parallel import each
from bcre_studies.verification.stability.amplification import Numbers, Variant, rule_with, stable
from bcre_studies.verification.stability.growth import (
    PDE,
    SIZE,
    STEPS,
    automaton_grows,
    noise,
    pde_grows,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

POINTS = 40
RAYS = 40
GOAL = 0.02
WHY = "2 %: waves just beyond a boundary grow too slowly to be seen in the steps taken"
FINEST = 0.001
"""Relative width to which a boundary is bisected."""

DRIFT_AND_SPREAD = "drift and spread"
CLIMB_AND_DRIFT = "climb and drift"
PLANES = (DRIFT_AND_SPREAD, CLIMB_AND_DRIFT)

VARIANTS = (
    Variant("upwind", "synchronous"),
    Variant("calibrated", "synchronous"),
    Variant("limited", "synchronous"),
    Variant("upwind", "right"),
    Variant("upwind", "left"),
)
METHODS: tuple[ExplicitMethod, ...] = ("runge-kutta", "RK45", "DOP853")
IMPLICIT: tuple[Method, ...] = ("LSODA", "BDF")

AUTOMATON_LIMITS = {DRIFT_AND_SPREAD: (1.9, 1.2), CLIMB_AND_DRIFT: (1.3, 1.3)}
PDE_LIMITS = {DRIFT_AND_SPREAD: (2.9, 0.7), CLIMB_AND_DRIFT: (2.9, 2.9)}
DOP853_LIMITS = {DRIFT_AND_SPREAD: (4.7, 1.4), CLIMB_AND_DRIFT: (4.7, 4.7)}
"""How far the planes reach; no point of theirs lies on a predicted boundary."""

ANGLES = theory.ANGLES[::16]

Test = Callable[[Numbers], bool]


class Diagram(NamedTuple):
    """A plane of steps for one model: the automaton's variant or BCRE's method."""

    model: str
    variant: Variant | ExplicitMethod
    plane: str

    def limits(self) -> tuple[float, float]:
        if self.model == AUTOMATON.name:
            return AUTOMATON_LIMITS[self.plane]
        return (DOP853_LIMITS if self.variant == "DOP853" else PDE_LIMITS)[self.plane]

    def numbers(self, x: float, y: float) -> Numbers:
        """Those of a point of the plane."""
        return Numbers(x, y, 0.0) if self.plane == DRIFT_AND_SPREAD else Numbers(y, 0.0, x)

    def grows(self) -> Test:
        """Measured."""
        if self.model == AUTOMATON.name:
            return lambda numbers: automaton_grows(numbers, cast("Variant", self.variant))
        return lambda numbers: pde_grows(numbers, cast("ExplicitMethod", self.variant))

    def predicted(self) -> Test:
        """|G| <= 1."""
        return self._no_faster_than(theory.ROUNDING)

    def no_visible_growth(self) -> Test:
        """|G| <= 10^(1/n) in the n steps that are taken: growth that they can show."""
        steps = STEPS if self.model == AUTOMATON.name else PDE[1]
        return self._no_faster_than(10 ** (1 / steps) - 1)

    def _no_faster_than(self, growth: float) -> Test:
        if self.model == AUTOMATON.name:
            return lambda numbers: stable(numbers, cast("Variant", self.variant), growth)
        return lambda numbers: _pde_stable(cast("ExplicitMethod", self.variant), growth, numbers)

    def accepted(self, numbers: Numbers) -> bool:
        """Whether the model's own bound, under the layer of 1, lets a step of 1 pass."""
        return self.bound(numbers) >= 1

    def bound(self, numbers: Numbers) -> float:
        """The model's own largest step, in steps of these numbers."""
        if self.model == AUTOMATON.name:
            rule = rule_with(numbers, cast("Variant", self.variant))
            pile = bcre_ca.Pile(np.zeros(8), np.ones(8))
            return bcre_ca.largest_stable_step(pile, rule, "periodic")
        v, D, gamma = numbers
        return bcre_pde.largest_explicit_step(bcre_pde.Material(v, D, gamma, 0.0), 1.0, 1.0)


def _pde_stable(method: ExplicitMethod, growth: float, numbers: Numbers) -> bool:
    """:func:`bcre_pde.theory.stable`, on fewer waves and up to some growth."""
    return all(
        theory.amplification_bound(*numbers, method, ANGLES, rough=rough) <= 1 + growth
        for rough in (False, True)
    )


def run() -> dict[str, pd.DataFrame]:
    """One row a plane; the planes row by row and their boundaries; positivity; LSODA and BDF."""
    cases = [Diagram(AUTOMATON.name, variant, plane) for variant in VARIANTS for plane in PLANES]
    cases += [Diagram(BCRE.name, method, plane) for method in METHODS for plane in PLANES]
    measured = each(_measure, cases, "stability")
    layers = each(_positivity, VARIANTS, "stability, R >= 0")
    return {
        "comparison": pd.DataFrame([row for row, _, _ in measured]),
        "boundaries": pd.DataFrame([row for _, rows, _ in measured for row in rows]),
        "points": pd.DataFrame([row for _, _, rows in measured for row in rows]),
        "positivity": pd.DataFrame(layers),
        "implicit": pd.DataFrame(each(_implicit, IMPLICIT, "stability, implicit")),
    }


Row = dict[str, Any]


def _measure(diagram: Diagram) -> tuple[Row, list[Row], list[Row]]:
    head: Row = {"model": diagram.model, "variant": str(diagram.variant), "plane": diagram.plane}
    boundaries = [head | row for row in _boundaries(diagram)]
    x, y = (limit * (np.arange(POINTS) + 0.5) / POINTS for limit in diagram.limits())
    tests = diagram.grows(), diagram.predicted(), diagram.accepted
    grows, predicted, accepted = (
        np.array([[test(diagram.numbers(a, b)) for a in x] for b in y]) for test in tests
    )
    rows = [
        head | {"y": round(float(b), 4), "stable": "".join("01"[not cell] for cell in line)}
        for b, line in zip(y, grows, strict=True)
    ]
    distance, visible = (
        max(abs(row["measured"] / row[column] - 1) for row in boundaries)
        for column in ("predicted", "visible")
    )
    wrong = int((predicted & grows).sum())
    share = [row["bound"] / row["measured"] for row in boundaries]
    near = distance <= GOAL and not wrong
    summary = head | {
        "points": grows.size,
        "grow": int(grows.sum()),
        "predicted_stable_but_grows": wrong,
        "predicted_unstable_but_calm": int((~predicted & ~grows).sum()),
        "distance_percent": round(100 * distance, 1),
        "distance_visible_percent": round(100 * visible, 1),
        "refused": int((~accepted).sum()),
        "accepted_but_grows": int((accepted & grows).sum()),
        "bound_percent_least": round(100 * min(share)),
        "bound_percent_most": round(100 * max(share)),
        "verdict": str(Verdict.AGREE if near else Verdict.DISAGREE),
    }
    return summary, boundaries, rows


def _boundaries(diagram: Diagram) -> list[Row]:
    """Along every ray, in the units of the plane: measured, predicted, and the model's own."""
    width, height = diagram.limits()
    grows, predicted, visible = diagram.grows(), diagram.predicted(), diagram.no_visible_growth()
    rows = []
    for angle in (np.arange(RAYS) + 0.5) / RAYS * np.pi / 2:
        ray = diagram.numbers(width * np.cos(angle), height * np.sin(angle))
        expected = _last(predicted, ray, 0.02, 2.0)
        shown = _last(visible, ray, 0.02, 2.0)
        found = _last(lambda numbers: not grows(numbers), ray, 0.3 * expected, 2.5 * expected)
        rows.append(
            {
                "angle": round(float(np.degrees(angle)), 3),
                "predicted": significant(expected, 3),
                "visible": significant(shown, 3),
                "measured": significant(found, 3),
                "bound": significant(diagram.bound(ray), 3),
            }
        )
    return rows


def _last(holds: Test, ray: Numbers, low: float, high: float) -> float:
    """The largest t up to which it holds along the ray, where at ``low``, but not at ``high``."""

    def sign(t: float) -> float:
        return 1.0 if holds(ray.times(t)) else -1.0

    return float(bisect(sign, low, high, xtol=FINEST * low))


LAYER_CELLS = 50_000


def _rough_layer() -> Any:
    """A layer of random thickness over eight decades, half of its cells dry; (N,)."""
    random = np.random.default_rng(7)
    thickness = 10 ** random.uniform(-8, 0, LAYER_CELLS)
    return np.where(random.uniform(size=LAYER_CELLS) < 0.5, thickness, 0.0)


def _positivity(variant: Variant) -> Row:
    """The longest step, in parts of the bound, that leaves a rough layer >= 0, over the rays."""
    start, (width, height) = _rough_layer(), AUTOMATON_LIMITS[DRIFT_AND_SPREAD]
    ratios = []
    for angle in (np.arange(RAYS) + 0.5) / RAYS * np.pi / 2:
        ray = Numbers(width * np.cos(angle), height * np.sin(angle), 0.0)
        bound = rule_with(ray, variant).max_stable_step()

        def stays(numbers: Numbers) -> bool:
            h, R = np.zeros_like(start), start.copy()
            bcre_ca.march(h, R, rule_with(numbers, variant), 1, "periodic")
            return bool(R.min() >= 0)

        ratios.append(_last(stays, ray.times(bound), 0.5, 4.0))
    least = min(ratios)
    return {
        "variant": str(variant),
        "cells": LAYER_CELLS,
        "least_percent_of_bound": round(100 * least, 1),
        "most_percent_of_bound": round(100 * max(ratios), 1),
        "verdict": str(Verdict.AGREE if least >= 1 - FINEST else Verdict.DISAGREE),
    }


EXPLICIT_STEPS = 100_000
TEN = 10


def _implicit(method: Method) -> Row:
    """Noise of 1e-2 over so many explicit steps: how long are the method's, and does it grow?"""
    material, cells = bcre_pde.Material(0.05, 1.0, 0.01, 0.5), 32
    u, R = 1e-2 / SIZE * np.array(noise(cells))
    explicit = bcre_pde.largest_explicit_step(material, 1.0, 1.0)

    def initial(x: Any) -> tuple[Any, Any]:
        at = np.minimum(x, cells - 1).astype(int)
        return u[at] - material.Sc * x, 1 + R[at]

    problem = bcre_pde.Problem(initial, material, float(cells), "periodic")
    until = EXPLICIT_STEPS * explicit
    end = bcre_pde.solve(problem, [until], cells, method, tolerance=1e-3)
    deviation = max(np.abs(end.u[-1]).max(), np.abs(end.R[-1] - 1).max())
    bounded = bool(deviation <= max(np.abs(u).max(), np.abs(R).max()))
    long = bool(until / end.evaluations >= TEN * explicit)
    return {
        "method": method,
        "until_in_explicit_steps": EXPLICIT_STEPS,
        "mean_step_at_least_ten": long,
        "bounded": bounded,
        "verdict": str(Verdict.AGREE if bounded and long else Verdict.DISAGREE),
    }


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """Who knows beforehand where a step stops being stable."""
    table = tables["comparison"]
    limited = table["variant"] == "limited"
    dop853 = table["variant"] == "DOP853"
    automaton = table["model"] == AUTOMATON.name
    return [
        _predicted("the automaton's rules", table[automaton & ~limited], ""),
        _predicted("the flux-limited rule", table[limited], LIMITED),
        _predicted("BCRE by runge-kutta and RK45", table[~automaton & ~dop853], EXPLICIT, True),
        _predicted("BCRE by DOP853", table[dop853], DOP853, True),
        _bounds(table, tables["positivity"]),
        _implicit_methods(tables["implicit"]),
    ]


LIMITED = (
    "The prediction is that of a limiter that passes every difference or none. What it does to "
    "noise lies between; beyond v dt/d = 1 with much diffusion, where no step may be taken "
    "anyway, this keeps noise calm that either limiter alone would let grow"
)
EXPLICIT = (
    "Fehlberg's method lets smooth waves of 10 to 50 cells grow from v dt/dx = 1.44 on, but by "
    "less than 1e-4 a step up to 1.51, too slowly to be seen in the steps taken"
)
DOP853 = (
    "What the limiter of the differences does changes between its twelve stages, so that the step "
    "is no polynomial of the spectrum; SciPy's error control, not this boundary, keeps its steps "
    "short"
)


def _predicted(what: str, rows: pd.DataFrame, why: str, quality: bool = False) -> Claim:
    wrong, farthest = int(rows["predicted_stable_but_grows"].sum()), rows["distance_percent"].max()
    worst = rows.loc[rows["distance_percent"].idxmax()]
    good = wrong == 0 and farthest <= 100 * GOAL
    return Claim(
        name=f"boundary of {what}",
        statement=f"Of {what} no step predicted stable lets noise grow, and the boundary lies "
        f"within {GOAL:.0%} of the predicted one.",
        verdict=Verdict.AGREE if good else Verdict.DISAGREE,
        evidence=sentences(
            f"{wrong} of {rows['points'].sum()} points are predicted stable but grow; the "
            f"boundary is at most {farthest:g} % away ({worst['variant']}, {worst['plane']}), and "
            f"{rows['distance_visible_percent'].max():g} % from where growth by 10 in the steps "
            "taken is predicted",
            when(not good, why),
        ),
        tolerance=WHY,
        quality=quality,
    )


def _bounds(table: pd.DataFrame, positivity: pd.DataFrame) -> Claim:
    passed = int(table["accepted_but_grows"].sum())
    least = positivity.loc[positivity["least_percent_of_bound"].idxmin()]
    limited = positivity[positivity["variant"] == "limited"].iloc[0]
    good = passed == 0 and (positivity["verdict"] == str(Verdict.AGREE)).all()
    pde = table[table["variant"] == "runge-kutta"]
    return quality_check(
        name="known before it happens",
        statement="No step that a model's own bound lets pass is unstable, and none of the "
        "automaton's makes a layer negative.",
        verdict=Verdict.AGREE if good else Verdict.DISAGREE,
        evidence=f"{passed} of {table['points'].sum()} points are accepted but grow. A rough layer "
        f"stays >= 0 up to {least['least_percent_of_bound']:g} % of the bound ({least['variant']}) "
        f"or more; the limited rule's, which allows for the worst, could be passed by "
        f"{limited['least_percent_of_bound'] - 100:.0f} %. The bound of BCRE's runge-kutta is "
        f"{pde['bound_percent_least'].min()} to {pde['bound_percent_most'].max()} % of the "
        "measured boundary",
        tolerance="none: a bound that is passed once is no bound",
    )


def _implicit_methods(table: pd.DataFrame) -> Claim:
    good = (table["verdict"] == str(Verdict.AGREE)).all()
    return quality_check(
        name="methods without a boundary",
        statement=f"LSODA and BDF stay bounded at {TEN} times the explicit step.",
        verdict=Verdict.AGREE if good else Verdict.DISAGREE,
        evidence="; ".join(
            f"{row['method']}: {'bounded' if row['bounded'] else 'not bounded'}, in steps that are "
            f"{'' if row['mean_step_at_least_ten'] else 'not '}at least {TEN} explicit ones long "
            "in the mean"
            for _, row in table.iterrows()
        ),
        tolerance="no deviation may exceed the largest one at the start",
    )


LABELS = {
    DRIFT_AND_SPREAD: ("v dt/d", "D dt/d²"),
    CLIMB_AND_DRIFT: ("gamma R dt/d", "v dt/d"),
}


def draw(tables: dict[str, pd.DataFrame]) -> Figure:
    """Measured stable points shaded, the predicted boundary and the model's own bound as lines."""
    table = tables["comparison"]
    figure, axes = style.panels(4, 4)
    for axis, (_, head) in zip(axes, table.iterrows(), strict=True):
        _draw_plane(axis, head, tables)
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=len(handles))
    return figure


def _draw_plane(axis: Axes, head: pd.Series[Any], tables: dict[str, pd.DataFrame]) -> None:
    def of(name: str) -> pd.DataFrame:
        rows = tables[name]
        return rows[(rows["variant"] == head["variant"]) & (rows["plane"] == head["plane"])]

    variant = next((v for v in VARIANTS if str(v) == head["variant"]), head["variant"])
    width, height = Diagram(head["model"], variant, head["plane"]).limits()
    model = MODELS[head["model"]]
    for row in of("points").itertuples():
        stable_cells = [i for i, mark in enumerate(row.stable) if mark == "1"]
        runs = [(i * width / POINTS, width / POINTS) for i in stable_cells]
        axis.broken_barh(
            _joined(runs),
            (float(row.y) - height / POINTS / 2, height / POINTS),
            color=model.color,
            alpha=0.22,
            linewidth=0,
        )
    rows = of("boundaries")
    angle = np.radians(rows["angle"])
    for column, line in LINES.items():
        x, y = (
            rows[column] * size * part
            for size, part in ((width, np.cos(angle)), (height, np.sin(angle)))
        )
        axis.plot(x, y, **line)
    axis.set(xlim=(0, width), ylim=(0, height))
    x_label, y_label = LABELS[head["plane"]]
    cell = "d" if model is AUTOMATON else "dx"
    axis.set_xlabel(x_label.replace("dt/d", f"dt/{cell}"))
    axis.set_ylabel(y_label.replace("dt/d", f"dt/{cell}"))
    axis.set_title(f"{model.label}, {head['variant']}", loc="left")


LINES: dict[str, Look] = {
    "predicted": {"color": "black", "linewidth": 1.2, "label": "predicted, |G| = 1"},
    "bound": {
        "color": "0.35",
        "linewidth": 1.2,
        "linestyle": (0, (3, 2)),
        "label": "the model's own bound",
    },
    "measured": {
        "color": "#a01c5a",
        "linestyle": "",
        "marker": ".",
        "markersize": 4,
        "label": "measured, by bisection (shaded: stable points)",
    },
}


def _joined(runs: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Neighbouring bars as one."""
    joined: list[tuple[float, float]] = []
    for start, length in runs:
        if joined and abs(sum(joined[-1]) - start) < length / 2:
            joined[-1] = joined[-1][0], joined[-1][1] + length
        else:
            joined.append((start, length))
    return joined
