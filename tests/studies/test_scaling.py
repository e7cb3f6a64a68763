"""Ratios against their goals and the real-time budget, judged on made-up tables."""

import pandas as pd
import pytest

from bcre_studies.comparison.verdict import Verdict
from bcre_studies.performance import scaling as study


def tables(ratios=((2.0, 1.5), (0.9, 0.8)), upwind=(4000.0, 300.0), pde=(50.0, 20.0)):
    """Ratios as (median, goal); cells at 60 frames a second, a figure each."""
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
    return {"comparison": comparison, "budget": budget}


def verdicts(**changes):
    return [claim.verdict for claim in study.judge(tables(**changes))]


def test_all_goals_reached_agree():
    assert verdicts() == [Verdict.AGREE, Verdict.AGREE]
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
