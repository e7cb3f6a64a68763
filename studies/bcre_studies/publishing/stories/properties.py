"""The properties that the paper claims, one at a time."""

from __future__ import annotations

from bcre_studies.models.registry import AUTOMATON, BCRE
from bcre_studies.publishing.stories.story import Story, Tables
from bcre_studies.publishing.wording import fixed, number, of, percent, span_of


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
        f"The same slope gets {int(rows['seeds'].iloc[0])} random surfaces, one for each seed.",
        f"In the mean {percent(rows.loc['automaton', 'mean'])} of the roughness is left in the "
        f"automaton, {percent(rows.loc[BCRE.column, 'mean'])} in BCRE, "
        f"{percent(rows.loc['pde_effective', 'mean'])} in BCRE with D_eff and κ_eff.",
        f"The 95 % intervals over seeds are {number(rows.loc['automaton', 'low'], 4)} to "
        f"{number(rows.loc['automaton', 'high'], 4)} and "
        f"{number(rows.loc[BCRE.column, 'low'], 4)} to "
        f"{number(rows.loc[BCRE.column, 'high'], 4)}: the difference is "
        + ("larger than that between seeds." if apart else "no larger than that between seeds."),
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
        f"A pulse of {number(float(large['pulse']))} brings the slope down where S0 − Sc exceeds "
        f"{fixed(float(large['automaton']))} in the automaton and "
        f"{fixed(float(large[BCRE.column]))} in BCRE; a vanishing pulse needs "
        f"{fixed(float(small['automaton']))} and {fixed(float(small[BCRE.column]))}.",
    ]


def _avalanche_extent(tables: Tables) -> list[str]:
    rows = tables["comparison"].set_index(["case", "quantity"])
    left, even = rows.loc[("figure1", "left")], rows.loc[("figure1", "even")]
    rolls, far, wide = (rows.loc[("figure2", q)] for q in ("rolling", "travelled", "spread"))
    both = [AUTOMATON.column, BCRE.column]
    wedge = abs(left[AUTOMATON.column] - left["expected"]) <= 0.01 and (even[both] <= 0.01).all()
    sentences = [
        f"After figure 1’s avalanche {percent(float(left[AUTOMATON.column]))} of the static layer "
        f"is left in the automaton and {percent(float(left[BCRE.column]))} in BCRE"
        + (": the wedge at repose." if wedge else "."),
        f"Figure 2’s pulse travels {number(float(far[AUTOMATON.column]), 2)} and widens by "
        f"{number(float(wide[AUTOMATON.column]), 2)} in the automaton, by "
        f"{number(float(wide[BCRE.column]), 2)} in BCRE.",
    ]
    if (rolls[both] <= 1).all():
        sentences.append("It only loses sand, since it runs on a slope below repose.")
    return sentences


STORIES: dict[str, Story] = {
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
        "Does the decay of roughness depend on the random surface?",
        ("RMS u(t) over RMS u(0)",),
        "Roughness left after the run, one mark a seed, for the three models.",
        _random_roughness,
    ),
    "uphill_propagation": Story(
        "How do avalanches move uphill, and as fast in both models?",
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
    "avalanche_extent": Story(
        "What does an avalanche move, and how far?",
        ("left: Sc/S0 + (1 - Sc/S0) d/L", "spread: sqrt(w^2/2 + 2 D t) - w/sqrt(2)"),
        "Static layer of figure 1 and rolling layer of figure 2, at the start and at the end, in "
        "the three models.",
        _avalanche_extent,
    ),
}
