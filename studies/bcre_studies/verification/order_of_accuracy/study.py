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

The other models have exact solutions of their own: the simple wave of a thick flow, the exponential
slope and the silo of Hadeler and Kuttler, the Cole-Hopf wave of Hwa and Kardar, the half heap and
undermining of Prigozhin and Zaltzman.
"""

from __future__ import annotations

from itertools import chain
from typing import TYPE_CHECKING

import pandas as pd

from bcre_ca.rule import Scheme
from bcre_studies.comparison.claim import Claim
from bcre_studies.models.registry import AUTOMATON, BCRE, SCHEMES
from bcre_studies.reporting import style
from bcre_studies.sweeps.parallel import each
from bcre_studies.verification.order_of_accuracy import claims
from bcre_studies.verification.order_of_accuracy.expected import CA, EXPECTED, PDE, kind
from bcre_studies.verification.order_of_accuracy.further_models import CASES, observed
from bcre_studies.verification.order_of_accuracy.layers import METHODS, solutions
from bcre_studies.verification.order_of_accuracy.observed import errors_of, fit, past_breaking

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STEP_SHARES = (0.25, 0.5, 0.9)
AUTOMATA: tuple[tuple[Scheme, float], ...] = (
    *(("upwind", share) for share in STEP_SHARES),
    ("calibrated", 0.5),
    ("limited", 0.5),
)
"""The automaton's schemes, each with its part of the largest stable step."""
DRAWN = {
    "0.5 of the stable step": AUTOMATON,
    "calibrated, 0.5 of the stable step": SCHEMES["calibrated"],
    "limited, 0.5 of the stable step": SCHEMES["limited"],
    "runge-kutta": BCRE,
}
SLOWEST = "steady filling"
KEYS = ("solution", "model", "scheme")

Tables = dict[str, pd.DataFrame]


def run() -> Tables:
    """The errors of every scheme on every grid, the orders fitted to them, and the broken wave."""
    cases = [
        (label, model, scheme)
        for label, solution in solutions().items()
        for model, schemes in ((CA, AUTOMATA), (PDE, METHODS))
        for scheme in schemes
        if not (scheme in ("LSODA", "BDF") and solution.name == "surface mode")
    ]
    slow_first = sorted(cases, key=lambda case: (case[1] == CA, case[0] != SLOWEST))
    found = dict(zip(slow_first, each(errors_of, slow_first, "order_of_accuracy"), strict=True))
    table = pd.DataFrame(list(chain(*(found[case] for case in cases))))
    fits = [
        fit(dict(zip(KEYS, key, strict=True)), group)
        for key, group in table.groupby(list(KEYS), sort=False)
    ]
    broken = each(past_breaking, [CA, PDE], "order_of_accuracy, t > t*")
    further = each(observed, range(len(CASES)), "order_of_accuracy, further models")
    return {
        "comparison": pd.DataFrame(fits),
        "errors": table.drop(columns="floor"),
        "past_breaking": pd.DataFrame(list(chain(*broken))),
        "further_models": pd.DataFrame(further),
    }


def judge(tables: Tables) -> list[Claim]:
    """Each side converges at its formal order; past the breaking time neither does."""
    return claims.judge(tables)


def draw(tables: Tables) -> Figure:
    """L1 error against cells, one panel a solution: the automaton's schemes and one of the PDE."""
    table = tables["errors"]
    labels = list(dict.fromkeys(table["solution"]))
    figure, axes = style.panels(2, (len(labels) + 1) // 2)
    for axis, label in zip(axes, labels, strict=False):
        rows = table[(table["solution"] == label) & table["scheme"].isin(list(DRAWN))]
        for (model, scheme), line in rows.groupby(["model", "scheme"], sort=False):
            axis.loglog(line["cells"], line["L1"], **DRAWN[str(scheme)].marked_line)
            slope = EXPECTED[kind(str(model), str(scheme))].order
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
