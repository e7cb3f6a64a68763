"""What the cells add, and whether both models are computed right."""

from __future__ import annotations

from bcre_studies.models.registry import AUTOMATON, BCRE
from bcre_studies.publishing.stories.story import Story, Tables
from bcre_studies.publishing.wording import fixed, number, numeric, of, percent, span, span_of


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
        "Slopes that rise, dry cells, single cells, ten million steps: each runs in every scheme "
        "of the automaton and in BCRE.",
        f"Of {len(rows)} runs {int(ended.sum())} come to their end, {int(refused.sum())} are "
        f"refused before the start and {int((~ended & ~refused).sum())} stop on the way, saying "
        "where and why.",
        f"R falls below zero in {int((negative & (rows['model'] == AUTOMATON.name)).sum())} runs "
        f"of the automaton and {int((negative & (rows['model'] == BCRE.name)).sum())} of BCRE.",
    ]


STORIES: dict[str, Story] = {
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
    "order_of_accuracy": Story(
        "Do both models converge to exact solutions, and how fast?",
        ("e(d) = mean |R - R_exact|", "order = slope of -ln e over ln N"),
        "Error over cells for every exact solution, with the slopes of the formal orders.",
        _orders,
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
}
