r"""Do the verdicts stand when what we chose ourselves is halved and doubled?

The paper gives v, D and gamma of its figures. Ours are the length L, the slopes Sc and S0, the
width and the place of the pulse, the number of cells N, and d = dt = 1. Each is halved and doubled
in turn, all else kept:

    L           at the same d; the pulse keeps its part of the way
    Sc          at the same S0 - Sc: tilts the picture
    S0 - Sc     at the same Sc
    width       of the pulse
    place       the pulse's distance from the nearer end
    N           at the same L and dt/d: cells of 2 d and d/2
    d = dt      at the same N: everything in cells stays, and L with it
    scale of h  h, R, S - Sc times a, gamma over a (``rescale``): exact in both models

Every verdict is a word that both models give (``WORDS``). Profiles of R are judged as in
``paper_figures``, at moderate resolution: BCRE on twice and four times the automaton's cells, whose
difference is its error. Figure 1 is judged at gamma (S0 - Sc) t = 5.76, which is t = 180 as it
stands. The table has the word as it stands, those with the change, and whether all are the same; a
dash where a scene has no such choice, or its grid could not hold what is put on it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

import bcre_ca.theory
import bcre_pde.theory
from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.difference import relative_difference
from bcre_studies.comparison.verdict import Verdict, verdict_of
from bcre_studies.comparison.wording import joined, sentences, when
from bcre_studies.models.bcre import SHARE
from bcre_studies.models.effective import effective
from bcre_studies.models.registry import AUTOMATON, BCRE
from bcre_studies.models.run import Run
from bcre_studies.observables.outcome import outcome, slope
from bcre_studies.reporting import style
from bcre_studies.scenes.refusal import SceneError
from bcre_studies.scenes.rescale import rescaled
from bcre_studies.scenes.scene import Scene, load
from bcre_studies.sweeps.parallel import each

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TOLERANCE = 0.05
AT_REPOSE = 0.001
SMOOTHED = 0.95
"""A surface is smoothed once less than this part of its roughness is left."""
GROWTH = 5.76
FACTORS = {"halved": 0.5, "doubled": 2.0}
CHOICES = ("L", "Sc", "S0 - Sc", "width", "place", "N", "d = dt", "scale of h")
NOT_POSED = "-"
PATIENCE = 3000.0
FRAMES = 31

Row = dict[str, Any]


def changed(scene: Scene, choice: str, factor: float) -> Scene | None:
    """The scene with one of :data:`CHOICES` times the factor; None where it has no such choice."""
    Sc, length, cells = scene.material.Sc, scene.domain.length, scene.domain.cells
    excess = _slope(scene) - Sc
    centre, width = (getattr(scene.rolling[0], name, None) for name in ("centre", "width"))
    moved: dict[str, Any] = {} if centre is None else {"rolling.0.centre": factor * centre}
    changes: dict[str, Any] = {}
    match choice:
        case "L":
            changes = moved | {"length": factor * length, "cells": round(factor * cells)}
        case "Sc":
            changes = {"Sc": factor * Sc, "surface.0.slope": factor * Sc + excess}
        case "S0 - Sc" if excess:
            changes = {"surface.0.slope": Sc + factor * excess}
        case "width" if width is not None:
            changes = {"rolling.0.width": factor * width}
        case "place" if centre is not None:
            near_top = centre <= length / 2
            place = factor * centre if near_top else length - factor * (length - centre)
            changes = {"rolling.0.centre": place} if 0 < place < length else {}
        case "N":
            changes = {"cells": round(factor * cells)} | _stepped(scene, 1 / factor)
        case "d = dt":
            changes = moved | {"length": factor * length} | _stepped(scene, factor)
        case "scale of h":
            return rescaled(scene, factor)
    return scene.with_changes(**changes) if changes else None


def _slope(scene: Scene) -> float:
    return float(getattr(scene.surface[0], "slope"))  # noqa: B009 - every scene here has an incline


def _stepped(scene: Scene, factor: float) -> dict[str, Any]:
    """A fixed step times the factor; one that follows its bounds goes on doing so."""
    return {} if scene.time.step == "auto" else {"step": factor * scene.time.step}


def profile_word(scene: Scene, until: float) -> str:
    """The verdict on R(x) of the automaton against BCRE."""
    x, cells = scene.centres(), scene.domain.cells
    own = AUTOMATON.run(scene, [until]).R[-1]

    def sampled(solved: Scene, grid: int) -> Any:
        return BCRE.run(solved, [until], grid).sample(x)

    coarse, fine = (sampled(scene, factor * cells) for factor in (2, 4))
    gap = relative_difference(own, fine)
    left = relative_difference(own, sampled(effective(scene), 2 * cells))
    resolved = relative_difference(coarse, fine) <= SHARE * max(gap, TOLERANCE)
    return str(verdict_of(gap, resolved, left, True, TOLERANCE))


def in_both(scene: Scene, until: float, word: Callable[[Run], str], finer: int = 1) -> str:
    """The word of the automaton and that of BCRE on as many cells, or one where they agree."""
    times = [float(t) for t in np.linspace(0.0, until, FRAMES)]
    words = [
        word(model.run(scene, times, cells))
        for model, cells in ((AUTOMATON, None), (BCRE, finer * scene.domain.cells))
    ]
    return words[0] if words[0] == words[1] else " / ".join(words)


def figure1_profile(scene: Scene) -> str:
    excess = _slope(scene) - scene.material.Sc
    return profile_word(scene, GROWTH / (scene.material.gamma * excess))


def figure2_profile(scene: Scene) -> str:
    return profile_word(scene, 0.5 * scene.domain.length / scene.material.v)


def figure3_profile(scene: Scene) -> str:
    return profile_word(scene, 0.25 * scene.domain.length / scene.material.v)


def figure3_reach(scene: Scene) -> str:
    """Whether any R is left above where the pulse's centre was."""

    def word(run: Run) -> str:
        uphill = run.x < float(run.R[0] @ run.x / run.R[0].sum())
        return "swept downhill" if run.R[-1][uphill].max() < 0.01 * run.R[-1].max() else "stays"

    return in_both(scene, 0.25 * scene.domain.length / scene.material.v, word)


def figure1_top(scene: Scene) -> str:
    """Whether it runs to the top, and whether the slope is at Sc then."""
    Sc, excess = scene.material.Sc, _slope(scene) - scene.material.Sc
    centre = float(getattr(scene.rolling[0], "centre"))  # noqa: B009

    def word(run: Run) -> str:
        came = abs(slope(run.x, run.h[-1]) - Sc) <= AT_REPOSE * abs(excess)
        return f"{outcome(run, centre)}, S = Sc" if came else str(outcome(run, centre))

    return in_both(scene, PATIENCE * scene.domain.length / 100, word)


def small_avalanche(scene: Scene) -> str:
    start = _slope(scene) - scene.material.Sc

    def word(run: Run) -> str:
        end = slope(run.x, run.h[-1]) - scene.material.Sc
        if abs(end) <= AT_REPOSE * start:
            return "returns to Sc"
        return "stays or steepens" if end >= (1 - AT_REPOSE) * start else "between"

    return in_both(scene, PATIENCE * scene.domain.length / 100, word)


def smoothing(scene: Scene) -> str:
    def word(run: Run) -> str:
        return "smoothed" if np.std(run.u[-1]) < SMOOTHED * np.std(run.u[0]) else "kept"

    return in_both(scene, scene.time.until, word, finer=2)


def second_critical_slope(scene: Scene) -> str:
    """By the closed forms of both models, of which the study of Sd shows that they are right."""
    m = scene.material
    own = bcre_ca.theory.second_critical_excess(m.v, m.D, m.gamma, scene.d)
    nominal, left = (
        bcre_pde.theory.second_critical_slope(m.v, D, m.gamma, 0.0)
        for D in (m.D, m.D + m.v * scene.d / 2)
    )
    gaps = relative_difference(own, nominal), relative_difference(own, left)
    return str(verdict_of(gaps[0], True, gaps[1], True, TOLERANCE))


WORDS: dict[str, tuple[Callable[[], Scene], Callable[[Scene], str]]] = {
    "figure 1, R while it climbs": (
        lambda: load("figure1").with_changes(step=0.4),
        figure1_profile,
    ),
    "figure 2, R": (lambda: load("figure2"), figure2_profile),
    "figure 3, R": (lambda: load("figure3"), figure3_profile),
    "figure 3, what lies above the start": (lambda: load("figure3"), figure3_reach),
    "figure 1, run to the top": (lambda: load("figure1"), figure1_top),
    "one small avalanche above repose": (
        lambda: load("figure1").with_changes(**{"surface.0.slope": 0.8, "rolling.0.centre": 15.0}),
        small_avalanche,
    ),
    "roughness of the surface": (lambda: load("rough_slope"), smoothing),
    "second critical slope at figure 1": (lambda: load("figure1"), second_critical_slope),
}
"""Every headline verdict: the scene as it stands, and the word that the models give of it."""


def run() -> dict[str, pd.DataFrame]:
    """One row a verdict and choice."""
    names = list(WORDS)
    cases: list[tuple[str, str, float]] = [(name, "", 1.0) for name in names]
    cases += [(name, c, f) for name in names for c in CHOICES for f in FACTORS.values()]
    words = dict(zip(cases, each(_word, cases, "choices"), strict=True))
    rows = []
    for name in names:
        stands = words[name, "", 1.0]
        for choice in CHOICES:
            found = {word: words[name, choice, factor] for word, factor in FACTORS.items()}
            same = all(word in (stands, NOT_POSED) for word in found.values())
            rows.append({"verdict on": name, "choice": choice, "as it stands": stands, **found})
            rows[-1]["stands"] = "yes" if same else "no"
    return {"comparison": pd.DataFrame(rows)}


def _word(case: tuple[str, str, float]) -> str:
    name, choice, factor = case
    make, word = WORDS[name]
    try:
        scene = changed(make(), choice, factor) if choice else make()
        return NOT_POSED if scene is None else word(scene)
    except SceneError:  # the grid cannot hold what is to be put on it
        return NOT_POSED


def judge(tables: dict[str, pd.DataFrame]) -> list[Claim]:
    """One claim a headline verdict."""
    table = tables["comparison"]
    return [_claim(str(name), rows) for name, rows in table.groupby("verdict on", sort=False)]


def _claim(name: str, rows: pd.DataFrame) -> Claim:
    words = [
        (row["choice"], factor, row[factor]) for _, row in rows.iterrows() for factor in FACTORS
    ]
    posed = [entry for entry in words if entry[2] != NOT_POSED]
    stands = rows["as it stands"].iloc[0]
    turned = [f"{choice} {factor}: {word}" for choice, factor, word in posed if word != stands]
    unresolved = all(word in (stands, str(Verdict.UNRESOLVED)) for _, _, word in posed)
    turns = Verdict.UNRESOLVED if unresolved else Verdict.DISAGREE
    return Claim(
        name=name,
        statement=f"The verdict on {name} stands when each of our choices is halved and doubled.",
        verdict=turns if turned else Verdict.AGREE,
        evidence=sentences(
            f"as it stands: {stands}; the same in {len(posed) - len(turned)} of {len(posed)}",
            when(turned, f"it turns with {joined(turned, '; ')}"),
        ),
        tolerance="the same word",
    )


def draw(tables: dict[str, pd.DataFrame]) -> Figure:
    """Verdicts by choices: a disc where both changes leave the word, a cross where one turns it."""
    table = tables["comparison"]
    names = list(dict.fromkeys(table["verdict on"]))
    figure, (axis,) = style.panels(1, 1)
    figure.set_size_inches(8.2, 4.0)
    looks = {"yes": ("o", "#3b8f5a"), "no": ("X", "#b5480f")}
    for word, (marker, color) in looks.items():
        rows = table[table["stands"] == word]
        x, y = rows["choice"].map(CHOICES.index), rows["verdict on"].map(names.index)
        label = "stands" if word == "yes" else "turns with one of the two"
        axis.plot(x, y, marker, color=color, markersize=9, label=label)
    axis.set_xticks(range(len(CHOICES)), list(CHOICES))
    axis.set_yticks(range(len(names)), names)
    axis.set(xlim=(-0.5, len(CHOICES) - 0.5), ylim=(len(names) - 0.5, -0.5))
    axis.set_title("each of our choices halved and doubled", loc="left")
    figure.legend(loc="outside lower center", ncols=2)
    return figure
