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

import bcre_pde
from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.rounding import significant
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.models.simulate import effective_problem_of, problem_of, run_automaton
from bcre_studies.observables.fronts import roughness
from bcre_studies.reporting import style
from bcre_studies.scenes.scene import load
from bcre_studies.sweeps.each import each

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SEEDS = range(1, 33)
CELLS = 400
TOLERANCE = 0.05
WHY = "of the roughness at the start, as in the study of single modes"
CONFIDENCE = 0.95
MODELS = {"ca": "automaton", "pde": "pde", "pde effective": "pde_effective"}


def run() -> dict[str, pd.DataFrame]:
    """One row a seed, and the means with their intervals."""
    seeds = pd.DataFrame(each(_seed, SEEDS, "random_roughness"))
    rows = []
    for column in MODELS.values():
        values = seeds[column].to_numpy()
        interval = bootstrap(
            (values,), np.mean, confidence_level=CONFIDENCE, rng=np.random.default_rng(0)
        ).confidence_interval
        rows.append(
            {
                "quantity": "RMS of u, end over start",
                "model": column,
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
    runs = {
        "automaton": run_automaton(scene, times).u,
        "pde": bcre_pde.solve(problem_of(scene), times, CELLS).u,
        "pde_effective": bcre_pde.solve(effective_problem_of(scene), times, CELLS).u,
    }
    ratios = {name: roughness(u[-1]) / roughness(u[0]) for name, u in runs.items()}
    return {"seed": seed, **{name: significant(ratio, 4) for name, ratio in ratios.items()}}


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """The verdict on the rough slope does not hang on its seed."""
    table = tables["comparison"].set_index("model")
    words = {name: _interval(row) for name, row in table.iterrows()}
    automaton, pde, effective = (table.loc[name] for name in MODELS.values())
    apart = pde["low"] - automaton["high"] > TOLERANCE
    close = max(
        abs(effective["high"] - automaton["low"]), abs(automaton["high"] - effective["low"])
    )
    if not apart:
        verdict = Verdict.AGREE
    else:
        verdict = Verdict.AGREE_EFFECTIVE if close <= TOLERANCE else Verdict.DISAGREE
    return [
        Claim(
            name="random roughness",
            statement="Random roughness decays in the automaton as in BCRE, whatever its seed.",
            verdict=verdict,
            evidence=f"of the roughness at the start there is left, in the mean of "
            f"{automaton['seeds']} seeds with its 95 % interval: {words['automaton']} in the "
            f"automaton, {words['pde']} in BCRE with kappa = 0, {words['pde_effective']} with "
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
    for place, (model, column) in enumerate(MODELS.items()):
        color, marker = style.MODELS[model]["color"], style.MARKERS[model]
        spread = np.linspace(-0.25, 0.25, len(seeds))
        axis.plot(place + spread, seeds[column], marker, color=color, alpha=0.5)
        row = table.loc[column]
        axis.errorbar(
            place,
            row["mean"],
            [[row["mean"] - row["low"]], [row["high"] - row["mean"]]],
            fmt="k_",
            markersize=22,
            capsize=4,
        )
    axis.set_xticks(range(len(MODELS)), ["automaton", "BCRE", "BCRE, effective"])
    axis.set_ylim(0, 1.05)
    axis.set_ylabel("RMS of u, end over start")
    axis.set_title("32 seeds, mean and 95 % interval", loc="left")
    return figure
