"""What accuracy and size cost."""

from __future__ import annotations

from bcre_studies.publishing.stories.story import Story, Tables
from bcre_studies.publishing.wording import number, of, percent, span


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
        f"The most expensive pair needs {percent(float(cost.max()))}.",
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
    "advice": Story(
        "Does the model that bcre advise names reach the tolerance, at the least cost?",
        ("error of R <= 5 / 100",),
        "True against predicted error of the advised models, and their cost against the cheapest.",
        _advice,
    ),
}
