"""The first screen: numbers come from the tables, and sentences turn when the numbers do."""

import math
from pathlib import Path

import pandas as pd
import pytest

from bcre_studies.comparison.claim import Claim
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.publishing.answers import answers, certainty, short_answer
from bcre_studies.publishing.deciding import NUMBERS, deciding_number
from bcre_studies.publishing.headline import headline
from bcre_studies.publishing.stories import STORIES, story_of
from bcre_studies.publishing.wording import number, percent, span
from bcre_studies.reporting.page.mathml import formula
from bcre_studies.system.files import ROOT

REPORTS = ROOT / "reports"


def profiles(difference=0.5, left=0.01, verdict=Verdict.EXPLAINED):
    row = {"quantity": "R(x) at the end", "t": 20.0, "d": 1.0, "difference": difference}
    row |= {"difference_effective": left, "difference_error": 1e-6, "verdict": str(verdict)}
    unresolved = row | {"case": "figure1", "verdict": str(Verdict.UNRESOLVED)}
    return pd.DataFrame([unresolved, row | {"case": "figure2"}])


def slopes(automaton=1.5, bcre=2.5):
    row = {"quantity": "Sd - Sc", "automaton": automaton, "automaton d/4": 2.0, "pde": bcre}
    return pd.DataFrame([row | {"automaton_theory": automaton * 1.001, "pde_theory": bcre}])


def pulses(ends=(0.0, 0.35, 0.3), bcre=0.3):
    rows = [
        {
            "quantity": "final S - Sc",
            "case": "slow",
            "pulses": 1,
            "S0 - Sc": 0.3,
            "automaton": end,
            "pde": bcre,
        }
        for end in ends
    ]
    return pd.DataFrame([*rows, rows[0] | {"case": "repeated", "automaton": 9.0}])


def choices():
    rows = [("agree", "agree", "agree"), ("yes", "-", "yes"), ("yes", "no", "unresolved")]
    return pd.DataFrame(rows, columns=["as it stands", "halved", "doubled"])


def race(times):
    rows = [
        {"scene": "a", "error": error, "contender": name, "seconds": seconds, "automaton_s": None}
        for error, name, seconds in times
    ]
    return pd.DataFrame(rows)


RACE = [
    (0.1, "automaton, upwind", 1.0),
    (0.1, "PDE, RK45", 7.0),
    (0.1, "PDE, LSODA", 3.0),
    (0.01, "automaton, upwind", 40.0),
    (0.01, "automaton, limited", 2.0),
    (0.01, "PDE, RK45", 4.0),
]


def tables(**changes):
    reading = {"figure": "figure2", "step": "stable", "sign": "consistent", "order": "synchronous"}
    reading |= {"dt": 0.2, "drift": 2.5, "diffusion": 0.725}
    order = pd.DataFrame(
        {
            "model": ["ca", "ca", "pde"],
            "scheme": ["0.5 of", "limited", "RK45"],
            "order_L1": [0.97, 2.0, 4.9],
        }
    )
    found = {
        "printed_rule": pd.DataFrame([reading]),
        "paper_figures": profiles(),
        "second_critical_angle": slopes(),
        "repose_return": pulses(),
        "choices": choices(),
        "order_of_accuracy": order,
    } | changes
    return {name: {"comparison": table} for name, table in found.items()} | {
        "speed_error": {"recorded_reach": changes.get("reach", race(RACE))}
    }


def said(about, **changes):
    (text,) = [each.text for each in answers(headline(tables(**changes))) if each.about == about]
    return text


def test_numbers_are_those_of_the_tables():
    found = headline(tables())
    assert (found.diffusion[0].D, found.diffusion[0].acting) == (0.1, 0.725)
    figure1, figure2 = found.gaps
    assert not figure1.resolved
    assert (figure2.figure, figure2.difference, figure2.left) == ("figure2", 0.5, 0.01)
    assert (found.slopes.automaton, found.slopes.finer, found.slopes.bcre) == (1.5, 2.0, 2.5)
    assert found.slopes.theory_gap == pytest.approx(0.001, rel=0.01)
    assert (found.pulses.cases, found.pulses.came_down, found.pulses.steeper) == (3, 1, 1)
    assert (found.coarse.won, found.coarse.by) == (1, (3.0,))
    assert (found.fine.won, found.fine.lost_by, found.fine.better_won) == (0, (10.0,), 1)
    assert found.choices == (3, 5)
    assert found.orders == (0.97, 4.9)


def test_of_several_times_of_a_figure_the_last_resolved_one_counts():
    rows = profiles()
    later = rows.assign(case="figure2", difference=0.9)
    resolved, unresolved = later.iloc[1:], later.iloc[:1]
    rows = pd.concat([rows, resolved.assign(difference=0.7, t=30.0), unresolved.assign(t=40.0)])
    found = headline(tables(paper_figures=rows))
    assert (found.gaps[1].difference, found.gaps[1].until) == (0.7, 30.0)
    assert "at t = 30; later BCRE is unresolved" in said("What that changes", paper_figures=rows)


@pytest.mark.parametrize(
    ("difference", "left", "start"),
    [(0.5, 0.01, "Not as it stands"), (0.01, 0.01, "Yes"), (0.5, 0.3, "No")],
)
def test_the_short_answer_turns_with_the_profiles(difference, left, start):
    rows = profiles(difference, left)
    assert short_answer(headline(tables(paper_figures=rows))).startswith(start)


def test_what_changes_is_said_with_its_numbers_and_what_cannot_be_judged():
    text = said("What that changes")
    assert percent(0.5) in text
    assert percent(0.01) in text
    assert "Figure 1 cannot be judged" in text
    unresolved = profiles(verdict=Verdict.UNRESOLVED)
    assert "nothing can be said" in said("What that changes", paper_figures=unresolved)


def test_the_two_critical_slopes_disagree_only_where_they_do():
    assert "the two disagree" in said("The second critical slope")
    same = said("The second critical slope", second_critical_angle=slopes(2.49))
    assert "disagree" not in same
    assert "in both" in same


def test_a_slope_that_fell_below_repose_would_be_told():
    assert "None ended below" in said("What one pulse does")
    below = said("What one pulse does", repose_return=pulses((-0.2, 0.3)))
    assert "1 ended below repose" in below
    assert "None" not in below


def test_each_model_is_said_to_steepen_by_its_own_number():
    assert "at most from 0.30 to 0.35 above repose." in said("What one pulse does")
    both = said("What one pulse does", repose_return=pulses(bcre=0.9))
    assert "to 0.35 above repose (in BCRE from 0.30 to 0.90)." in both


def test_a_slope_of_either_model_that_fell_below_repose_would_be_told():
    assert "3 ended below" in said("What one pulse does", repose_return=pulses(bcre=-0.1))


def test_who_is_faster_follows_the_times():
    text = said("When it is faster")
    assert "in 1 of 1 scenes, by a factor of 3" in text
    assert "BCRE’s solver is faster in 1 of 1, by a factor of 10 or more" in text
    quick = race(
        [(error, "automaton, upwind", 1.0) for error in (0.1, 0.01)]
        + [(error, "PDE, RK45", 2.0) for error in (0.1, 0.01)]
    )
    assert "it is faster in all 1" in said("When it is faster", reach=quick)
    slow = race([(error, "PDE, RK45", 2.0) for error in (0.1, 0.01)])
    assert "Nowhere" in said("When it is faster", reach=slow)


def test_certainty_leaves_out_what_was_not_resolved():
    unresolved = profiles(verdict=Verdict.UNRESOLVED)
    assert len(certainty(headline(tables(paper_figures=unresolved)))) == 3
    assert len(certainty(headline(tables()))) == 4


# Numbers and words


def test_numbers_in_sentences():
    assert [percent(x) for x in (0.528, 0.0069, 0.099, 1e-6, 0.0, 0.9965)] == [
        text.replace(" %", "\N{NO-BREAK SPACE}%")
        for text in ("53 %", "0.7 %", "10 %", "below 0.01 %", "0 %", "99.7 %")
    ]
    assert number(-0.0083, 2) == "−0.0083"
    assert number(14200.0, 2) == "14000"
    assert number(1e-13) == "10⁻¹³"
    assert number(6e-8, 1) == "6 × 10⁻⁸"
    assert span([2.0, 61.2]) == "2 to 61"
    assert span([3.0]) == "3"


# The committed tables


def committed(name):
    return {
        path.stem: pd.read_csv(path, keep_default_na=False, na_values=[""])
        for path in (REPORTS / name).glob("*.csv")
    }


@pytest.mark.parametrize("name", sorted(STORIES))
def test_a_story_asks_and_tells_in_three_sentences_at_most_of_plain_words(name):
    if not (REPORTS / name).is_dir():
        pytest.skip(f"{name} has no report here")
    story = STORIES[name]
    assert story.question.endswith("?")
    told = list(story.tell(committed(name)))
    assert 2 <= len(told) <= 3
    for sentence in told:
        assert sentence.endswith(".")
        assert "nan" not in sentence
    assert all(formula(text).startswith("<math") for text in story.equations)


CONDITIONS = [
    ("printed_rule", "drifts at the v", ("order", "synchronous"), "drift", 9.0),
    ("one_variable", "both two-layer models stand", ("quantity", "final S - Sc"), "pde", 0.0),
    ("random_roughness", "is larger", ("model", "pde"), "low", 0.1),
    ("avalanche_extent", "only loses sand", ("quantity", "rolling"), "pde", 1.1),
    ("avalanche_extent", "wedge at repose", ("quantity", "even"), "pde", 0.1),
    ("uphill_propagation", "swept down", ("quantity", "front speed V"), "pde", 0.0),
    ("opening_angle", "opens slowly", ("quantity", "edge of a layer"), "at x = 400", 50.0),
    ("opening_angle", "spreads sideways", ("quantity", "threshold S0 - Sc"), "automaton", 0.1),
    ("poured_heap", "does not converge", ("d", 0.25), "difference", 0.01),
    ("plane_agreement", "has a direction", ("case", "figure 2"), "isotropic", 0.01),
]
"""A study, words that hang on its table, and the rows and the value with which they are false."""


@pytest.mark.parametrize(
    ("name", "words", "where", "column", "value"), CONDITIONS, ids=[c[1] for c in CONDITIONS]
)
def test_a_sentence_that_interprets_goes_when_its_condition_does(name, words, where, column, value):
    found = committed(name)
    assert words in " ".join(STORIES[name].tell(found))
    rows = found["comparison"]
    changed = rows[column].mask(rows[where[0]] == where[1], value)
    tables = found | {"comparison": rows.assign(**{column: changed})}
    assert words not in " ".join(STORIES[name].tell(tables))


def test_a_study_without_a_story_is_told_by_its_docstring():
    story = story_of("new", "How new it is.\n\nMore.")
    assert (story.question, list(story.tell({}))) == ("How new it is", [])


@pytest.mark.parametrize("key", sorted(NUMBERS))
def test_the_deciding_number_is_in_the_committed_tables(key):
    study, name = key
    tables = {study: committed(study)}
    text = deciding_number([(study, claim(name, Verdict.DISAGREE))], tables)
    assert any(sign.isdigit() for sign in text)
    assert "nan" not in text


def claim(name, verdict):
    return Claim(name, "It holds.", verdict, "1 < 2", "a tenth")


def test_what_decides_is_the_first_claim_that_does_not_agree():
    tables = {"uphill_propagation": committed("uphill_propagation")}
    wave = ("uphill_propagation", claim("surface wave", Verdict.AGREE))
    front = ("uphill_propagation", claim("rolling front", Verdict.EXPLAINED))
    assert deciding_number([wave, front], tables).startswith("front")
    assert deciding_number([wave], tables).startswith("speed of the surface wave")
    unknown = [("new", claim("a", Verdict.AGREE)), ("new", claim("b", Verdict.DISAGREE))]
    assert deciding_number(unknown, tables) == "1 of 2 of our claims hold"
    assert math.isfinite(len(deciding_number([], tables)))


def test_the_report_for_a_code_host_is_short_and_its_links_lead_somewhere():
    text = (REPORTS / "README.md").read_text(encoding="utf-8")
    assert len(text.split()) < 2500
    for target in {part.split(")")[0] for part in text.split("](")[1:]}:
        assert (REPORTS / Path(target)).exists(), target
