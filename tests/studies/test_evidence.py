"""A verdict that turns takes with it every sentence that was true of the other.

Each study judges its committed tables, and then the same tables changed so that a verdict, or a
fact, turns; what it says must turn too.
"""

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import pandas as pd
import pytest

from bcre_studies.catalog import STUDIES, study
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.system.files import ROOT

AGREE, EXPLAINED, UNRESOLVED, DISAGREE = Verdict


def cell(text):
    try:
        return float(text)
    except ValueError:
        return {"True": True, "False": False}.get(text, text)


def column(texts):
    """Numbers and truth values where the texts are such, and no number where they are empty."""
    values = [cell(text) for text in texts]
    if any(texts) and all(text == "" or isinstance(cell(text), float) for text in texts):
        return pd.Series([float("nan") if text == "" else cell(text) for text in texts])
    return pd.Series(values)


@cache
def committed(name):
    """The committed tables of a study, as it judges them."""
    tables = {}
    for path in (ROOT / "reports" / name).glob("*.csv"):
        raw = pd.read_csv(path, dtype=str, keep_default_na=False)
        if path.stem in ("points",):
            continue
        tables[path.stem] = pd.DataFrame({head: column(list(raw[head])) for head in raw})
    return tables


class Turn(NamedTuple):
    """What is changed in a table of a study, and what becomes of a claim and its evidence.

    ``where`` selects rows, ``change`` gives new values for columns, both of the rows' table.
    """

    study: str
    claim: str
    verdict: Verdict
    where: Callable[[pd.DataFrame], pd.Series]
    change: dict
    gone: tuple[str, ...] = ()
    said: tuple[str, ...] = ()
    table: str = "comparison"


def of(**values):
    """Rows whose columns have these values, ``__`` standing for a blank in a column's name."""

    def where(table):
        chosen = pd.Series(True, index=table.index)
        for name, value in values.items():
            head = name.replace("__", " ")
            chosen &= table[head].isin(value) if isinstance(value, list) else table[head] == value
        return chosen

    return where


def all_rows(table):
    return pd.Series(True, index=table.index)


def close(table):
    return (table["S0 - Sc"] > 0) & (table["S0 - Sc"] <= 0.3) & (table["case"] != "repeated")


def below(table):
    return (table["S0 - Sc"] <= 0) & (table["case"] != "repeated")


def steep(table):
    return (table["S0 - Sc"] > 0.3) & (table["case"] != "repeated")


def same_as_automaton(*columns):
    return dict.fromkeys(columns, lambda rows: rows["automaton"])


TURNS = [
    Turn(
        "agreement_map",
        "slope at which a pulse runs to the top",
        AGREE,
        of(quantity="s at which it runs to the top"),
        {"difference": 0.01},
        said=("differ by 1% to 1%",),
    ),
    Turn(
        "avalanche_statistics",
        "oscillation between two slopes",
        AGREE,
        all_rows,
        {"start": 1.76, "gap": 32.5, "size": 0.765, "start_band": 0.0, "gap_band": 0.0},
    ),
    Turn(
        "opening_angle",
        "opening angle, figure 1",
        AGREE,
        all_rows,
        {"verdict": "agree"},
    ),
    Turn(
        "plane_agreement", "figure 2 on a plane", AGREE, of(case="figure 2"), {"verdict": "agree"}
    ),
    Turn(
        "poured_heap",
        "poured heap, d8",
        AGREE,
        of(quantity="poured heap", flow="d8"),
        {"difference": lambda rows: 0.01 * rows["d"]},
        gone=("octagons",),
    ),
    Turn(
        "sensitivity",
        "time step",
        DISAGREE,
        of(parameter="dt"),
        {"total_order_low": 0.2, "total_order": 0.3, "total_order_high": 0.4},
        said=("0.30 (0.20 to 0.40)",),
    ),
    Turn(
        "error_estimate",
        "coverage past t*",
        DISAGREE,
        of(regime="past t*", quantity="R", rule="two triples and more"),
        {"covered": 0.9},
        said=("R: 90.0%",),
    ),
    Turn(
        "paper_figures",
        "calibrated scheme",
        AGREE,
        of(quantity="R(x)"),
        {"difference_calibrated": 0.001},
        gone=("where it is farther",),
        said=("nearer in 12 of 12",),
    ),
    Turn(
        "paper_figures",
        "figure1 climb, effective",
        AGREE,
        of(case="figure1", quantity="time from 10 % to 90 % of the climb"),
        {"difference_effective": 0.03, "difference_effective_error": 0.001},
        said=("relative difference 0.03",),
    ),
    Turn(
        "repose_return",
        "first property as printed",
        AGREE,
        close,
        {"automaton": 0.0, "pde": 0.0},
        gone=("none returned", "and none in BCRE"),
        said=("13 returned in the automaton and 13 in BCRE",),
    ),
    Turn(
        "repose_return",
        "first property as printed",
        DISAGREE,
        below,
        {"automaton": 0.1},
        gone=("nothing to return from",),
        said=("end at S - Sc = 0.1 at most",),
    ),
    Turn(
        "repose_return",
        "first property as printed",
        DISAGREE,
        steep,
        {"pde": 0.7},
        gone=("teeper slopes come to S = Sc",),
    ),
    Turn("repose_return", "all or nothing", DISAGREE, close, {"automaton": 0.01}),
    Turn(
        "repose_return",
        "final slope",
        AGREE,
        lambda table: table["case"] != "repeated",
        {"verdict": "agree"},
        gone=("climbs back in the automaton",),
        said=("agree in 39 of 39", "others: S0 - Sc = none"),
    ),
    Turn(
        "repose_return",
        "repeated pulses",
        AGREE,
        of(case="repeated"),
        {"verdict": "agree"},
        gone=("not resolved",),
    ),
    Turn(
        "roughness_decay",
        "roughness of the surface, long waves",
        AGREE,
        of(quantity="decay rate of u"),
        {"verdict": "agree"} | same_as_automaton("pde"),
        gone=("only carries", "no property of sand"),
    ),
    Turn(
        "roughness_decay",
        "diffusion smooths the surface",
        AGREE,
        of(quantity="decay rate of u"),
        same_as_automaton("pde"),
        said=("has 1 to 1",),
    ),
    Turn(
        "random_roughness",
        "random roughness",
        AGREE,
        of(model="pde"),
        {"mean": 0.358, "low": 0.357, "high": 0.359},
        said=("0.358 (0.357 to 0.359) in BCRE",),
    ),
    Turn(
        "uphill_propagation",
        "rolling front",
        EXPLAINED,
        of(quantity="front speed V"),
        same_as_automaton("pde"),
        gone=("swept down",),
    ),
    Turn(
        "uphill_propagation",
        "scarp",
        EXPLAINED,
        of(quantity="scarp speed c"),
        {"verdict": "explained by cell size"},
        said=("makes BCRE's as wide",),
    ),
    Turn(
        "uphill_propagation",
        "reach in figure 3",
        EXPLAINED,
        of(quantity="reach of R"),
        {"automaton": 5.0},
        gone=("all is swept downhill",),
    ),
    Turn(
        "second_critical_angle",
        "second critical slope, figure 1",
        DISAGREE,
        of(quantity="Sd - Sc", case="figure 1"),
        {"difference_effective": 0.1, "verdict": "disagree"},
        said=("does not reach Pe = 1",),
    ),
    Turn(
        "second_critical_angle",
        "second critical slope, figures 2 and 3",
        AGREE,
        of(quantity="Sd - Sc", case="figures 2 and 3"),
        {"automaton": 2.0, "pde": 2.0, "difference_effective": 0.0, "verdict": "agree"},
        gone=("does not reach", "no sand stands"),
    ),
    Turn(
        "second_critical_angle",
        "second critical slope, calibrated",
        AGREE,
        of(quantity="Sd - Sc, calibrated"),
        {"difference": 0.01, "verdict": "agree"},
        gone=("D_eff = D holds",),
    ),
    Turn(
        "second_critical_angle",
        "threshold against pulse",
        EXPLAINED,
        of(quantity="threshold S0 - Sc", pulse=10.0),
        {"automaton": 2.0},
        gone=("brings the pile down below Sd",),
    ),
    Turn(
        "avalanche_extent",
        "static layer",
        AGREE,
        of(quantity="left"),
        {"automaton": 0.0, "pde": 0.0},
        gone=("wedge at repose",),
    ),
    Turn("avalanche_extent", "rolling layer", DISAGREE, of(quantity="grown"), {"pde": 0.5}),
    Turn("avalanche_extent", "even slope", DISAGREE, of(quantity="even"), {"automaton": 0.1}),
    Turn(
        "avalanche_extent",
        "avalanche below repose",
        AGREE,
        of(quantity="rolling", case="figure2"),
        {"automaton": 2.0, "pde": 2.0},
        gone=("no more rolls",),
    ),
    Turn(
        "avalanche_extent",
        "spreads, not travels",
        AGREE,
        of(quantity="travelled"),
        {"automaton": 0.1, "pde": 0.1},
    ),
    Turn(
        "choices",
        "figure 2, R",
        DISAGREE,
        of(verdict__on="figure 2, R", choice="N"),
        {"halved": "disagree"},
        said=("It turns with N halved: disagree",),
    ),
    Turn(
        "modified_equation",
        "explained in space",
        AGREE,
        of(split="space"),
        {"explained": 0.95},
        said=("0 of 21 rows (none)",),
    ),
    Turn(
        "modified_equation",
        "explained in time",
        UNRESOLVED,
        of(split="time"),
        {"explained": 0.95, "verdict": lambda rows: rows["scene"].map(ONE_UNRESOLVED)},
        said=("2 of 14 rows are unresolved (figure1)",),
    ),
    Turn(
        "printed_rule",
        "the reading that reproduces",
        AGREE,
        of(figure="figure1"),
        {"drift": 0.1},
        gone=("only the synchronous order",),
    ),
    Turn(
        "printed_rule",
        "the printed sign",
        DISAGREE,
        of(figure="figure1", sign="printed"),
        {"caption": True},
        gone=("reverse slope",),
    ),
    Turn(
        "one_variable",
        "second critical angle",
        DISAGREE,
        of(quantity="final S - Sc"),
        {"one_variable": 0.2},
        gone=("only critical slope", "the layer finds its own"),
    ),
    Turn(
        "which_model",
        "second critical slope",
        AGREE,
        all_rows,
        {"second critical slope": "yes"},
        gone=("2 of 4 do",),
        said=("4 of 4 do",),
    ),
    Turn(
        "which_model",
        "smoothing",
        AGREE,
        all_rows,
        {"smooths": "yes"},
        said=("4 of 4 do",),
    ),
    Turn(
        "which_model",
        "automaton of each closure",
        AGREE,
        all_rows,
        {
            "smooths": "yes",
            "returns to Sc": "no",
            "goes uphill": "no",
            "second critical slope": "no",
        },
        gone=("its model",),
        said=("16 of 16",),
    ),
    Turn(
        "which_model",
        "thresholds on finer cells",
        DISAGREE,
        of(model="BCRE", cells=400, pulse=10.0),
        {"threshold": 1.2},
        said=("2.68, 1.48, 1.2 on 400 cells",),
        table="thresholds",
    ),
    Turn(
        "which_model",
        "thresholds on finer cells",
        DISAGREE,
        of(model="automaton", cells=100, pulse=1.0),
        {"threshold": 1.48, "first of sparse slopes": 1.2},
        gone=("which lie farther apart",),
        table="thresholds",
    ),
    Turn(
        "quasi_static_limit",
        "rate in eps",
        DISAGREE,
        of(quantity="slope", number="eps", model="ca"),
        {"order": 2.0},
        said=("order 2",),
        table="rates",
    ),
    Turn(
        "quasi_static_limit",
        "opposite signs",
        DISAGREE,
        of(quantity="reach", number="tau"),
        {"coefficient": 0.5},
        gone=("a small error of one quantity",),
        table="rates",
    ),
    Turn(
        "quasi_static_limit",
        "the limit",
        DISAGREE,
        of(model="pde"),
        {"slope": -0.02},
        said=("slope (pde) -0.02",),
    ),
    Turn(
        "quasi_static_limit",
        "when no rolling layer is needed",
        DISAGREE,
        of(eps=0.0125, tau=0.01),
        {"error": 0.06},
        said=("up to 0.06",),
    ),
    Turn(
        "quasi_static_limit",
        "the paper's figures",
        DISAGREE,
        of(figure="figure1"),
        {"error": 0.01},
        said=("error 0.01",),
        table="figures",
    ),
    Turn(
        "order_of_accuracy",
        "order of the limited scheme",
        AGREE,
        lambda table: table["scheme"].str.startswith("limited"),
        {"verdict": "agree", "order_L1": 2.0},
        gone=("falls from grid to grid",),
        said=("outside: none",),
    ),
    Turn(
        "order_of_accuracy",
        "further models",
        DISAGREE,
        of(solution="Cole-Hopf wave", model="ca"),
        {"verdict": "disagree", "order": 0.5},
        said=("order 0.5",),
        table="further_models",
    ),
    Turn(
        "speed_error",
        "efficiency at 10 %",
        DISAGREE,
        of(scene="figure 2", contender="automaton, upwind"),
        {"seconds": 1e3},
        said=("faster in 3 of 4",),
        table="recorded_reach",
    ),
    Turn(
        "scaling",
        "ratios",
        DISAGREE,
        lambda table: table.index == 0,
        {"median": 0.1},
        said=("15 of 16",),
    ),
    Turn(
        "scene_needs",
        "left out together",
        AGREE,
        all_rows,
        {"together_1": 0.0, "together_5": 0.0},
        gone=("matter only together",),
    ),
    Turn(
        "stability",
        "boundary of the flux-limited rule",
        AGREE,
        of(variant="limited"),
        {"distance_percent": 1.0},
        gone=("passes every difference",),
    ),
    Turn(
        "stability",
        "boundary of BCRE by DOP853",
        AGREE,
        of(variant="DOP853"),
        {"distance_percent": 1.0, "predicted_stable_but_grows": 0},
        gone=("twelve stages",),
    ),
    Turn(
        "hard_cases",
        "R >= 0",
        AGREE,
        lambda table: table["smallest_R"] < 0,
        {"smallest_R": 0.0},
        gone=("undershoot",),
    ),
    Turn(
        "hard_cases",
        "the scarp needs the curvature term",
        DISAGREE,
        of(model="pde"),
        {"verdict": "unresolved"},
        table="scarp",
    ),
    Turn(
        "hard_cases",
        "the scarp needs the curvature term",
        AGREE,
        of(model="ca"),
        {"verdict": "resolved"},
        gone=("goes with its cell",),
        table="scarp",
    ),
    Turn(
        "advice",
        "the cheapest",
        DISAGREE,
        of(result="unresolved"),
        {"result": "not said"},
        said=("said to be: none",),
        table="cheapest",
    ),
]
ONE_UNRESOLVED = {
    name: "unresolved" if name == "figure1" else "agree"
    for name in (
        *("climbing_wave", "figure1", "figure1_between", "figure2", "figure3"),
        *("pulse_at_repose", "rough_slope"),
    )
}


def judged(name, tables):
    return {claim.name: claim for claim in study(name).judge(tables)}


@cache
def as_committed(name):
    return judged(name, committed(name))


def turned(turn):
    """The study's tables with the change."""
    tables = dict(committed(turn.study))
    table = tables[turn.table].copy()
    rows = pd.Series(turn.where(table), index=table.index)
    assert rows.any(), "the change touches no row"
    for head, value in turn.change.items():
        new = value(table[rows]) if callable(value) else value
        table[head] = table[head].astype(object) if isinstance(value, str) else table[head]
        table.loc[rows, head] = new
    return tables | {turn.table: table}


@pytest.mark.parametrize("turn", TURNS, ids=lambda turn: f"{turn.study}, {turn.claim}")
def test_what_is_said_turns_with_what_was_measured(turn):
    before = as_committed(turn.study)[turn.claim]
    after = judged(turn.study, turned(turn))[turn.claim]
    assert after.verdict is turn.verdict
    assert after.evidence != before.evidence or turn.verdict is not before.verdict
    for sentence in turn.gone:
        assert sentence in before.evidence or sentence.capitalize() in before.evidence
        assert sentence.lower() not in after.evidence.lower()
    for sentence in turn.said:
        assert sentence not in before.evidence
        assert sentence in after.evidence


def test_every_study_is_asked():
    assert {turn.study for turn in TURNS} == set(STUDIES)
