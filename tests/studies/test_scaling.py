"""Ratios against their goals and the real-time budget, judged on made-up tables."""

import pandas as pd
import pytest

from bcre_studies.comparison.verdict import Verdict
from bcre_studies.performance import scaling as study


def tables(ratios=((2.0, 1.5), (0.9, 0.8)), upwind=(4000.0, 300.0), pde=(50.0, 20.0), **on_plane):
    """Ratios as (median, goal); cells at 60 frames a second, a figure each."""
    threads, side, best = ({"threads": 1.9, "side": 800.0, "best": 2.0} | on_plane).values()
    comparison = pd.DataFrame(
        [
            {"ratio": f"ratio {i}", "goal": goal, "median": median}
            for i, (median, goal) in enumerate(ratios)
        ]
    )
    budget = pd.DataFrame(
        [
            {"scene": f"figure{i + 1}", "model": model, "cells": cells}
            for model, row in (("automaton, upwind", upwind), ("PDE, runge-kutta", pde))
            for i, cells in enumerate(row)
        ]
    )
    plane = pd.DataFrame(
        [
            {
                "ratio": "two threads : one",
                "goal": 1.7,
                "median": threads,
                "two_threads_at_best": best,
            }
        ]
    )
    squares = pd.DataFrame(
        [
            {
                "scene": "figure1",
                "threads": 1,
                "side": 400.0,
                "goal": None,
                "two_threads_at_best": best,
            },
            {
                "scene": "figure1",
                "threads": 2,
                "side": side,
                "goal": 768.0,
                "two_threads_at_best": best,
            },
        ]
    )
    more = {"plane": plane, "plane_budget": squares}
    return {"comparison": comparison, "budget": budget, **more}


def verdicts(**changes):
    return [claim.verdict for claim in study.judge(tables(**changes))]


def test_all_goals_reached_agree():
    assert verdicts() == [Verdict.AGREE] * 4
    assert "2 of 2 ratios reach their goal" in study.judge(tables())[0].evidence


@pytest.mark.parametrize("missed", [0, 1])
def test_a_single_missed_goal_turns_the_claim_and_is_named_alone(missed):
    ratios = [(2.0, 1.5), (0.9, 0.8)]
    ratios[missed] = (0.79, 0.8)
    claim = study.judge(tables(ratios=ratios))[0]
    assert claim.verdict is Verdict.DISAGREE
    assert "1 of 2 ratios reach their goal" in claim.evidence
    assert f"ratio {missed} 0.79 (goal 0.8)" in claim.evidence
    assert f"ratio {1 - missed}" not in claim.evidence


def test_goal_that_is_just_reached_is_reached():
    assert verdicts(ratios=[(0.8, 0.8)])[0] is Verdict.AGREE


def test_a_figure_with_fewer_cells_than_the_papers_is_not_played():
    assert verdicts(upwind=(4000.0, 100.0))[1] is Verdict.AGREE
    assert verdicts(upwind=(99.0, 4000.0))[1] is Verdict.DISAGREE
    assert verdicts(pde=(1.0, 1.0))[1] is Verdict.AGREE
    evidence = study.judge(tables())[1].evidence
    assert "figure1 4e+03 cells, figure2 3e+02 cells" in evidence
    assert "BCRE's solver with up to figure1 50, figure2 20 cells" in evidence


@pytest.mark.parametrize("claim", [{"threads": 1.2}, {"side": 700.0}])
def test_a_goal_missed_on_a_plane_decides_unless_others_held_a_processor(claim):
    place = 2 if "threads" in claim else 3
    assert verdicts(**claim)[place] is Verdict.DISAGREE
    assert verdicts(**claim, best=1.1)[place] is Verdict.UNRESOLVED
    assert verdicts(best=1.1)[place] is Verdict.AGREE
    evidence = study.judge(tables(**claim, best=1.1))[place].evidence
    assert "two threads that share nothing did 1.1 times" in evidence.lower()


def test_loads_on_a_plane_count_the_cells_that_they_step():
    from bcre_studies.performance.record import plane

    run = plane.automaton(12, 1)
    assert run.amount == 32 * 144
    run.call()
    assert plane.plain_numpy(12).amount == 144
    h, R = plane.wet_plane(12)
    assert h.shape == R.shape == (12, 12)
    assert R.min() > 0
