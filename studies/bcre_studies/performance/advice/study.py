r"""Does what ``bcre advise`` advises reach the tolerance, and is it the cheapest that does?

The advice rests on pilots (``pilot``) and costs; here it is put to the test at a
tolerance of 5 % against BCRE, refined until its own error is a twentieth of that: in R, relative L1
at the end, and in h, L1 of its change relative to that.

* **Random scenes** (``random_scenes``): the advised model is run on the advised
  cells. A scene whose BCRE does not come that far on 1600 cells is unresolved and counted apart;
  one that does, but for which nothing was advised, is declined and counts as not met.
* **Extrapolated**: on the same scenes the automaton's pilots end at 100 cells, and every scheme
  that is predicted to meet the tolerance on finer ones is run there.
* **Built-in scenes and one more**: every model is run on finer and finer grids until it meets the
  tolerance and stays there, and the cheapest of them is compared with what was advised.

Costs are those of the committed record of speed, so that the same is advised everywhere.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from bcre_studies.models.registry import CANDIDATES
from bcre_studies.performance.advice import claims
from bcre_studies.performance.advice.cheapest import OWN, compared
from bcre_studies.performance.advice.drawn import FEW, random_rows
from bcre_studies.performance.advice.truth import TOLERANCE
from bcre_studies.reporting import style
from bcre_studies.scenes.listing import studied_names
from bcre_studies.sweeps.parallel import each

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from bcre_studies.comparison.claim import Claim

SCENES = 60

Tables = dict[str, pd.DataFrame]


def run() -> Tables:
    """Random scenes, the same extrapolated, and what was really the cheapest."""
    both = each(random_rows, range(SCENES), "advice, random scenes")
    named = each(compared, [*studied_names(), OWN], "advice, all models")
    return {
        "comparison": pd.DataFrame([row for rows, _ in both for row in rows]),
        "extrapolated": pd.DataFrame([row for _, rows in both for row in rows]),
        "cheapest": pd.DataFrame([row for rows in named for row in rows]),
    }


def judge(tables: Tables) -> list[Claim]:
    """Whether what is advised, extrapolated and cheapest is so."""
    return claims.judge(tables)


def draw(tables: Tables) -> Figure:
    """True error against the predicted one: as advised, and extrapolated from coarse pilots."""
    figure, axes = style.panels(1, 2)
    random, extrapolated = tables["comparison"], tables["extrapolated"]
    for axis, table, title in (
        (axes[0], random[random["result"] != "unresolved"], "advised"),
        (axes[1], extrapolated, f"predicted from pilots of at most {FEW} cells"),
    ):
        ends = np.array([1e-5, 0.3])
        axis.loglog(ends, ends, color="0.55", linewidth=1.0)
        axis.axhline(TOLERANCE, color="0.55", linestyle=":", linewidth=1.0)
        for name, model in CANDIDATES.items():
            rows = table[table["model"] == name]
            if len(rows):
                look = model.markers(label=name)
                axis.loglog(rows["predicted_error"], rows["true_error"], **look)
        axis.set_title(title, loc="left")
        axis.set_xlabel("predicted error")
        axis.set_ylabel("true error")
        axis.legend()
    axes[1].set_xlim(0.005, 0.3)
    axes[1].set_ylim(0.005, 0.3)
    return figure
