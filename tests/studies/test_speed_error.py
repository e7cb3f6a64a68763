"""Speed against error: who wins on made-up tables."""

from dataclasses import replace

import pandas as pd
import pytest

from bcre_studies.comparison.verdict import Verdict
from bcre_studies.performance import speed_error as study
from bcre_studies.performance.record import contest
from bcre_studies.performance.record.record import TARGETS

OURS, PDE = study.PAPERS, "PDE, RK45"
CALIBRATED, LIMITED = study.BETTER


def seconds(table, scene="s", bound=9.0):
    """Rows of ``reach``: per contender the seconds to the errors it reaches, in their order."""
    return pd.DataFrame(
        [
            {"scene": scene, "error": target, "contender": name}
            | {"seconds": taken, "automaton_s": bound}
            for name, times in table.items()
            for target, taken in zip(TARGETS, times, strict=False)
        ]
    )


def errors(scene="s", **cell_steps):
    """Rows of ``errors``: per contender the cell-steps at which its error is 1 %."""
    names = {"upwind": OURS, "calibrated": CALIBRATED, "limited": LIMITED}
    rows = [
        {"scene": scene, "contender": names[name], "error_R": error, "cell_steps": steps}
        for name, most in cell_steps.items()
        for error, steps in ((0.3, most / 10), (0.01, most))
    ]
    return pd.DataFrame(rows)


FEWER = errors(upwind=1e6, calibrated=1e4, limited=1e5)


def claims(table, counted=FEWER):
    tables = {"errors": counted, "recorded_reach": seconds(table)}
    return {claim.name: claim for claim in study.judge(tables)}


def verdicts(table, counted=FEWER):
    return [claim.verdict is Verdict.AGREE for claim in claims(table, counted).values()]


FASTEST = {OURS: [1, 2, 3, 4], CALIBRATED: [1, 2, 3], LIMITED: [1, 2, 3], PDE: [5, 5, 5, 5]}


def test_every_claim_agrees_where_the_automaton_wins_everywhere():
    assert verdicts(FASTEST) == [True, True, True, True]


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({OURS: [1, 2, 3, 6]}, [False, True, True, True]),
        ({OURS: [1, 2, 3]}, [False, True, True, True]),
        ({OURS: [6, 2, 3, 4]}, [False, False, True, True]),
        ({OURS: []}, [False, False, True, True]),
        ({CALIBRATED: [6, 6, 6]}, [True, True, True, True]),
        ({CALIBRATED: [6, 6, 6], LIMITED: [1, 2, 6]}, [True, True, False, True]),
        ({CALIBRATED: [1, 2], LIMITED: [1, 2]}, [True, True, False, True]),
        ({PDE: [5, 5, 5]}, [True, True, True, True]),
        ({"PDE, LSODA": [9, 9, 9, 0.1]}, [False, True, True, True]),
        ({"NumPy automaton": [0.1, 0.1, 0.1, 0.1]}, [True, True, True, True]),
    ],
)
def test_the_shorter_time_wins_and_what_is_not_reached_loses(changes, expected):
    assert verdicts(FASTEST | changes) == expected


def test_evidence_counts_wins_and_gives_both_times():
    evidence = claims(FASTEST | {OURS: [0.001, 2, 6]})["efficiency"].evidence
    assert "the faster in 2 of 4 pairs" in evidence
    assert "at 10 % in 1 of 1 scenes, by 5e+03 to 5e+03 times, and at 0.1 % in none" in evidence
    assert "BCRE's solver is the faster in 2: at 1 % by 1.2 to 1.2 times, " in evidence
    assert "0.1 % by 1.8 to 1.8 times, or more where" in evidence
    assert "never" not in evidence


def test_automaton_that_gets_worse_never_arrives():
    tables = {"errors": FEWER, "recorded_reach": seconds({PDE: [5]}, bound=float("nan"))}
    assert "the automaton never does in s, where" in study.judge(tables)[0].evidence


@pytest.mark.parametrize(
    ("counted", "agrees"),
    [
        (errors(upwind=1e6, calibrated=1e7, limited=1e5), True),
        (errors(upwind=1e6, calibrated=1e5, limited=1e7), True),
        (errors(upwind=1e6, calibrated=1e6, limited=1e7), False),
        (errors(calibrated=1e6, limited=1e7), True),
        (errors(upwind=1e6), False),
        (pd.concat([FEWER, errors("t", upwind=1e4, calibrated=1e5)]), False),
    ],
)
def test_better_rules_must_take_fewer_cell_steps_on_every_scene(counted, agrees):
    assert verdicts(FASTEST, counted) == [True, True, True, agrees]


def test_without_a_record_only_cell_steps_are_judged():
    (claim,) = study.judge({"errors": FEWER})
    assert claim.name == "what better rules buy"
    assert "s: 1e+04 against 1e+06" in claim.evidence


def test_fewest_cell_steps_are_those_of_the_cheapest_grid_that_meets_each_error():
    table = study.fewest_cell_steps(errors(upwind=2e6, limited=1e5)).set_index("contender")
    assert table.loc[OURS, "cell-steps to 10 %"] == "2e+06"
    assert table.loc[LIMITED, "cell-steps to 1 %"] == "1e+05"
    assert table.loc[OURS, "cell-steps to 0.1 %"] == "not reached"


def test_errors_are_told_no_further_than_the_truth_allows(monkeypatch):
    """With a truth known to 0.5 %, errors below 5 % say nothing."""
    scene = contest.scenes()["figure 2"]
    truth = contest.truth_of(scene)
    index = [contender.name for contender in contest.own()].index("automaton, limited")
    few = tuple(replace(contender, most=1e6) for contender in contest.own())
    monkeypatch.setattr(contest, "own", lambda: few)
    all_rows = study._errors_of(("figure 2", index))
    monkeypatch.setattr(contest, "truth_of", lambda scene: replace(truth, error=0.005))
    rows_of_case = study._errors_of(("figure 2", index))
    assert len(rows_of_case) < len(all_rows)
    assert [row["cells"] for row in rows_of_case] == [
        row["cells"] for row in all_rows if row["error_R"] >= 0.05
    ]
    assert all(row["cell_steps"] == float(f"{row['cell_steps']:.1e}") for row in rows_of_case)
