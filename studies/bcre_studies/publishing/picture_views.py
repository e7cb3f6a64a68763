"""The report's pictures with what is said of them: title, caption, alternative."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

import bcre_pde
from bcre_studies.publishing.live_scenes import slope_and_pulse
from bcre_studies.publishing.pictures import space_time
from bcre_studies.publishing.pictures.answer import answer
from bcre_studies.publishing.pictures.phase_diagram import phase_diagram
from bcre_studies.publishing.pictures.shares import shares
from bcre_studies.publishing.wording import number, percent
from bcre_studies.reporting.page.picture import Picture
from bcre_studies.scenes.scene import load

Tables = Mapping[str, pd.DataFrame]


def picture_views(tables: Mapping[str, Tables]) -> list[dict[str, Any]]:
    """The picture of the answer, and the three."""
    profiles = tables["paper_figures"]["comparison"]
    gap = profiles[(profiles["case"] == "figure2") & (profiles["d"] == 1.0)].iloc[0]
    seen = space_time.measure()
    scene = load("figure1")
    slope, pulse = slope_and_pulse(scene)
    paper = pulse.amplitude, slope - scene.material.Sc
    m = scene.material
    Sd = bcre_pde.second_critical_slope(m.v, m.D, m.gamma, m.Sc)
    angle, critical = (math.degrees(math.atan(value)) for value in (slope, Sd))
    return [
        _view(
            "answer",
            "Figure 2’s pulse in both models",
            answer(tables["paper_figures"]["profiles"]),
            "Rolling layer over distance downhill: a pulse at the start, and at the end a high and "
            "narrow one in BCRE, a low and broad one in the automaton, which BCRE with the cells’ "
            "own diffusion covers.",
            "The paper’s figure 2: a pulse of rolling sand, released at the top, a little later. "
            f"Automaton and BCRE are {percent(float(gap['difference']))} apart, automaton and BCRE "
            f"with the cells’ own diffusion {percent(float(gap['difference_effective']))}.",
        ),
        _view(
            "space_time",
            "Figure 1 in space and time",
            space_time.draw(seen),
            "Three maps over distance and time: the rolling layer in the automaton, in BCRE, and "
            "their difference. The avalanche grows at the foot and then climbs; BCRE’s is ahead.",
            "The rolling layer of figure 1. Time runs upwards, and the edge on the left is the "
            "avalanche eating its way uphill. The difference is relative to BCRE’s largest R at "
            "the time: orange where the automaton has more, blue where it has less. "
            + (
                f"From t = {number(seen.resolved_until)} on, hatched, BCRE’s own error on "
                f"{space_time.GRID} cells is no longer small against it."
                if seen.resolved_until < space_time.UNTIL
                else "BCRE is resolved all along."
            ),
            steps=_steps(),
        ),
        _view(
            "phase_diagram",
            "Which pulse brings down which slope",
            phase_diagram(tables["second_critical_angle"]["comparison"], paper),
            "Amplitude of a pulse against slope, with the slope from which on the pulse climbs to "
            "the top: lowest in the automaton with d = 1, higher with d = 1/4, highest in BCRE.",
            "A pulse at the foot of a slope, figure 1’s material. Above a line it climbs to the "
            "top and the whole slope comes down to repose. To the left, where pulses vanish, the "
            "lines end at Sd. The star is figure 1 with the slope that we chose, "
            f"{angle:.0f} degrees. Sand is not so steep, but the paper’s coefficients put BCRE’s "
            f"Sd at {critical:.0f} degrees.",
        ),
        _view(
            "shares",
            "How much of the difference cell size explains",
            shares(tables["modified_equation"]["comparison"]),
            "For seven scenes and three cell lengths the difference of the rolling layer from "
            "BCRE, and what is left of it once the cells’ diffusion and curvature are counted.",
            "Squares: automaton from BCRE as it stands. Triangles: from BCRE with D_eff and κ_eff. "
            "Both fall with the cell length d.",
        ),
    ]


def _view(
    name: str,
    title: str,
    figure: Figure,
    alt: str,
    caption: str,
    steps: Sequence[Mapping[str, str]] = (),
) -> dict[str, Any]:
    return {
        "name": name,
        "title": title,
        "picture": Picture(figure, name),
        "alt": alt,
        "caption": caption,
        "steps": steps,
    }


def _steps() -> list[dict[str, str]]:
    """The colours of the rolling layer, by their lower ends."""
    levels = space_time.R_LEVELS[:-1]
    return [
        {"colour": f"var(--r{place})", "label": f"R > {level:g}"}
        for place, level in enumerate(levels, start=1)
    ]
