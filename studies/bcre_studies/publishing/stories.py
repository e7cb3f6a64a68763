"""Every study in short: its question, its equation, and three sentences that hang on its tables.

A study without an entry here is told by its docstring and its claims.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import pandas as pd

from bcre_studies.models.registry import AUTOMATON, BCRE
from bcre_studies.publishing.wording import (
    PERCENT,
    figure_name,
    fixed,
    listed,
    number,
    numeric,
    of,
    percent,
    span,
)

Tables = dict[str, pd.DataFrame]


@dataclass(frozen=True)
class Story:
    """What the page says of a study besides its claims.

    Parameters
    ----------
    question: one sentence that ends in a question mark.
    equations: in the text form of :mod:`bcre_studies.reporting.page.mathml`.
    picture: what its figure shows, for whoever does not see it.
    tell: the sentences, from the study's tables.
    """

    question: str
    equations: tuple[str, ...]
    picture: str
    tell: Callable[[Tables], Sequence[str]] = field(default=lambda tables: ())


def _paper_figures(tables: Tables) -> list[str]:
    rows = tables["comparison"]
    profiles = rows[rows["quantity"].str.startswith("R(x)")]
    judged = profiles[profiles["verdict"] != "unresolved"]
    at_one = judged[judged["d"] == 1.0]
    finest = judged[judged["d"] == judged["d"].min()]
    sentences = [
        "Both models start from the same sand; the rolling layer is compared at the end, by the "
        "area between the two curves over the area under BCRE’s."
    ]
    if len(at_one):
        sentences.append(
            f"With the paper’s cells they are {span_of(at_one['difference'])} apart, with cells a "
            f"quarter as long {span_of(finest['difference'])}; given D_eff and κ_eff, BCRE is "
            f"within {percent(float(at_one['difference_effective'].max()))}."
        )
    unjudged = sorted(set(profiles["case"]) - set(judged["case"]))
    if unjudged:
        names = listed([figure_name(name) for name in unjudged]).capitalize()
        sentences.append(
            f"{names} stays unresolved: on the finest grid tried BCRE’s own error is not small "
            "against the difference."
        )
    return sentences


def span_of(values: pd.Series) -> str:
    """``39 % to 53 %`` of a column of shares."""
    low, high = percent(float(values.min())), percent(float(values.max()))
    return low if low == high else f"{low.removesuffix(PERCENT)} to {high}"


def _repose_return(tables: Tables) -> list[str]:
    rows = of(tables["comparison"], quantity="final S - Sc", pulses=1)
    rows = rows[rows["case"] != "repeated"]
    start, end = rows["S0 - Sc"].astype(float), rows["automaton"].astype(float)
    above, below = start > 0, start < 0
    down = above & (end.abs() <= 0.001)
    sentences = [
        "A pulse is released near the top; when it has left, a line through the middle half of "
        "the slope gives the final S.",
        f"Of {int(above.sum())} slopes above repose {int(down.sum())} came down to S = Sc and "
        f"{int((above & (end < -0.001)).sum())} below it; of {int(below.sum())} below repose "
        f"{int((below & (end <= 0)).sum())} stayed there, the pulse laid down on its way.",
    ]
    repeated = of(tables["comparison"], case="repeated")
    if len(repeated):
        last = repeated[repeated["pulses"] == repeated["pulses"].max()]
        last = last[last["S0 - Sc"] > 0]
        if len(last) and bool((last["automaton"].astype(float).abs() <= 0.001).all()):
            sentences.append(
                f"After {int(last['pulses'].iloc[0])} pulses, one after another, slopes that one "
                "pulse left standing are at repose too."
            )
    return sentences


def _roughness_decay(tables: Tables) -> list[str]:
    rows = tables["comparison"]
    decay = of(rows, quantity="decay rate of u", d=1.0)
    at = decay.iloc[(decay["k"] - 0.5).abs().argmin()]
    rough = tables["rough_slope"]
    left = {
        model: float(group["RMS"].iloc[-1] / group["RMS"].iloc[0])
        for model, group in rough.groupby("model")
    }
    return [
        "Waves of one length are laid on the surface, or on the rolling layer, and followed.",
        f"Waves of the surface decay in the automaton, at k = {at['k']:.2g} by "
        f"{number(float(at['automaton']), 2)} per time; in BCRE with κ = 0 by "
        f"{number(float(at[BCRE.column]), 1)} ± {number(float(at['pde_error']), 1)}.",
        "A rough slope under a steady layer keeps "
        f"{percent(left[AUTOMATON.name])} of its roughness in the automaton and "
        f"{percent(left[BCRE.name])} in BCRE.",
    ]


def _random_roughness(tables: Tables) -> list[str]:
    rows = tables["comparison"].set_index("model")
    apart = rows.loc["automaton", "high"] < rows.loc[BCRE.column, "low"]
    return [
        f"The same slope with {int(rows['seeds'].iloc[0])} random surfaces, one a seed.",
        f"In the mean {percent(rows.loc['automaton', 'mean'])} of the roughness is left in the "
        f"automaton, {percent(rows.loc[BCRE.column, 'mean'])} in BCRE, "
        f"{percent(rows.loc['pde_effective', 'mean'])} in BCRE with D_eff and κ_eff.",
        f"The 95 % intervals over seeds are {number(rows.loc['automaton', 'low'], 4)} to "
        f"{number(rows.loc['automaton', 'high'], 4)} and "
        f"{number(rows.loc[BCRE.column, 'low'], 4)} to "
        f"{number(rows.loc[BCRE.column, 'high'], 4)}: the difference is "
        + ("no matter of the seed." if apart else "not larger than that between seeds."),
    ]


def _uphill(tables: Tables) -> list[str]:
    rows = tables["comparison"]
    front = of(rows, quantity="front speed V", d=1.0)
    wave = of(rows, quantity="surface wave speed", d=1.0)
    opposite = front[(front["automaton"] > 0) & (front[BCRE.column] < 0)]
    sentences = [
        "Four mechanisms are measured apart: the front of the rolling layer, waves of the surface, "
        "the scarp, and how far figure 3’s pulse reaches.",
        f"Waves of the surface climb at γR in both models, within "
        f"{percent(float(wave['difference'].max()))}.",
    ]
    if len(opposite):
        row = opposite.iloc[0]
        sentences.append(
            f"The rolling layer climbs only above Sd: at S − Sc = {number(row['value'])} that of "
            f"the automaton climbs at {number(row['automaton'], 2)} while BCRE’s is swept down at "
            f"{number(abs(row[BCRE.column]), 2)}."
        )
    return sentences


def _critical(tables: Tables) -> list[str]:
    rows = tables["comparison"]
    sd = of(rows, quantity="Sd - Sc")
    thresholds = of(rows, quantity="threshold S0 - Sc").sort_values("pulse")
    first, small, large = sd.iloc[0], thresholds.iloc[0], thresholds.iloc[-1]
    own, bcre = float(first["automaton"]), float(first[BCRE.column])
    return [
        "Growth at a fixed place, from a layer too thin to change the slope, gives Sd; runs with "
        "finite pulses show from which slope on the avalanche climbs to the top.",
        f"At figure 1’s parameters Sd − Sc is {fixed(own)} in the automaton and {fixed(bcre)} in "
        f"BCRE; over all parameters it is {span_of(sd['difference'])} lower in the automaton.",
        f"With a pulse of {number(float(large['pulse']))} the slope comes down from "
        f"{fixed(float(large['automaton']))} on in the automaton and from "
        f"{fixed(float(large[BCRE.column]))} on in BCRE, against "
        f"{fixed(float(small['automaton']))} and {fixed(float(small[BCRE.column]))} for a "
        "vanishing one.",
    ]


def _modified_equation(tables: Tables) -> list[str]:
    rows = of(tables["comparison"], split="space")
    judged = rows[rows["verdict"] != "unresolved"]
    worst = judged.loc[judged["explained"].idxmin()]
    rest = judged[judged["scene"] != worst["scene"]]
    return [
        "Every scene runs on cells of d, d/2 and d/4 and is compared with BCRE as it stands, with "
        "D_eff, with κ_eff and with both.",
        f"Both together explain {span_of(rest['explained'])} of every resolved difference but that "
        f"of {worst['scene'].replace('_', ' ')}, of which they explain "
        f"{percent(float(worst['explained']))}.",
        f"The most that is left is {percent(float(judged['both'].max()))} of R.",
    ]


def _printed_rule(tables: Tables) -> list[str]:
    rows = tables["comparison"].astype({"caption": bool})
    readings = rows.groupby(["step", "sign", "order"])["caption"].all()
    met = [key for key, good in readings.items() if good]
    literal = rows[rows["step"] == "literal"].groupby(["sign", "order"])["caption"].all()
    drift = rows[(rows["order"] == "synchronous") & rows["caption"]]
    return [
        f"The printed rule leaves sign, order and time step open: {len(readings)} readings, each "
        "run on all three figures.",
        f"{len(met)} of them show what every caption says; of those with the literal d = dt = 1 it "
        f"is {int(literal.sum()) or 'none'}.",
        "Of these the synchronous one alone keeps the drift v that the paper gives."
        if len(drift)
        else "None of these reads every cell from the old state.",
    ]


def _one_variable(tables: Tables) -> list[str]:
    rows = tables["comparison"]
    undisturbed = rows[rows["case"].str.endswith("pulse 0")]
    rough = rows[rows["quantity"].str.startswith("RMS")].iloc[0]
    reach = of(rows, quantity="reach uphill").iloc[0]
    stands = bool((undisturbed["automaton"] > 0.001).all())
    left = number(float(undisturbed["one_variable"].max()))
    return [
        "A pile with one variable, its height, topples wherever it is steeper than Sc.",
        f"Undisturbed, it falls to S − Sc = {left} from every slope tried"
        + (", where both two-layer models stand until they are disturbed." if stands else "."),
        f"It smooths a rough slope to {percent(float(rough['one_variable']))} of its roughness; "
        f"figure 3’s pulse reaches {number(float(reach['one_variable']), 2)} uphill in it, "
        f"{number(float(reach['automaton']), 2)} in the automaton.",
    ]


def _orders(tables: Tables) -> list[str]:
    rows = tables["comparison"]
    upwind = rows[(rows["model"] == AUTOMATON.name) & rows["scheme"].str.match(r"\d")]
    pde = rows[rows["model"] == BCRE.name]
    past = tables.get("past_breaking")
    sentences = [
        f"Both models run {rows['solution'].nunique()} exact solutions on five grids each; the "
        "order is the slope of error against cells.",
        f"The paper’s rule converges at order {span([round(v, 2) for v in upwind['order_L1']])}, "
        f"BCRE at {span([round(v, 1) for v in pde['order_L1']])} (median "
        f"{fixed(float(pde['order_L1'].median()), 1)}).",
    ]
    if past is not None:
        sentences.append(
            "Where the exact wave has broken there is no smooth solution, and the order of both "
            f"falls to {span([round(v, 1) for v in past['order']])}."
        )
    return sentences


def _speed_error(tables: Tables) -> list[str]:
    fewest = tables["comparison"].set_index(["scene", "contender"])
    papers = fewest.xs("automaton, upwind", level="contender")["cell-steps to 1 %"]
    missed = int((papers == "not reached").sum())
    reach = tables.get("recorded_reach")
    sentences = [
        "Every scene is run on finer and finer grids in each model; the error of R is set against "
        "the work and the time that it takes.",
        f"The paper’s rule reaches 1 % in {len(papers) - missed} of {len(papers)} scenes on the "
        "grids tried.",
    ]
    if reach is not None:
        winners = reach[reach["winner"].astype(bool)]
        ours = int(winners["contender"].str.startswith("automaton").sum())
        sentences.append(
            f"Over {len(winners)} pairs of scene and error some form of the automaton is the "
            f"fastest of all in {ours}."
        )
    return sentences


def _scaling(tables: Tables) -> list[str]:
    sizes, budget = of(tables["sizes"], model="upwind"), tables["budget"]
    own = of(budget, model="automaton, upwind")
    bcre = budget[budget["model"].str.startswith("PDE")]
    return [
        "The record names its machine; rates are those with sand rolling on every cell, one core.",
        f"The compiled rule steps {span([v / 1e9 for v in sizes['cell_steps_per_s']])} billion "
        f"cells a second, for piles of {number(float(sizes['cells'].min()))} to "
        f"{number(float(sizes['cells'].max()))} cells.",
        f"At 60 frames a second the paper’s figures run on {span(list(own['cells']))} cells in the "
        f"automaton and on {span(list(bcre['cells']))} in BCRE.",
    ]


def _scene_needs(tables: Tables) -> list[str]:
    rows = tables["comparison"]
    cost = rows["cost_5"].astype(float)
    return [
        "Each part of the model is left out in turn; a part is needed where what a person asks of "
        "the scene changes by more than 1 % or 5 %.",
        f"Over {len(rows)} pairs of scene and question the cheapest model that stays within 5 % "
        f"costs {percent(float(cost.median()))} of the full one in the median.",
        f"The dearest needs {percent(float(cost.max()))}.",
    ]


def _stability(tables: Tables) -> list[str]:
    rows = tables["comparison"]
    own = rows[(rows["model"] == AUTOMATON.name) & ~rows["variant"].str.startswith("limited")]
    return [
        "Noise on a small periodic pile is stepped; a step is unstable where the noise grows.",
        f"For the automaton’s own rules the measured boundary lies within "
        f"{number(float(own['distance_percent'].max()), 2)} % of the predicted one, and "
        f"{int(own['predicted_stable_but_grows'].sum())} of {int(own['points'].sum())} points "
        "predicted stable grow.",
        f"Of the steps that a model’s own bound lets pass, in either model, "
        f"{int(rows['accepted_but_grows'].sum())} are unstable.",
    ]


def _hard_cases(tables: Tables) -> list[str]:
    rows = tables["comparison"]
    ended = rows["verdict"].str.startswith("survives")
    refused = rows["verdict"].str.startswith("refused")
    negative = numeric(rows["smallest_R"]) < 0
    return [
        "Slopes that rise, dry cells, single cells, ten million steps: each in every scheme of the "
        "automaton and in BCRE.",
        f"Of {len(rows)} runs {int(ended.sum())} come to their end, {int(refused.sum())} are "
        f"refused before the start and {int((~ended & ~refused).sum())} stop on the way, saying "
        "where and why.",
        f"R falls below zero in {int((negative & (rows['model'] == AUTOMATON.name)).sum())} runs "
        f"of the automaton and {int((negative & (rows['model'] == BCRE.name)).sum())} of BCRE.",
    ]


def _advice(tables: Tables) -> list[str]:
    rows = tables["comparison"]
    judged = rows[rows["result"].isin(["met", "missed", "declined"])]
    met = int((judged["result"] == "met").sum())
    return [
        "For random scenes the command names a model and its cells; the advice is "
        "then run and held against BCRE.",
        f"The tolerance of 5 % was met in {met} of {len(judged)} cases.",
        f"The largest true error is {percent(float(judged['true_error'].max()))}.",
    ]


STORIES: dict[str, Story] = {
    "paper_figures": Story(
        "Do the paper’s three figures come out alike in both models?",
        ("D_eff = D + (v d/2) (1 - v dt/d)", "κ_eff = gamma d/2"),
        "Static layer of figure 1 and rolling layer of figures 2 and 3 at five times, in the "
        "automaton, in BCRE, and in BCRE with the automaton’s own coefficients.",
        _paper_figures,
    ),
    "repose_return": Story(
        "Does a slope that is disturbed return to below the angle of repose?",
        ("S = - ∂h/∂x", "compared: S - Sc"),
        "Final against initial slope, its change by thin pulses beside the closed form, and the "
        "slope after repeated pulses.",
        _repose_return,
    ),
    "roughness_decay": Story(
        "Does roughness decay, and by which term of the model?",
        (
            "BCRE: ∂u/∂t = gamma R0 ∂u/∂x",
            "automaton: ∂u/∂t = gamma R0 ∂u/∂x + (gamma d/2) R0 ∂^2 u/∂x^2",
        ),
        "Decay rate and climbing speed of waves of the surface and decay rate of waves of the "
        "rolling layer over wavenumber, and the roughness of a slope over time.",
        _roughness_decay,
    ),
    "random_roughness": Story(
        "Is the decay of roughness a matter of the seed?",
        ("RMS u(t) over RMS u(0)",),
        "Roughness left after the run, one mark a seed, for the three models.",
        _random_roughness,
    ),
    "uphill_propagation": Story(
        "How do avalanches get uphill, and as fast in both models?",
        ("front: V = 2 sqrt(D sigma) - v", "surface wave: gamma R", "scarp: c = gamma H - v"),
        "Speed of the rolling front over slope, of the surface wave over γR, of the scarp over "
        "its height, and the reach of figure 3’s pulse.",
        _uphill,
    ),
    "second_critical_angle": Story(
        "Above which slope does any disturbance bring the pile down?",
        (
            "BCRE: gamma (Sd - Sc) = v^2/(4 D)",
            "automaton: gamma (Sd - Sc) = (sqrt(v/d + D/d^2) - sqrt(D/d^2))^2",
        ),
        "Sd over the cell Peclet number, measured and in closed form; what became of each pulse; "
        "and the slope from which on a pulse climbs, over its amplitude.",
        _critical,
    ),
    "modified_equation": Story(
        "How much of every difference is the automaton’s own diffusion?",
        (
            "D_eff = D + (v d/2) (1 - v dt/d)",
            "κ_eff = κ + (gamma d/2) (1 - gamma R0 dt/d)",
        ),
        "Difference of R over cell length for every scene: as it stands, with one coefficient, "
        "with both.",
        _modified_equation,
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
    "order_of_accuracy": Story(
        "Do both models converge to exact solutions, and how fast?",
        ("e(d) = mean |R - R_exact|", "order = slope of -ln e over ln N"),
        "Error over cells for every exact solution, with the slopes of the formal orders.",
        _orders,
    ),
    "speed_error": Story(
        "What does accuracy cost in each model?",
        ("error of R = mean |R - R_true| / mean R_true",),
        "Error of R over cell-steps and over seconds, one column a scene, for the automaton’s "
        "schemes, BCRE’s solver and what one would pick instead.",
        _speed_error,
    ),
    "scaling": Story(
        "How large a pile runs, and how large at 60 frames a second?",
        ("rate = cells * steps / time",),
        "Cell-steps per second over cells with the two limits of the machine, and the cells that "
        "keep 60 frames a second.",
        _scaling,
    ),
    "scene_needs": Story(
        "Which parts of the model does a scene need?",
        ("change = |q - q_full| / scale",),
        "For every scene a map of which ingredient changes which observable.",
        _scene_needs,
    ),
    "stability": Story(
        "From which step on does each method become unstable?",
        ("|G(k)| <= 1 for all k",),
        "For every rule and method the plane of step numbers: stable points shaded, the predicted "
        "boundary and the model’s own bound as lines.",
        _stability,
    ),
    "hard_cases": Story(
        "What happens in scenes that no model was made for?",
        ("mass: sum(h + R) d + outflow = constant",),
        "End of every hard scene in every model, and how figure 1’s scarp depends on the grid.",
        _hard_cases,
    ),
    "advice": Story(
        "Does the model that bcre advise names reach the tolerance, at the least cost?",
        ("error of R <= 5 / 100",),
        "True against predicted error of the advised models, and their cost against the cheapest.",
        _advice,
    ),
}


def story_of(name: str, docstring: str) -> Story:
    """The story of a study; without an entry, its title line as the question."""
    lines = docstring.strip().splitlines() or [name]
    return STORIES.get(name) or Story(lines[0].rstrip("."), (), lines[0])
