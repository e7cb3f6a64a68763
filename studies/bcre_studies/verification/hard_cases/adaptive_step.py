"""Steps that follow their bounds against a fixed step: the same R, each within its own error.

The fixed step is 0.8 of the smallest bound that the run passes. Steps being of first order, the
error of a run is twice what halving all its steps changes; the two runs may differ by both errors.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

import bcre_ca
from bcre_studies.comparison.claim import Claim, quality_check
from bcre_studies.comparison.difference import relative_difference
from bcre_studies.comparison.rounding import significant
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.models.automaton import rule_of
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.scene import Scene, load
from bcre_studies.sweeps.parallel import each

SCENES: dict[str, dict[str, float]] = {
    "figure1": {},
    "figure1, on to t = 1000": {"until": 1000.0},
    "figure2": {},
    "figure3": {},
    "climbing_wave": {},
}
"""The built-in scene, and what is changed in it; by t = 1000 figure 1's avalanche is over."""

FRAMES = 100
"""At which the smallest bound of a run is looked for."""


def run() -> pd.DataFrame:
    """One row a scene."""
    return pd.DataFrame(each(compared, list(SCENES), "hard_cases, steps"))


def compared(name: str) -> dict[str, Any]:
    """A run whose step follows its bounds, and one with a fixed step, both with half the steps."""
    scene = load(name.partition(",")[0]).with_changes(**SCENES[name])
    start = bcre_ca.Pile(*scene.initial(scene.centres()))
    rule, ends, until = rule_of(scene), scene.domain.ends, scene.time.until
    times = [float(t) for t in np.linspace(0.0, until, FRAMES + 1)[1:]]
    frames = list(bcre_ca.frames(start, rule, times, ends))
    auto = frames[-1]
    bounds = (bcre_ca.largest_stable_step(frame, rule, ends) for frame in frames)
    dt = bcre_ca.MARGIN * min(bounds)
    fixed, half = (next(bcre_ca.frames(start, rule, [until], ends, step)) for step in (dt, dt / 2))
    difference = relative_difference(auto.R, fixed.R)
    fixed_error = 2 * relative_difference(half.R, fixed.R)
    error = 2 * relative_difference(_at_half_the_steps(scene), auto.R)
    return {
        "scene": name,
        "steps": auto.steps,
        "lowered": auto.lowered,
        "raised": auto.raised,
        "redone": auto.redone,
        "error": significant(error, 2),
        "fixed_dt": significant(dt, 3),
        "fixed_steps": fixed.steps,
        "fixed_error": significant(fixed_error, 2),
        "difference": significant(difference, 2),
        "verdict": str(Verdict.AGREE if difference <= error + fixed_error else Verdict.DISAGREE),
    }


def _at_half_the_steps(scene: Scene) -> Array:
    """R at the end where every step takes half the share of its bound."""
    start, rule = bcre_ca.Pile(*scene.initial(scene.centres())), rule_of(scene)
    until, ends = scene.time.until, scene.domain.ends
    (end,) = bcre_ca.frames(start, rule, [until], ends, margin=bcre_ca.MARGIN / 2)
    return end.R


def claim(table: pd.DataFrame) -> Claim:
    """The two runs are the same within their errors."""
    rows = "; ".join(
        f"{row.scene}: {row.difference:g} with errors of {row.error:g} ({row.steps} steps, lowered "
        f"{row.lowered} times, raised {row.raised}) and {row.fixed_error:g} ({row.fixed_steps} "
        "steps)"
        for row in table.itertuples()
    )
    agrees = (table["verdict"] == str(Verdict.AGREE)).all()
    return quality_check(
        name="steps that adapt",
        statement="A step that follows its bounds gives the R of a fixed step within the errors of "
        "the two.",
        verdict=Verdict.AGREE if agrees else Verdict.DISAGREE,
        evidence=rows,
        tolerance="the sum of the errors, each twice what halving all steps changes, since a step "
        "is of first order; relative L1 of R at the end",
    )
