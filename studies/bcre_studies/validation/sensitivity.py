r"""Which parameter moves which property of the automaton, and by how much?

The variance of an observable Y over the ranges of its eight parameters is shared out among them
(Sobol 1993; Saltelli et al. 2010, ``scipy.stats.sobol_indices``):

    first order   S_i = Var(E(Y | p_i))/Var(Y)          what p_i moves by itself
    total         T_i = 1 - Var(E(Y | all but p_i))/Var(Y)   with all that it does together

so that S_i <= T_i, and T_i = 0 where Y does not depend on p_i. Intervals are 95 % bootstrap
intervals over the sample.

The scene is figure 1, a pulse 15 from the foot of a slope of 100, until t = 2000. v, D, gamma, d
and the pulse are drawn evenly in the logarithm around figure 1's values, Sc and S0 evenly; dt is a
share of the largest stable step. Observables, one for each of the paper's properties: the slope
S - Sc that is left, the roughness of the surface (its logarithm, as it spans decades), how far
uphill the surface changes, and whether the avalanche runs to the top.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from scipy.stats import loguniform, sobol_indices, uniform

import bcre_ca
from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.models.automaton import rule_of, run_of
from bcre_studies.observables import named
from bcre_studies.reporting import style
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.scene import load
from bcre_studies.sweeps.parallel import each

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SAMPLE, SEED = 1024, 5
"""Points of the Sobol sequence; each takes ten runs."""

TOGETHER = 64
RESAMPLES = 999
CONFIDENCE = 0.95

PARAMETERS: dict[str, Any] = {
    "v": loguniform(0.05, 0.2),
    "D": loguniform(0.05, 0.2),
    "gamma": loguniform(0.005, 0.02),
    "Sc": uniform(0.3, 0.4),
    "S0": uniform(0.7, 3.0),
    "pulse": loguniform(0.1, 10.0),
    "d": loguniform(0.5, 2.0),
    "dt": uniform(0.2, 0.7),
}
OBSERVABLES = {
    "slope": "S - Sc that is left",
    "roughness": "log of the roughness",
    "reach": "reach uphill",
    "top": "runs to the top",
}

SMOOTHEST = 1e-6
"""A length; a surface that is smoother counts as so rough, as its logarithm has no end."""

SMALL = 0.05
WHY = "of the variance: a twentieth, as in every comparison"
COLOR = "#b5480f"


@contextmanager
def _seeded() -> Iterator[None]:
    """SciPy's resampling of Sobol indices takes no generator: it draws from NumPy's global one."""
    state = np.random.get_state()  # noqa: NPY002
    np.random.seed(SEED)  # noqa: NPY002
    try:
        yield
    finally:
        np.random.set_state(state)  # noqa: NPY002


def run() -> dict[str, pd.DataFrame]:
    """First-order and total indices of every parameter for every observable."""
    indices = sobol_indices(
        func=_observables,
        n=SAMPLE,
        dists=list(PARAMETERS.values()),
        rng=np.random.default_rng(SEED),
    )
    with np.errstate(invalid="ignore"), warnings.catch_warnings(action="ignore"), _seeded():
        intervals = indices.bootstrap(CONFIDENCE, n_resamples=RESAMPLES)  # degenerate for a 0
    rows = []
    for i, observable in enumerate(OBSERVABLES):
        for j, parameter in enumerate(PARAMETERS):
            row: dict[str, Any] = {"observable": observable, "parameter": parameter}
            for kind in ("first_order", "total_order"):
                interval = getattr(intervals, kind).confidence_interval
                value = float(getattr(indices, kind)[i, j])
                row |= _with_interval(kind, value, interval.low[i, j], interval.high[i, j])
            rows.append(row)
    return {"comparison": pd.DataFrame(rows)}


def _with_interval(name: str, value: float, low: float, high: float) -> dict[str, float]:
    """Rounded to the third place; where no resample differs there is no interval but the value."""
    ends = {"low": low, "high": high}
    row = {name: value} | {
        f"{name}_{end}": value if math.isnan(at) else float(at) for end, at in ends.items()
    }
    return {key: round(number, 3) + 0.0 for key, number in row.items()}


def _observables(points: Array) -> Array:
    """Observables (4, n) of points (8, n)."""
    columns = points.T.tolist()
    blocks = [columns[i : i + TOGETHER] for i in range(0, len(columns), TOGETHER)]
    found = each(measure_all, blocks, f"sensitivity: {len(columns)} runs")
    return np.concatenate(found).T


def measure_all(points: list[list[float]]) -> Array:
    """Observables of some points, shape (points, 4)."""
    return np.array([measure(*point) for point in points])


def measure(
    v: float,
    D: float,
    gamma: float,
    Sc: float,
    S0: float,
    pulse: float,
    d: float,
    dt: float,
) -> tuple[float, ...]:
    """The observables of one run; ``dt`` in parts of the largest stable step."""
    base = load("figure1")
    scene = base.with_changes(
        v=v,
        D=D,
        gamma=gamma,
        Sc=Sc,
        cells=round(base.domain.length / d),
        until=2000.0,
        **{"surface.0.slope": S0, "rolling.0.amplitude": pulse},
    )
    start = bcre_ca.Pile(*scene.initial(scene.centres()))
    times = [0.0, scene.time.until]
    frames = bcre_ca.frames(start, rule_of(scene), times, scene.domain.ends, margin=dt)
    run = run_of(scene, list(frames))
    roughness = math.log10(max(named.roughness(run), SMOOTHEST))
    return (named.slope(run) - Sc, roughness, named.reach(run), named.top(run))


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """Whether the numerical parameters matter, and what decides each property."""
    table = tables["comparison"].set_index(["observable", "parameter"])
    return [
        _does_not_matter(table, "d", "cell length", "The properties do not depend on the cells."),
        _does_not_matter(table, "dt", "time step", "The properties do not depend on the step."),
        _decided(table),
    ]


def _does_not_matter(table: pd.DataFrame, parameter: str, name: str, statement: str) -> Claim:
    totals = table.xs(parameter, level="parameter")
    lowest, highest = totals["total_order_low"].max(), totals["total_order_high"].max()
    if highest <= SMALL:
        verdict = Verdict.AGREE
    else:
        verdict = Verdict.DISAGREE if lowest > SMALL else Verdict.UNRESOLVED
    shares = "; ".join(f"{OBSERVABLES[str(key)]} {_total(row)}" for key, row in totals.iterrows())
    return Claim(
        name,
        statement,
        verdict,
        f"of the variance it moves, alone and together with the others, {shares}",
        f"{SMALL:.0%} {WHY}",
    )


def _decided(table: pd.DataFrame) -> Claim:
    """Whether one parameter decides each property alone."""
    leading = {
        observable: table.loc[observable]["first_order"].idxmax() for observable in OBSERVABLES
    }
    first = {key: table.loc[(key, name)] for key, name in leading.items()}
    alone = all(row["first_order_low"] > 0.5 for row in first.values())
    evidence = "; ".join(
        f"{OBSERVABLES[key]}: {leading[key]}, {row['first_order']:.2f} "
        f"({row['first_order_low']:.2f} to {row['first_order_high']:.2f}) by itself and "
        f"{row['total_order']:.2f} in all"
        for key, row in first.items()
    )
    return Claim(
        "one parameter decides",
        "Each property is decided by one parameter alone.",
        Verdict.AGREE if alone else Verdict.DISAGREE,
        f"the largest first-order index is, of {evidence}",
        "more than half of the variance, by the lower end of the interval",
    )


def _total(row: pd.Series) -> str:
    return (
        f"{row['total_order']:.2f} ({row['total_order_low']:.2f} to {row['total_order_high']:.2f})"
    )


def draw(tables: dict[str, pd.DataFrame]) -> Figure:
    """First-order and total indices, a panel an observable."""
    figure, axes = style.panels(2, 2)
    figure.set_size_inches(9.4, 6.4)
    table = tables["comparison"].set_index("observable")
    for axis, (observable, label) in zip(axes, OBSERVABLES.items(), strict=True):
        rows = table.loc[observable]
        places = np.arange(len(rows))
        for kind, shift, fill in (("first_order", -0.2, COLOR), ("total_order", 0.2, "none")):
            values = rows[kind].to_numpy()
            errors = [values - rows[f"{kind}_low"], rows[f"{kind}_high"] - values]
            axis.bar(
                places + shift,
                values,
                0.36,
                yerr=np.maximum(errors, 0.0),
                facecolor=fill,
                edgecolor=COLOR,
                ecolor="0.3",
                capsize=2,
                label=kind.replace("_order", "").replace("first", "first order"),
            )
        axis.set_xticks(places, rows["parameter"])
        axis.set_ylabel("share of the variance")
        axis.set_title(label[0].upper() + label[1:], loc="left")
    axes[0].legend()
    return figure
