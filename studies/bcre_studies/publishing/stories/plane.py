"""Sand on a plane: how an avalanche opens, which heaps are round, where the cells spread."""

from __future__ import annotations

from bcre_studies.models.registry import AUTOMATON, BCRE
from bcre_studies.publishing.stories.story import Story, Tables
from bcre_studies.publishing.wording import fixed, of, percent, span, span_of


def _opening_angle(tables: Tables) -> list[str]:
    rows = tables["comparison"]
    angles = of(rows, quantity="theta", case="figure 1")
    own, bcre = (
        span(list(angles[column].astype(float)), 3) for column in (AUTOMATON.column, BCRE.column)
    )
    steepest = fixed(float(angles["S - Sc"].max()), 1)
    layers = of(rows, quantity="edge of a layer")
    short = layers[f"{AUTOMATON.column}_theory"] - layers["at x = 400"]
    pulses = of(rows, quantity="threshold S0 - Sc")
    steeper = pulses[AUTOMATON.column] / pulses["line"] - 1
    sentences = [
        "A trace of rolling sand spreads into a wedge, and at Sd over the whole plane; at figure "
        f"1’s parameters, up to S − Sc = {steepest}, its half-angle θ is {own} degrees in the "
        f"automaton and {bcre} in BCRE.",
    ]
    if (short > 0).all():
        sentences.append(
            "An avalanche that erodes a layer leaves a triangle, whose edge opens slowly: after "
            f"400 cells it is still {span(list(short), 1)} degrees short of θ."
        )
    if (steeper > 0).all():
        sentences.append(
            "A round pulse spreads sideways, so that to bring the top down it needs a slope that "
            f"lies {span_of(steeper)} farther above repose than a ridge as high does."
        )
    return sentences


def _poured_heap(tables: Tables) -> list[str]:
    rows = tables["comparison"]
    heaps = of(rows, quantity="poured heap")
    finest = of(heaps, d=float(heaps["d"].min())).set_index("flow")["difference"].astype(float)
    d8 = of(heaps, flow="d8").sort_values("d")["difference"].astype(float)
    sentences = [
        "Sand falls on level ground, and the heap is held against the round one of BCRE.",
        f"In the smallest cells h is off by {percent(finest['split4'])} where sand is shared out "
        f"among four neighbours, by {percent(finest['facet8'])} on facets, and by "
        f"{percent(finest['d8'])} where all goes to the steepest of eight.",
    ]
    if d8.iloc[0] >= 0.9 * d8.iloc[-1]:
        sentences.append(
            "The last rule, which games use, does not converge: its heaps are octagons in cells "
            "of any size."
        )
    return sentences


def _plane_agreement(tables: Tables) -> list[str]:
    rows = of(tables["comparison"], d=1.0).set_index("case")
    nominal, along, isotropic = (
        float(rows.loc["figure 2", form]) for form in ("nominal", "D_x", "isotropic")
    )
    sentences = [
        "A round pulse rolls down a tilted plane in both models, on the slopes of the figures.",
        f"Figure 2’s is {percent(nominal)} from BCRE as it stands, {percent(along)} with the "
        f"cells’ diffusion added along the flow, and {percent(isotropic)} with it added in all "
        "directions.",
    ]
    if along < isotropic / 5:
        sentences.append("So what the cells add has a direction: that of the flow.")
    return sentences


STORIES: dict[str, Story] = {
    "opening_angle": Story(
        "At which angle does an avalanche open on a plane?",
        (
            "BCRE: tan^2 θ = (D_y/D_x) (S - Sc)/(Sd - S)",
            "automaton: cot θ = max over m of (2/m) asinh(sqrt(q(m) D_x/D_y)/2)",
        ),
        "The triangle that a pulse leaves in an erodible layer; the opening angle over slope in "
        "both models; how far the edge of a layer falls behind it; the slope from which on a "
        "pulse brings the top down, on a line and on a plane.",
        _opening_angle,
    ),
    "poured_heap": Story(
        "Which flow rules keep a heap round?",
        ("∂R/∂t + ∇·(v R n - D ∇R) = E", "n = - ∇h/|∇h|"),
        "Maps of heaps that three flow rules pour, two round and one an octagon, and how their "
        "differences from the round heap of BCRE fall with the cells.",
        _poured_heap,
    ),
    "plane_agreement": Story(
        "In which direction do the cells add diffusion?",
        ("D_x,eff = D + (v d/2) (1 - v dt/d)", "D_y,eff = D"),
        "A round pulse after its way downhill in the automaton, in BCRE and in BCRE with the "
        "cells’ diffusion along the flow, and four differences over the cell length.",
        _plane_agreement,
    ),
}
