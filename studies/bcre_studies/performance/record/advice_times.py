"""Are the times that ``bcre advise`` predicts those that the advised runs take?

On random scenes, with the pilots timed on this machine as a user's are. Times depend on the machine
and on what else it does, so that they belong into the record of speed, not into a study.
"""

from __future__ import annotations

import math
import statistics
from typing import Any

import pandas as pd
from rich.console import Console
from rich.progress import track

from bcre_studies.advisor.advise import Effort, advise
from bcre_studies.advisor.options import Option
from bcre_studies.advisor.pilot import FINEST, run_model
from bcre_studies.advisor.question import Question
from bcre_studies.comparison.rounding import significant
from bcre_studies.performance.random_scenes import random_scene
from bcre_studies.timing.costs import recorded

SCENES = 30
PILOTS_S = 1.0
FEW = 100
"""Cells of the finest pilot where times are extrapolated."""

RUNS = 3
"""Runs of the advised model; their median counts."""

FACTOR = 2.0
"""A prediction hits if it is right to within this factor."""


def time_hits() -> pd.DataFrame:
    """Predicted and measured seconds of every option of every scene.

    Once as a user is advised, and once extrapolated to finer grids from pilots of at most
    :data:`FEW` cells.

    Returns
    -------
    One row per scene and option: scene, pilots ("all" or "coarse"), advised (is it the best?),
    model, cells, predicted_s, measured_s, ratio (predicted over measured) and hit. Half a minute
    once all is compiled.
    """
    rows = []
    for index in track(
        range(SCENES), "advice, times", transient=True, console=Console(stderr=True)
    ):
        question = Question(random_scene(index))
        for pilots, finest in (("all", FINEST), ("coarse", FEW)):
            effort = Effort(recorded(), seconds=PILOTS_S, finest=finest)
            for place, option in enumerate(advise(question, effort).options):
                if pilots == "coarse" and not FEW < option.cells <= FINEST:
                    continue
                rows.append(
                    {"scene": index, "pilots": pilots, "advised": place == 0}
                    | _measured(question, option)
                )
    return pd.DataFrame(rows)


def _measured(question: Question, option: Option) -> dict[str, Any]:
    runs = (
        run_model(question.scene, option.model, question.times, option.cells).wall_s
        for _ in range(RUNS)
    )
    measured = statistics.median(runs)
    ratio = option.seconds / measured
    return {
        "model": option.model,
        "cells": option.cells,
        "predicted_s": significant(option.seconds, 2),
        "measured_s": significant(measured, 2),
        "ratio": significant(ratio, 2),
        "hit": abs(math.log(ratio)) <= math.log(FACTOR),
    }
