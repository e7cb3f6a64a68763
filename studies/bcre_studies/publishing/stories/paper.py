"""What the paper shows, how its rule must be read, and what needs a second layer."""

from __future__ import annotations

import pandas as pd

from bcre_studies.models.registry import AUTOMATON, BCRE
from bcre_studies.publishing.stories.story import Story, Tables
from bcre_studies.publishing.wording import figure_name, listed, number, of, percent, span, span_of
from bcre_studies.scenes.scene import load

DRIFT = 0.001
"""A reading keeps the drift where it is within this part of v."""


def _paper_figures(tables: Tables) -> list[str]:
    rows = tables["comparison"]
    profiles = rows[rows["quantity"].str.startswith("R(x)")]
    judged = profiles[profiles["verdict"] != "unresolved"]
    at_one = judged[judged["d"] == 1.0]
    finest = judged[judged["d"] == judged["d"].min()]
    sentences = [
        "Both models start from the same layers. Their rolling layers are compared by the area "
        "between the two curves, over the area under BCRE’s."
    ]
    if len(at_one):
        sentences.append(
            f"They are {span_of(at_one['difference'])} apart with the paper’s cells and "
            f"{span_of(finest['difference'])} with cells a quarter as long. BCRE with D_eff and "
            f"κ_eff is within {percent(float(at_one['difference_effective'].max()))}."
        )
    late = at_one.groupby("case", sort=False)["t"].max()
    unjudged = [
        figure_name(str(case)) + (f" after t = {number(late[case])}" if case in late else "")
        for case, t in profiles.groupby("case", sort=False)["t"].max().items()
        if case not in late or t > late[case]
    ]
    if unjudged:
        sentences.append(
            f"{listed(unjudged).capitalize()} stays unresolved: on the finest grid tried BCRE’s "
            "own error is not small against the difference."
        )
    return sentences


def _printed_rule(tables: Tables) -> list[str]:
    rows = tables["comparison"].astype({"caption": bool})
    readings = rows.groupby(["step", "sign", "order"])["caption"].all()
    met = [key for key, good in readings.items() if good]
    literal = sum(step == "literal" for step, _, _ in met)
    kept = [key for key in met if _keeps_the_drift(rows, key)]
    sentences = [
        f"The printed rule leaves sign, order and time step open: {len(readings)} readings, each "
        "run on all three figures.",
        f"{len(met)} of them show what every caption says, {literal or 'none'} of these with the "
        "literal d = dt = 1.",
    ]
    if [order for _, _, order in kept] == ["synchronous"]:
        sentences.append("Only the synchronous one among them drifts at the v that is printed.")
    return sentences


def _keeps_the_drift(rows: pd.DataFrame, reading: tuple[str, str, str]) -> bool:
    step, sign, order = reading
    of_reading = of(rows, step=step, sign=sign, order=order)
    printed = [load(str(name)).material.v for name in of_reading["figure"]]
    return bool((of_reading["drift"] / printed - 1).abs().max() < DRIFT)


CONTINUOUS = ("de Gennes 1995 (D = 0)", "BCRE", "Aradian et al.", "Hadeler-Kuttler")


def _one_variable(tables: Tables) -> list[str]:
    rows = tables["comparison"]
    undisturbed = rows[rows["case"].str.endswith("pulse 0")]
    rough = rows[rows["quantity"].str.startswith("RMS")].iloc[0]
    reach = of(rows, quantity="reach uphill").iloc[0]
    stands = bool((undisturbed[[AUTOMATON.column, BCRE.column]] > 0.001).all(axis=None))
    left = number(float(undisturbed["one_variable"].max()))
    return [
        "A pile with one variable, its height, topples wherever it is steeper than Sc.",
        f"Undisturbed, it falls to S − Sc = {left} from every slope tried"
        + (", where both two-layer models stand until they are disturbed." if stands else "."),
        f"It smooths a rough slope to {percent(float(rough['one_variable']))} of its roughness; "
        f"figure 3’s pulse reaches {number(float(reach['one_variable']), 2)} uphill in it, "
        f"{number(float(reach['automaton']), 2)} in the automaton.",
    ]


def _which_model(tables: Tables) -> list[str]:
    rows = tables["comparison"].set_index("model")
    two = [name for name in rows.index if name in CONTINUOUS]
    returns = sum(rows.loc[two, "returns to Sc"] != "no")
    second = sum(rows.loc[two, "second critical slope"] == "yes")
    smooth = sum(rows.loc[two, "smooths"] == "yes")
    sentences = [
        "The same scenes are given to every model that the paper cites, and to the automaton of "
        "each.",
        f"Of {len(two)} continuous models with two layers {returns} return to repose once an "
        f"avalanche has run to the top, {smooth} smooth a rough slope, and {second} have a second "
        "critical slope.",
    ]
    rules = rows[rows.index.str.startswith("automaton")]
    if (rules["smooths"] == "yes").all():
        sentences.append("The automata all smooth, whatever their model does.")
    return sentences


def _quasi_static_limit(tables: Tables) -> list[str]:
    heaps, figures = tables["comparison"], tables["figures"]
    pde = heaps[heaps["model"] == BCRE.name]
    least, most = (pde.loc[pde["error"].astype(float).idxmin()], pde["error"].astype(float).max())
    return [
        "A heap is fed at its top, and its surface is compared with one that never leaves repose "
        "and takes no time to roll.",
        f"BCRE is within {percent(float(least['error']))} of it where ε = "
        f"{number(float(least['eps']))} and τ = {number(float(least['tau']))}, and off by up to "
        f"{percent(most)} on the map.",
        f"The paper’s figures have ε = {span([float(eps) for eps in figures['eps']])}.",
    ]


def _choices(tables: Tables) -> list[str]:
    rows = tables["comparison"]
    verdicts = rows.groupby("verdict on", sort=False)["stands"].agg(
        lambda column: all(column == "yes")
    )
    turned = rows[rows["stands"] == "no"].groupby("choice", sort=False).size()
    sentences = [
        "The paper names v, D and γ only. Length, slopes, pulse, cells and step are our choices; "
        "each is halved and doubled in turn.",
        f"{int(verdicts.sum())} of {len(verdicts)} verdicts stand with every change.",
    ]
    if len(turned):
        most = turned.idxmax()
        sentences.append(f"The choice that turns most verdicts is {most}: {turned[most]} of them.")
    return sentences


STORIES: dict[str, Story] = {
    "paper_figures": Story(
        "Do the paper’s three figures come out alike in both models?",
        ("D_eff = D + (v d/2) (1 - v dt/d)", "κ_eff = gamma d/2"),
        "Static layer of figure 1 and rolling layer of figures 2 and 3 at five times, in the "
        "automaton, in BCRE, and in BCRE with the automaton’s own coefficients.",
        _paper_figures,
    ),
    "printed_rule": Story(
        "How must the printed rule be read?",
        ("R ← R - gamma R (dh - |Sc|) ?", "R ← R + gamma R (S - Sc) ?"),
        "For twelve readings and three figures, whether the caption is met, the run breaks, or it "
        "runs without showing it.",
        _printed_rule,
    ),
    "one_variable": Story(
        "Which of these properties need a second layer at all?",
        ("f = (1/4) max(0, h(i) - h(i + 1) - Sc d)", "h(i) ← h(i) + f(i - 1) - f(i)"),
        "Final slope of the one-variable pile, the two-layer automaton and BCRE, undisturbed and "
        "after a pulse.",
        _one_variable,
    ),
    "which_model": Story(
        "Which model returns to repose, smooths, climbs, and has a second critical slope?",
        (
            "BCRE: ∂R/∂t + ∂/∂x (v R - D ∂R/∂x) = gamma R (S - Sc)",
            "thick flows: v R + gamma R^2/2",
            "Hadeler-Kuttler: v R S/Sc",
        ),
        "Models down, properties across; in each cell what the model does and the number that "
        "decides.",
        _which_model,
    ),
    "quasi_static_limit": Story(
        "When does a scene need no rolling layer at all?",
        ("ε = v/(gamma Sc l)", "τ = Q/(v A)"),
        "Error of the surface without a rolling layer on the map of ε and τ, with the paper’s "
        "figures; slope over ε and sand at rest over τ in both models.",
        _quasi_static_limit,
    ),
    "choices": Story(
        "Do the verdicts depend on what we chose ourselves?",
        ("x → x/2 and x → 2 x",),
        "Verdicts by choices: a disc where halving and doubling leave the verdict, a cross where "
        "one of them turns it.",
        _choices,
    ),
}
