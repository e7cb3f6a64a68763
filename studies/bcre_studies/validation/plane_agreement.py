r"""A pulse on a tilted plane in both models: what do the cells add, and in which direction?

To first order the rule on a plane, that of the line along x and -D (R(i,j+1) - R(i,j))/d across,
solves BCRE with

    D_x,eff = D + (v d/2)(1 - v dt/d)    D_y,eff = D    kappa_x,eff = gamma d/2    kappa_y,eff = 0

because only the drift and the slope along x are read one cell aside. So D_eff is a matter of
direction. The relative L1 difference of R from four forms of BCRE:

* nominal: as it stands;
* D_x: with D_x,eff;
* isotropic: with D_x,eff along and across;
* effective: with D_x,eff and kappa_x,eff.

Round pulses on the materials and slopes of the paper's figures (figure 1 at t = 60, and at 120,
when it erodes), in cells of 1, 1/2 and 1/4. BCRE has cells of 1/2; what changes from cells of 1 is
taken as its error. The half y > 0 is run, since the axis is a mirror.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from scipy.interpolate import RectBivariateSpline

import bcre_ca
from bcre_ca.plane import Plane, Sand, frames
from bcre_pde.plane import Material, Problem, solve
from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.difference import relative_difference
from bcre_studies.comparison.rounding import significant
from bcre_studies.comparison.verdict import Verdict, verdict_of, worst
from bcre_studies.comparison.wording import joined, sentences, when
from bcre_studies.models.bcre import SHARE
from bcre_studies.models.registry import AUTOMATON, BCRE
from bcre_studies.reporting import style
from bcre_studies.scenes.domain import Array
from bcre_studies.sweeps.parallel import each

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LENGTH, HALF_WIDTH, SC = 100, 20, 0.5
CELLS = (1.0, 0.5, 0.25)
COARSE, FINE = 1.0, 0.5
"""Cells of BCRE."""

SOLVER_TOLERANCE = 1e-5
NOMINAL, ALONG, ISOTROPIC, EFFECTIVE = "nominal", "D_x", "isotropic", "effective"
FORMS = (NOMINAL, ALONG, ISOTROPIC, EFFECTIVE)
TOLERANCE = 0.05
WHY = "of the sand that rolls, as on a line"
DRAWN, SHOWN = "figure 2", slice(45, 90)
"""The case of the maps, and the rows that they show."""

Row = dict[str, Any]


@dataclass(frozen=True)
class Pulse:
    """A round pulse of height 1 on an incline; dt is ``part`` d."""

    v: float
    gamma: float
    excess: float
    place: float
    width: float
    until: float
    part: float
    D: float = 0.1

    def initial(self, x: Array, y: Array) -> tuple[Array, Array]:
        """h and R at the start."""
        away = ((x - self.place) ** 2 + y**2) / self.width**2
        return -(SC + self.excess) * x + 0 * y, np.exp(-away)


PULSES = {
    "figure 1": Pulse(0.1, 0.01, 3.2, 85.0, 3.0, 60.0, 0.4),
    "figure 1, later": Pulse(0.1, 0.01, 3.2, 85.0, 3.0, 120.0, 0.4),
    "figure 2": Pulse(2.5, 0.01, -0.02, 20.0, 4.0, 20.0, 0.2),
    "figure 3": Pulse(2.5, 0.01, -0.02, 50.0, 4.0, 10.0, 0.2),
}


def run() -> dict[str, pd.DataFrame]:
    """One row a figure and cell length; layers of one of them as maps."""
    cases = [(name, d) for d in reversed(CELLS) for name in PULSES]
    found = each(compared, cases, "plane_agreement")
    rows = sorted((row for row, _ in found), key=lambda row: (row["case"], -row["d"]))
    maps = [table for _, table in found if table is not None]
    return {"comparison": pd.DataFrame(rows), "maps": pd.concat(maps, ignore_index=True)}


def compared(case: tuple[str, float]) -> tuple[Row, pd.DataFrame | None]:
    """The automaton in cells of side d against all forms of BCRE."""
    name, d = case
    pulse = PULSES[name]
    own = automaton(pulse, d)
    found = {form: bcre(pulse, form_of(pulse, form, d), d) for form in FORMS}
    row: Row = {"case": name, "d": d, "Pe": pulse.v * d / pulse.D}
    gaps = {form: relative_difference(own, R) for form, (R, _) in found.items()}
    errors = {form: error for form, (_, error) in found.items()}
    for form in FORMS:
        row |= {form: significant(gaps[form], 2), f"{form}_error": significant(errors[form], 1)}
    is_resolved = [
        errors[form] <= SHARE * max(gaps[form], TOLERANCE) for form in (NOMINAL, EFFECTIVE)
    ]
    verdict = verdict_of(gaps[NOMINAL], is_resolved[0], gaps[EFFECTIVE], is_resolved[1], TOLERANCE)
    row["verdict"] = str(verdict)
    layers = {AUTOMATON.name: own, BCRE.name: found[NOMINAL][0], ALONG: found[ALONG][0]}
    is_drawn = name == DRAWN and d == COARSE
    return row, _table_of(layers) if is_drawn else None


def automaton(pulse: Pulse, d: float) -> Array:
    """R at the end on the half y > 0."""
    h, R = pulse.initial(*_centres(d))
    rule = bcre_ca.Rule(pulse.v, pulse.D, pulse.gamma, SC, d, pulse.part * d)
    (end,) = frames(Sand(h, R), Plane(rule), [pulse.until], rule.dt, threads=1)
    return end.R


def form_of(pulse: Pulse, form: str, d: float) -> Material:
    """BCRE with what the cells add to it."""
    added = pulse.v * d / 2 * (1 - pulse.v * pulse.part)
    m = Material(pulse.v, pulse.D, pulse.D, pulse.gamma, SC)
    if form == NOMINAL:
        return m
    m = replace(m, D_x=m.D_x + added)
    if form == ISOTROPIC:
        return replace(m, D_y=m.D_y + added)
    return replace(m, kappa_x=pulse.gamma * d / 2) if form == EFFECTIVE else m


def bcre(pulse: Pulse, material: Material, d: float) -> tuple[Array, float]:
    """R at the end at the centres of cells of side d, and its relative error."""
    problem = Problem(pulse.initial, material, LENGTH, HALF_WIDTH, sides="closed")
    coarse, fine = (_at_centres(problem, pulse.until, cell, d) for cell in (COARSE, FINE))
    return fine, relative_difference(coarse, fine)


def _at_centres(problem: Problem, until: float, cell: float, d: float) -> Array:
    shape = round(LENGTH / cell), round(HALF_WIDTH / cell)
    solution = solve(problem, [until], shape, SOLVER_TOLERANCE)
    y = np.concatenate([-solution.y[::-1], solution.y])
    R = np.concatenate([solution.R[-1][:, ::-1], solution.R[-1]], axis=1)
    x_wanted, y_wanted = (centres.ravel() for centres in _centres(d))
    return np.asarray(RectBivariateSpline(solution.x, y, R, kx=5, ky=5)(x_wanted, y_wanted))


def _centres(d: float) -> tuple[Array, Array]:
    along, across = (np.asarray(np.arange(round(n / d)) + 0.5) * d for n in (LENGTH, HALF_WIDTH))
    return along[:, None], across[None, :]


def _table_of(layers: dict[str, Array]) -> pd.DataFrame:
    tables = []
    for name, R in layers.items():
        shown = R[SHOWN, :15]
        i, j = np.indices(shown.shape)
        x, y = i.ravel() + SHOWN.start + 0.5, j.ravel() + 0.5
        tables.append(pd.DataFrame({"model": name, "x": x, "y": y, "R": shown.ravel().round(4)}))
    return pd.concat(tables)


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """One claim a figure; the direction of D_eff."""
    table = tables["comparison"]
    return [*(_agreement(name, rows) for name, rows in table.groupby("case")), _direction(table)]


def _agreement(name: Any, rows: pd.DataFrame) -> Claim:
    cases = joined(
        (
            f"d = {row['d']:g}: {row[NOMINAL]:.2g} from BCRE as it stands, {row[ALONG]:.2g} with "
            f"D_x,eff, {row[EFFECTIVE]:.2g} with kappa_x,eff too"
            for _, row in rows.iterrows()
        ),
        "; ",
    )
    needs_kappa = bool((rows[ALONG] > 2 * rows[EFFECTIVE]).all())
    return Claim(
        f"{name} on a plane",
        f"A round pulse on the slope of {name} rolls on a plane in the automaton as in BCRE.",
        worst(rows["verdict"]),
        sentences(cases, when(needs_kappa, "where the pulse erodes, kappa_x,eff counts as well")),
        f"{TOLERANCE:.0%} {WHY}",
    )


def _direction(table: pd.DataFrame) -> Claim:
    carried = table[table["case"].isin(["figure 2", "figure 3"])]
    ratio = carried[ISOTROPIC] / carried[NOMINAL]
    return Claim(
        "an isotropic D_eff",
        "With D_eff in all directions BCRE gives the automaton's layer.",
        Verdict.AGREE if (table[ISOTROPIC] <= TOLERANCE).all() else Verdict.DISAGREE,
        sentences(
            f"it is off by {table[ISOTROPIC].min():.2g} to {table[ISOTROPIC].max():.2g}, "
            f"{ratio.min():.0%} to {ratio.max():.0%} of the nominal difference in figures 2 and 3, "
            f"where D_eff along x alone is off by {carried[ALONG].max():.2g} at most",
            when(
                (carried[ISOTROPIC] > TOLERANCE).all() and (carried[ALONG] <= TOLERANCE).all(),
                "what the cells add has the direction of the flow",
            ),
        ),
        f"{TOLERANCE:.0%} {WHY}",
    )


def draw(tables: dict[str, pd.DataFrame]) -> Figure:
    """Maps of R in figure 2's case, and the differences over the cell length."""
    figure, axes = style.panels(1, 4)
    figure.set_size_inches(13.0, 4.4)
    figure.set_layout_engine("compressed", w_pad=0.1)  # maps of equal axes, all labels inside
    titles = {AUTOMATON.name: "automaton, d = 1", BCRE.name: "BCRE", ALONG: "BCRE with D_x,eff"}
    highest = tables["maps"]["R"].max()
    for axis, (name, table) in zip(axes, tables["maps"].groupby("model", sort=False), strict=False):
        image = _draw_map(axis, table, highest)
        axis.set_title(titles[str(name)], loc="left")
    axes[0].set_ylabel("x, downhill (length)")
    figure.colorbar(image, ax=axes[:3], label="R (length)", shrink=0.8)
    for form, look in zip(FORMS, ("o-", "^-", "x:", "s--"), strict=True):
        rows = tables["comparison"].query("case == 'figure 2'")
        axes[3].plot(rows["d"], rows[form], look, label=form, markerfacecolor="none")
    axes[3].set(xscale="log", yscale="log", xlabel="cell length d")
    axes[3].set_ylabel("relative L1 difference of R")
    axes[3].set_xticks(CELLS, ["1", "1/2", "1/4"])
    axes[3].minorticks_off()
    axes[3].legend()
    axes[3].set_title("figure 2's pulse", loc="left")
    return figure


def _draw_map(axis: Axes, table: pd.DataFrame, highest: float) -> Any:
    half = table.pivot_table(index="x", columns="y", values="R").to_numpy()
    R = np.concatenate([half[:, ::-1], half], axis=1)
    top, foot, side = table["x"].min() - 0.5, table["x"].max() + 0.5, table["y"].max() + 0.5
    look: Any = {"extent": (-side, side, foot, top), "aspect": "equal", "vmin": 0, "vmax": highest}
    image = axis.imshow(R, cmap="YlOrRd", interpolation="nearest", **look)
    axis.grid(visible=False)
    axis.set(xlabel="y, across (length)")
    return image
