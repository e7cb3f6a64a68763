"""A study of short cases that loads no model: most of a run of it is time in which to kill it."""

from __future__ import annotations

import time

from bcre_studies.sweeps.parallel import each

CASES = 16
SECONDS = 0.1


def run():
    import pandas as pd

    return {"comparison": pd.DataFrame(each(measure, range(CASES), "quick"))}


def measure(case):
    """A row, after a while."""
    time.sleep(SECONDS)
    return {"case": case, "third": case / 3}


def judge(tables):
    from bcre_studies.comparison.claim import Claim
    from bcre_studies.comparison.verdict import Verdict

    count = f"{len(tables['comparison'])} cases"
    return [Claim("counted", "Every case is there.", Verdict.AGREE, count, "none")]


def draw(tables):
    from bcre_studies.reporting import style

    figure, (axis,) = style.panels(1, 1)
    axis.plot(tables["comparison"]["case"], tables["comparison"]["third"])
    return figure
