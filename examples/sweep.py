"""A sweep of one parameter: how the automaton nears BCRE as its cells become smaller.

Run it with ``.venv/bin/python examples/sweep.py``. For many parameters and processors see
``bcre sweep``.
"""

import numpy as np
import pandas as pd

from bcre_studies.models.registry import AUTOMATON, BCRE, EFFECTIVE
from bcre_studies.scenes.scene import load

scene = load("figure2")
end = [scene.time.until]

rows = []
for cells in (50, 100, 200):
    coarse = scene.with_changes(cells=cells, step=0.2 * scene.domain.length / cells)
    automaton = AUTOMATON.run(coarse, end)
    x = automaton.x
    R = {model.name: model.run(coarse, end, 400).sample(x) for model in (BCRE, EFFECTIVE)}
    gap = {name: np.abs(automaton.R[-1] - other).mean() / other.mean() for name, other in R.items()}
    rows.append({"d": coarse.d, "from BCRE": gap["pde"], "cells counted": gap["pde effective"]})

table = pd.DataFrame(rows).set_index("d")
table["explained"] = 1 - table["cells counted"] / table["from BCRE"]
print(table.map("{:.1%}".format))
