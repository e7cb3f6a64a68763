"""R(x) of the paper's figures: the automaton on three lengths of cells, and BCRE refined for each.

BCRE as it stands does not know of cells, so that one series of grids serves all three.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

from bcre_pde import Measured
from bcre_studies.comparison.compare import Comparison, refine_each
from bcre_studies.comparison.difference import relative_difference
from bcre_studies.comparison.rounding import significant
from bcre_studies.models.effective import effective
from bcre_studies.models.registry import AUTOMATON, SCHEMES
from bcre_studies.models.run import Run
from bcre_studies.scenes.domain import Array
from bcre_studies.scenes.scene import Scene, load
from bcre_studies.sweeps.parallel import each

TOLERANCE = 0.05
WHY = (
    "of the area under R: about the width of a line in the paper's figures, below which "
    "its reader could not tell the two apart"
)
REFINEMENTS = (1, 2, 4)
PROFILE, PICTURE = "R(x)", "R(x), BCRE unresolved"


class Series(NamedTuple):
    """Profiles of one scene at some times, and the grids on which BCRE is solved for them."""

    quantity: str
    scene: str
    times: tuple[float, ...]
    grids: dict[str, int]


SERIES = (
    Series(PROFILE, "figure1", (180.0, 200.0), {"coarsest": 400, "finest": 3200}),
    Series(PICTURE, "figure1", (250.0,), {"coarsest": 100, "finest": 800}),
    Series(PROFILE, "figure2", (20.0,), {"coarsest": 100, "finest": 800}),
    Series(PROFILE, "figure3", (10.0,), {"coarsest": 100, "finest": 800}),
)
"""Figure 1: D/(v + c), over which R decays ahead of its scarp, is one cell of 800."""
EFFECTIVE_GRIDS = {"coarsest": 100, "finest": 800}
Row = dict[str, Any]


def figure_scene(name: str, refinement: int) -> Scene:
    """The scene of one of the paper's figures on cells ``refinement`` times smaller."""
    scene = load(name)
    until, step = (250.0, 0.4) if name == "figure1" else (scene.time.until, 0.2)
    cells = scene.domain.cells * refinement
    return scene.with_changes(cells=cells, until=until, step=step / refinement)


def compared() -> list[Row]:
    """A row for every series, time and length of cell."""
    cases = [(number, n) for number in range(len(SERIES)) for n in (0, *REFINEMENTS)]
    found = dict(zip(cases, each(_solved, cases, "paper_figures"), strict=True))
    return [row for number in range(len(SERIES)) for row in _rows(number, found)]


def _solved(case: tuple[int, int]) -> list[Measured]:
    """R of BCRE at the centres of every automaton's cells; with the coefficients of one, at its."""
    number, refinement = case
    series = SERIES[number]
    scenes = [figure_scene(series.scene, n) for n in ([refinement] if refinement else REFINEMENTS)]
    automata = [AUTOMATON.run(scene, series.times) for scene in scenes]

    def layers(run: Run) -> list[Array]:
        return _layers(run, [own.x for own in automata])

    own = [R for run in automata for R in run.R]
    solved, grids = (
        (effective(scenes[0]), EFFECTIVE_GRIDS) if refinement else (scenes[0], series.grids)
    )
    found = refine_each(solved, series.times, layers, own, [None] * len(own), TOLERANCE, **grids)
    return [replace(measured, solution=None) for measured in found]


def _layers(run: Run, places: list[Array]) -> list[Array]:
    """R at all of the places, each at every time."""
    return [run.sample(x, frame=frame) for x in places for frame in range(run.t.size)]


def _rows(number: int, found: dict[tuple[int, int], list[Measured]]) -> list[Row]:
    """A row for each time and length of cell."""
    series = SERIES[number]
    count = len(series.times)
    rows = []
    for place, refinement in enumerate(REFINEMENTS):
        scene = figure_scene(series.scene, refinement)
        nominal = found[number, 0][place * count : (place + 1) * count]
        layers = AUTOMATON.run(scene, series.times).R
        schemes = [model.run(scene, series.times).R for model in SCHEMES.values()]
        for frame, t in enumerate(series.times):
            with_own = found[number, refinement][frame]
            result = Comparison(layers[frame], nominal[frame], with_own, TOLERANCE)
            row: Row = {"quantity": series.quantity, "case": series.scene, "t": t, "d": scene.d}
            row |= result.row()
            for name, R in zip(SCHEMES, schemes, strict=True):
                gap = relative_difference(R[frame], nominal[frame].value)
                row[column_of(name)] = significant(gap, 3)
            rows.append(row)
    return rows


def column_of(scheme: str) -> str:
    return f"difference_{scheme}" + ("_auto" if scheme == "upwind" else "")
