r"""How each scheme converges to exact solutions: observed order and error.

For every exact solution of ``bcre_pde.exact``, e(d) = mean|R - R_exact| (L1), its root mean square
(L2) and its maximum on five grids: for the automaton at three parts of its largest stable step, and
for every method of the PDE. The observed order is the slope of -ln e over ln cells, fitted over the
three finest grids on which e is above what rounding and the tolerance in time leave. The printed,
upwind automaton is formally of order 1, the limited one of order 2, the PDE's right-hand side of
order 5. The calibrated automaton is formally of order 1, since its Euler step knows of no flow in
which R and u both vary; where D_eff = D and only one of the two varies its leading error is
gone, so it may do better and is held to no upper end.

Past the breaking time t* = 1/(gamma max R0') of the climbing wave there is no smooth solution: the
order there is that of the differences between successive grids.
"""

from __future__ import annotations

import itertools
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

import bcre_ca
import bcre_pde
from bcre_ca.rule import Scheme
from bcre_pde import Method, exact, simple_wave
from bcre_pde.solve import TOLERANCE
from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.rounding import significant
from bcre_studies.comparison.verdict import Verdict, worst
from bcre_studies.models.registry import AUTOMATON, BCRE, SCHEMES
from bcre_studies.reporting import style
from bcre_studies.scenes.domain import Array
from bcre_studies.sweeps.parallel import each

if TYPE_CHECKING:
    from matplotlib.figure import Figure

CA, PDE = AUTOMATON.name, BCRE.name
GRIDS = {CA: (200, 400, 800, 1600, 3200), PDE: (25, 50, 100, 200, 400)}
SURFACE_MODE_GRIDS = (8, 12, 16, 24, 32)
"""A mode of 1e-7 leaves no more room above rounding."""
STEP_SHARES = (0.25, 0.5, 0.9)
AUTOMATA: tuple[tuple[Scheme, float], ...] = (
    *(("upwind", share) for share in STEP_SHARES),
    ("calibrated", 0.5),
    ("limited", 0.5),
)
"""The automaton's schemes, each with its part of the largest stable step."""
METHODS: tuple[Method, ...] = ("runge-kutta", "RK45", "DOP853", "LSODA", "BDF")
EXPLICIT = ("runge-kutta", "RK45", "DOP853")
LIMITED_GRIDS = (100, 200, 400, 800, 1600)
"""Of the limited scheme; surface modes, on whose 1e-7 rounding counts earlier, on cells twice as
long."""
IMPLICIT_GRIDS = (25, 40, 60, 90, 135)
"""Their Jacobians make finer grids slow, and their tolerance leaves no room for more."""
FORMAL_ORDER = {CA: 1.0, "calibrated": 1.0, "limited": 2.0, PDE: 5.0}
ORDER_RANGE = {
    CA: (0.9, 1.1),
    "calibrated": (0.9, np.inf),
    "limited": (1.8, 2.2),
    PDE: (4.0, np.inf),
}
WHY_ORDER = (
    "within a tenth of the formal order for the automaton; for the PDE one below its formal 5, "
    "since the limiter may cost an order at isolated points, and no upper end, since a solution "
    "smoother than its grid asks for converges faster"
)
WHY_ORDER_OF_SCHEME = {
    "calibrated": "a tenth below the formal order, and no upper end, since its leading error is "
    "calibrated away where D_eff = D and the flow is linear",
    "limited": "within a tenth of the formal order",
}
WHY_LOWER = {
    "calibrated": "",
    "limited": ". With a curvature term the stable step goes with d^2, so that v dt/d falls from "
    "grid to grid and takes less and less of the drift's error, (1 - c)(1 - 2 c) d^2, away: there "
    "the order is that of grids on which v dt/d is not small yet",
}
LARGEST_ERROR = {CA: 0.01, "calibrated": 0.01, "limited": 0.01, PDE: 5e-4}
WHY_ERROR = (
    "on the finest grid, relative to the spread of R: 1 % for the first-order scheme; for the PDE "
    "a hundredth of the 5 % that the studies call agreement"
)
TIME_TOLERANCE = {"explicit": 1e-13, "implicit": 1e-10}
TIME_ERROR = {"explicit": 1e-11, "implicit": 1e-7}
"""What these tolerances leave at the end, relative to R: a hundred to a thousand steps of each."""
BROKEN_GRIDS = (100, 200, 400, 800, 1600)


@cache
def solutions() -> dict[str, exact.ExactSolution]:
    """The exact solutions, with parameters of order one."""
    found = (
        exact.rolling_mode(wavenumber=0.5, v=1.0, D=0.1),
        exact.surface_mode(wavenumber=0.5, gamma=0.5, kappa=0.0, v=1.0),
        exact.surface_mode(wavenumber=0.5, gamma=0.5, kappa=0.1, v=1.0),
        exact.frozen_slope_release(excess=0.6, v=1.0, D=0.3, gamma=0.2),
        exact.climbing_hump(v=1.0, gamma=0.5, height=0.3, width=1.5, length=20.0, until=2.0),
        exact.tilted_climbing_wave(excess=0.4, v=1.0, gamma=0.2, height=0.3, width=2.5),
        exact.steady_filling(w=0.1, v=1.0, gamma=0.2),
        exact.saturated_flow(amplitude=0.3, wavenumber=0.5, v=1.0, v_up=0.7),
    )
    return {_label(solution): solution for solution in found}


def _label(solution: exact.ExactSolution) -> str:
    kappa = solution.material.kappa
    return (
        f"{solution.name}, kappa = {kappa:g}" if solution.name == "surface mode" else solution.name
    )


def errors(solution: exact.ExactSolution, x: Array, R: Array) -> dict[str, float]:
    """L1, L2 and maximum error of R in the window, absolute; at the solution's last time."""
    inside = (x >= solution.window[0]) & (x <= solution.window[1])
    gap = np.abs(R - solution.layers(x, solution.until)[1])[inside]
    return {"L1": float(gap.mean()), "L2": float(np.sqrt((gap**2).mean())), "max": float(gap.max())}


def automaton_layer(
    solution: exact.ExactSolution, cells: int, share: float, scheme: Scheme = "upwind"
) -> tuple[Array, Array]:
    """Cell centres and R of the automaton at the last time; dt is a share of the stable step.

    That of the thick flow is :func:`thick_step`.
    """
    material, d = solution.material, solution.length / cells
    x = np.asarray((np.arange(cells) + 0.5) * d)
    pile = bcre_ca.Pile(*solution.layers(x, 0.0))
    rule = bcre_ca.Rule(
        material.v,
        material.D,
        material.gamma,
        material.Sc,
        d,
        dt=1.0,
        scheme=scheme,
        kappa=material.kappa,
        v_up=material.v_up,
    )
    if np.isfinite(material.v_up):
        steps = int(np.ceil(solution.until / (share * thick_step(pile, rule))))
        rule = replace(rule, dt=solution.until / steps)
        return x, bcre_ca.advance(pile, rule, steps, solution.ends).R
    rule = replace(rule, dt=share * bcre_ca.largest_stable_step(pile, rule, solution.ends))
    (end,) = bcre_ca.frames(pile, rule, [solution.until], solution.ends, rule.dt)
    return x, end.R


def thick_step(pile: bcre_ca.Pile, rule: bcre_ca.Rule) -> float:
    """Largest stable dt of a flow that is thick everywhere, gamma R >> v_up.

    A cell then loses v_up max(Sc - S, 0) whatever its layer, so that v dt/d + v_up dt max(Sc -
    S, 0)/min R <= 1 and v_up dt/d <= 1. :meth:`bcre_ca.Rule.max_stable_step` has gamma max(Sc -
    S, 0) instead, the loss of the thinnest layers, which must be allowed for where there are any.
    """
    slopes = -np.diff(pile.h) / rule.d
    loss = rule.v_up * max(rule.Sc - float(slopes.min()), 0.0) / float(pile.R.min())
    of_layer = 1 / (rule.v / rule.d + loss)
    return min(of_layer / 2 if rule.scheme == "limited" else of_layer, rule.d / rule.v_up)


def pde_layer(
    solution: exact.ExactSolution, cells: int, method: Method, tolerance: float | None = None
) -> tuple[Array, Array]:
    """Cell centres and R of the PDE at the last time, by default with next to no error in time."""
    if tolerance is None:
        tolerance = TIME_TOLERANCE["explicit" if method in EXPLICIT else "implicit"]
    end = bcre_pde.solve(
        solution.problem, [solution.until], cells, method=method, tolerance=tolerance
    )
    return end.x, end.R[-1]


def observed_order(cells: Array, error: Array, floor: float) -> float:
    """Slope of -ln(error) over ln(cells), the three finest grids with an error above the floor."""
    usable = error > floor
    x, y = np.log(cells[usable][-3:]), np.log(error[usable][-3:])
    return float(-np.polyfit(x, y, 1)[0]) if x.size >= 2 else float("nan")


def run() -> dict[str, pd.DataFrame]:
    """The errors of every scheme on every grid, the orders fitted to them, and the broken wave."""
    cases = [
        (label, model, scheme)
        for label, solution in solutions().items()
        for model, schemes in ((CA, AUTOMATA), (PDE, METHODS))
        for scheme in schemes
        if not (scheme in ("LSODA", "BDF") and solution.name == "surface mode")
    ]
    rows = [row for rows in each(_errors_of, cases, "order_of_accuracy") for row in rows]
    table = pd.DataFrame(rows)
    fits = [
        _fit(dict(zip(KEYS, key, strict=True)), group)
        for key, group in table.groupby(list(KEYS), sort=False)
    ]
    broken = [
        row for rows in each(_past_breaking, [CA, PDE], "order_of_accuracy, t > t*") for row in rows
    ]
    return {
        "comparison": pd.DataFrame(fits),
        "errors": table.drop(columns="floor"),
        "past_breaking": pd.DataFrame(broken),
    }


KEYS = ("solution", "model", "scheme")


def _errors_of(case: tuple[str, str, Any]) -> list[dict[str, Any]]:
    label, model, scheme = case
    solution = solutions()[label]
    rows = []
    for cells in _grids(solution, model, scheme):
        if model == CA:
            x, R = automaton_layer(solution, cells, scheme[1], scheme[0])
        else:
            x, R = pde_layer(solution, cells, scheme)
        spread = float(np.ptp(solution.layers(x, solution.until)[1]))
        absolute = errors(solution, x, R)
        rows.append(
            {
                "solution": label,
                "model": model,
                "scheme": _named(*scheme) if model == CA else scheme,
                "cells": cells,
                **{norm: significant(error / spread, 2) for norm, error in absolute.items()},
                "floor": _floor(solution, model, scheme) / spread,
            }
        )
    return rows


def _named(scheme: Scheme, share: float) -> str:
    kind = "" if scheme == "upwind" else f"{scheme}, "
    return f"{kind}{share:g} of the stable step"


def _kind(model: str, scheme: str) -> str:
    """The key of :data:`FORMAL_ORDER`: the scheme of the automaton if not the paper's, or model."""
    scheme, comma, _ = scheme.partition(",")
    return scheme if comma else model


def _grids(solution: exact.ExactSolution, model: str, scheme: Any) -> tuple[int, ...]:
    if model == CA and scheme[0] != "limited":
        return GRIDS[CA]
    if model == CA:
        coarser = 2 if solution.name == "surface mode" else 1
        return tuple(cells // coarser for cells in LIMITED_GRIDS)
    if solution.name == "surface mode":
        return SURFACE_MODE_GRIDS
    return IMPLICIT_GRIDS if scheme in ("LSODA", "BDF") else GRIDS[PDE]


def _floor(solution: exact.ExactSolution, model: str, scheme: Any) -> float:
    """Error below which the tolerance in time, or rounding, counts."""
    if model == CA:
        return solution.floor
    left = TIME_ERROR["explicit" if scheme in EXPLICIT else "implicit"]
    largest = float(solution.layers(np.linspace(*solution.window, 200), solution.until)[1].max())
    return max(solution.floor, left * largest)


def _fit(key: dict[str, str], group: pd.DataFrame) -> dict[str, Any]:
    """Fitted orders, error at 200 cells, and whether both are what they must be."""
    cells, floor = group["cells"].to_numpy(dtype=float), float(group["floor"].iloc[0])
    orders = {
        f"order_{norm}": significant(observed_order(cells, group[norm].to_numpy(), floor), 3)
        for norm in ("L1", "L2", "max")
    }
    error = float(group["L1"].iloc[-1])
    kind = _kind(key["model"], key["scheme"])
    low, high = ORDER_RANGE[kind]
    good = low <= orders["order_L1"] <= high and error <= LARGEST_ERROR[kind]
    return {
        **key,
        "formal_order": FORMAL_ORDER[kind],
        **orders,
        "L1_on_finest": error,
        "verdict": str(Verdict.AGREE if good else Verdict.DISAGREE),
    }


def _past_breaking(model: str) -> list[dict[str, Any]]:
    """Differences of R between successive grids before and after the wave has broken."""
    solution = solutions()["climbing wave"]
    x = np.linspace(0.5, 19.5, 400)
    start = solution.layers(np.linspace(0, 20, 20001), 0.0)[1]
    rise = float(np.gradient(start, 0.001).max())
    breaking = simple_wave.breaking_time(solution.material.gamma * rise)
    rows = []
    for part in (1.1, 1.5, 2.0):
        later = replace(solution, until=part * breaking)
        profiles = []
        for cells in BROKEN_GRIDS:
            at, R = (
                automaton_layer(later, cells, 0.5)
                if model == CA
                else pde_layer(later, cells, "runge-kutta", TOLERANCE)
            )
            profiles.append(np.interp(x, at, R))
        gaps = [np.abs(a - b) for a, b in itertools.pairwise(profiles)]
        change = np.array([gap.mean() for gap in gaps])
        finer = np.array(BROKEN_GRIDS[1:], dtype=float)
        rows.append(
            {
                "model": model,
                "t_over_t_star": part,
                "order": significant(observed_order(finer, change, 0.0), 3),
                "change_on_finest": significant(float(change[-1]), 3),
                "largest_at_x": significant(float(x[int(np.argmax(gaps[-1]))]), 3),
            }
        )
    return rows


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """Each side converges at its formal order; past the breaking time neither does."""
    table, broken = tables["comparison"], tables["past_breaking"]
    claims = []
    kinds = [_kind(*key) for key in zip(table["model"], table["scheme"], strict=True)]
    for model, name in ((CA, "automaton"), (PDE, "PDE")):
        rows = table[[kind == model for kind in kinds]]
        low, high = rows["order_L1"].min(), rows["order_L1"].max()
        claims.append(
            Claim(
                name=f"order of the {name}",
                statement=f"The {name} converges to the exact solutions at order "
                f"{FORMAL_ORDER[model]:g}.",
                verdict=worst(rows["verdict"]),
                evidence=f"fitted L1 orders from {low:g} to {high:g} over {len(rows)} pairs of "
                f"solution and scheme, largest error on a finest grid "
                f"{rows['L1_on_finest'].max():.2g}",
                tolerance=f"order at least {ORDER_RANGE[model][0]:g}: "
                f"{WHY_ORDER}; error {LARGEST_ERROR[model]:g}: {WHY_ERROR}",
            )
        )
    claims += [_claim_of_scheme(table, scheme) for scheme in ("calibrated", "limited")]
    after = broken[broken["t_over_t_star"] > 1]
    falls = bool((after["order"] <= 1.2).all())
    claims.append(
        Claim(
            name="past the breaking time",
            statement="Past t* the observed order of both falls to about one or below.",
            verdict=Verdict.AGREE if falls else Verdict.DISAGREE,
            evidence="orders "
            + ", ".join(
                f"{row.order:g} ({row.model}, t = {row.t_over_t_star:g} t*, largest change at "
                f"x = {row.largest_at_x:g})"
                for row in after.itertuples()
            ),
            tolerance="order at most 1.2: a jump that is resolved by neither converges in L1 at "
            "order one at best, give or take the fit",
        )
    )
    return claims


def _claim_of_scheme(table: pd.DataFrame, scheme: str) -> Claim:
    """The order of one of the automaton's schemes beside the printed one."""
    rows = table[(table["model"] == CA) & table["scheme"].str.startswith(f"{scheme},")]
    off = rows[rows["verdict"] != str(Verdict.AGREE)]
    least, most = rows.loc[rows["order_L1"].idxmin()], rows.loc[rows["order_L1"].idxmax()]
    why = WHY_LOWER[scheme] if len(off) else ""
    outside = "; ".join(f"{row.solution}: {row.order_L1:g}" for row in off.itertuples())
    return Claim(
        name=f"order of the {scheme} scheme",
        statement=f"The {scheme} automaton converges to the exact solutions at order "
        f"{FORMAL_ORDER[scheme]:g}{' or more' if ORDER_RANGE[scheme][1] == np.inf else ''}.",
        verdict=worst(rows["verdict"]),
        evidence=f"fitted L1 orders from {least['order_L1']:g} ({least['solution']}) to "
        f"{most['order_L1']:g} ({most['solution']}), largest error on a finest grid "
        f"{rows['L1_on_finest'].max():.2g}; outside: {outside or 'none'}{why}",
        tolerance=f"order at least {ORDER_RANGE[scheme][0]:g}: {WHY_ORDER_OF_SCHEME[scheme]}; "
        f"error {LARGEST_ERROR[scheme]:g}: {WHY_ERROR}",
    )


DRAWN = {
    "0.5 of the stable step": AUTOMATON,
    "calibrated, 0.5 of the stable step": SCHEMES["calibrated"],
    "limited, 0.5 of the stable step": SCHEMES["limited"],
    "runge-kutta": BCRE,
}


def draw(tables: dict[str, pd.DataFrame]) -> Figure:
    """L1 error against cells, one panel a solution: the automaton's schemes and one of the PDE."""
    table = tables["errors"]
    labels = list(dict.fromkeys(table["solution"]))
    figure, axes = style.panels(2, (len(labels) + 1) // 2)
    for axis, label in zip(axes, labels, strict=False):
        rows = table[(table["solution"] == label) & table["scheme"].isin(list(DRAWN))]
        for (model, scheme), line in rows.groupby(["model", "scheme"], sort=False):
            axis.loglog(line["cells"], line["L1"], **DRAWN[str(scheme)].marked_line)
            slope = FORMAL_ORDER[_kind(str(model), str(scheme))]
            first = line.iloc[0]
            guide = first["L1"] * (line["cells"] / first["cells"]) ** -slope
            axis.loglog(line["cells"], guide, color="0.6", linewidth=0.8)
        axis.set_title(label, loc="left")
        axis.xaxis.set_minor_formatter("")
        axis.set_xlabel("cells")
        axis.set_ylabel("L1 error of R / spread of R")
    for axis in axes[len(labels) :]:
        axis.set_axis_off()
    handles, names = axes[0].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside lower center", ncols=len(handles), handlelength=3.4)
    return figure
