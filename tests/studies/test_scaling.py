"""Ratios against their goals and the real-time budget, judged on made-up tables."""

import pandas as pd
import pytest

from bcre_studies.comparison.verdict import Verdict
from bcre_studies.models import registry
from bcre_studies.performance import scaling as study
from bcre_studies.performance.record import models as speeds


def models(**seconds):
    """Every model takes a second, its automaton a tenth, on 100 cells and twice that on 400."""
    own = dict.fromkeys((model.text for model in registry.MODELS.values()), 1.0)
    own |= {rule.text: 0.1 for rule in (registry.AUTOMATON, registry.THICK_AUTOMATON)}
    own |= {registry.SLOPE_DRIVEN_AUTOMATON.text: 0.1} | seconds
    return pd.DataFrame(
        [
            {"model": model, "cells": cells, "seconds_per_time": factor * taken}
            for cells, factor in ((100, 1), (400, 2))
            for model, taken in own.items()
        ]
    )


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
    more = {"plane": plane, "plane_budget": squares, "models": models()}
    return {"comparison": comparison, "budget": budget, **more}


def verdicts(**changes):
    return [claim.verdict for claim in study.judge(tables(**changes))]


def test_all_goals_reached_agree():
    assert verdicts() == [Verdict.AGREE] * 5
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


def test_automaton_slower_than_its_model_turns_the_verdict_on_models():
    def claim(**seconds):
        changed = tables() | {"models": models(**seconds)}
        return {claim.name: claim for claim in study.judge(changed)}["models on figure 1"]

    assert claim().verdict is Verdict.AGREE
    assert "10 to 10 times" in claim().evidence
    slow = claim(**{registry.THICK_AUTOMATON.text: 2.0})
    assert slow.verdict is Verdict.DISAGREE
    assert f"{registry.THICK_AUTOMATON.text} 0.5 to 0.5 times" in slow.evidence


def test_models_are_timed_in_turns_so_that_a_slow_round_leaves_their_ratio(monkeypatch):
    calls = []

    def run(model, scene, cells):
        calls.append(model.name)
        slow = 5.0 if len(calls) > 5 * len(speeds.COMPARED) else 1.0
        return slow * (0.5 if model is registry.AUTOMATON else 1.5), 7

    monkeypatch.setattr(speeds, "_run", run)
    table = speeds.measure(cells=[100], rounds=5).set_index("model")
    assert set(table.index) == {model.text for model in speeds.COMPARED}
    assert registry.EFFECTIVE.text not in table.index
    assert (table[["to_automaton", "smallest", "largest"]].loc["Hwa-Kardar"] == 3.0).all()
    assert table.loc["automaton", "seconds_per_time"] == 0.5 / 400
    assert calls[: len(speeds.COMPARED)] == calls[-len(speeds.COMPARED) :]
