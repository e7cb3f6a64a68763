"""Is it the seed? The scene rough_slope with many random surfaces.

For each of 32 seeds the root mean square of u at the end, relative to the start, in the automaton,
in BCRE with kappa = 0 and in BCRE with D_eff and kappa_eff. Means carry a 95 % bias-corrected and
accelerated bootstrap interval over the seeds (Efron 1987, ``scipy.stats.bootstrap``).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from scipy.stats import bootstrap

from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.rounding import significant
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.models.registry import AUTOMATON, BCRE, COMPARED
from bcre_studies.observables.fronts import roughness
from bcre_studies.reporting import style
from bcre_studies.scenes.scene import load
from bcre_studies.sweeps.parallel import each

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SEEDS = range(1, 33)
CELLS = 400
TOLERANCE = 0.05
WHY = "of the roughness at the start, as in the study of single modes"
CONFIDENCE = 0.95


def run() -> dict[str, pd.DataFrame]:
    """One row a seed, and the means with their intervals."""
    seeds = pd.DataFrame(each(_seed, SEEDS, "random_roughness"))
    rows = []
    for model in COMPARED:
        values = seeds[model.column].to_numpy()
        interval = bootstrap(
            (values,), np.mean, confidence_level=CONFIDENCE, rng=np.random.default_rng(0)
        ).confidence_interval
        rows.append(
            {
                "quantity": "RMS of u, end over start",
                "model": model.column,
                "seeds": values.size,
                "mean": significant(float(values.mean()), 4),
                "low": significant(float(interval.low), 4),
                "high": significant(float(interval.high), 4),
            }
        )
    return {"comparison": pd.DataFrame(rows), "seeds": seeds}


def _seed(seed: int) -> dict[str, float]:
    scene = load("rough_slope").with_changes(**{"surface.1.seed": seed, "step": 1.0})
    times = [0.0, scene.time.until]
    row: dict[str, float] = {"seed": seed}
    for model in COMPARED:
        u = model.run(scene, times, None if model is AUTOMATON else CELLS).u
        row[model.column] = significant(roughness(u[-1]) / roughness(u[0]), 4)
    return row


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """The verdict on the rough slope does not hang on its seed."""
    table = tables["comparison"].set_index("model")
    automaton, pde, effective = (table.loc[model.column] for model in COMPARED)
    apart = pde["low"] - automaton["high"] > TOLERANCE
    close = max(
        abs(effective["high"] - automaton["low"]), abs(automaton["high"] - effective["low"])
    )
    if not apart:
        verdict = Verdict.AGREE
    else:
        verdict = Verdict.EXPLAINED if close <= TOLERANCE else Verdict.DISAGREE
    return [
        Claim(
            name="random roughness",
            statement="Random roughness decays in the automaton as in BCRE, whatever its seed.",
            verdict=verdict,
            evidence=f"of the roughness at the start there is left, in the mean of "
            f"{automaton['seeds']} seeds with its 95 % interval: {_interval(automaton)} in the "
            f"automaton, {_interval(pde)} in BCRE with kappa = 0, {_interval(effective)} with "
            f"D_eff and kappa_eff",
            tolerance=f"{TOLERANCE:.0%} {WHY}",
        )
    ]


def _interval(row: pd.Series) -> str:
    return f"{row['mean']:.3g} ({row['low']:.4g} to {row['high']:.4g})"


def draw(tables: dict[str, pd.DataFrame]) -> Figure:
    """The ratio of every seed, model by model, with the mean and its interval."""
    seeds, table = tables["seeds"], tables["comparison"].set_index("model")
    figure, (axis,) = style.panels(1, 1)
    figure.set_size_inches(7.0, 3.6)
    for place, model in enumerate(COMPARED):
        spread = np.linspace(-0.25, 0.25, len(seeds))
        look = model.markers(fillstyle="full", markersize=4.5, alpha=0.5)
        axis.plot(place + spread, seeds[model.column], **look)
        row = table.loc[model.column]
        axis.errorbar(
            place,
            row["mean"],
            [[row["mean"] - row["low"]], [row["high"] - row["mean"]]],
            fmt="k_",
            markersize=22,
            capsize=4,
        )
    axis.set_xticks(range(len(COMPARED)), [AUTOMATON.label, BCRE.label, "BCRE, effective"])
    axis.set_ylim(0, 1.05)
    axis.set_ylabel("RMS of u, end over start")
    axis.set_title("32 seeds, mean and 95 % interval", loc="left")
    return figure
