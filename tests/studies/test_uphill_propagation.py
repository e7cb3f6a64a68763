"""Each mechanism of uphill propagation, on parameters that stand in no scene and no study."""

import math

import numpy as np
import pandas as pd
import pytest

import bcre_ca.theory
from bcre_pde import simple_wave
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.models.bcre import problem_of
from bcre_studies.models.registry import AUTOMATON, BCRE, EFFECTIVE
from bcre_studies.observables import fronts
from bcre_studies.scenes.scene import load
from bcre_studies.validation.uphill_propagation import mechanisms
from bcre_studies.validation.uphill_propagation import study as uphill_propagation

V, D, GAMMA = 0.17, 0.23, 0.021
TIMES = [150.0, 300.0, 600.0]


def release_scene(excess, d):
    return load("figure1").with_changes(
        **{"v": V, "D": D, "gamma": GAMMA, "length": 160.0, "cells": round(160 / d)},
        **{"until": TIMES[-1], "step": 0.3 * d, "surface.0.slope": 0.5 + excess},
        **{"rolling.0.amplitude": 1e-150, "rolling.0.centre": 110.0, "rolling.0.width": 2.5},
    )


def front_speed(run):
    return fronts.front_speed(run, 1e-150 * 2.5 / (2 * math.sqrt(D * TIMES[0])))


@pytest.mark.parametrize("d", [1.0, 0.4])
@pytest.mark.parametrize("excess", [0.8, 2.3])
def test_the_automatons_front_moves_at_its_own_closed_form(excess, d):
    run = AUTOMATON.run(release_scene(excess, d), TIMES)
    expected = bcre_ca.theory.uphill_front_speed(V, D, GAMMA * excess, d, 0.3 * d)
    assert front_speed(run) == pytest.approx(expected, abs=0.002 * (V + abs(expected)))


@pytest.mark.parametrize("excess", [0.8, 2.3])
def test_the_front_of_bcre_moves_at_twice_the_root_of_D_sigma_less_v(excess):
    scene = release_scene(excess, 1.0)
    run = BCRE.run(scene, TIMES, 240)
    expected = 2 * math.sqrt(D * GAMMA * excess) - V
    assert front_speed(run) == pytest.approx(expected, abs=0.002 * (V + expected))


def test_between_the_two_critical_slopes_only_the_automaton_climbs():
    excess = 1.3
    assert bcre_ca.theory.second_critical_excess(V, D, GAMMA, 1.0) < excess < V**2 / (4 * D * GAMMA)
    scene = release_scene(excess, 1.0)
    pde = BCRE.run(scene, TIMES, 240)
    assert front_speed(AUTOMATON.run(scene, TIMES)) > 0.002
    assert front_speed(pde) < -0.002


def test_the_surface_wave_climbs_at_gamma_R0_in_both_models():
    (row,) = mechanisms.wave(0.5, 7.0)
    assert row["pde"] == pytest.approx(0.07, rel=1e-4)
    assert row["automaton"] == pytest.approx(0.07, rel=0.01)
    assert row["automaton"] == pytest.approx(row["automaton_theory"], rel=1e-4)
    assert row["verdict"] == Verdict.AGREE


def test_the_automatons_scarp_is_as_fast_as_that_of_bcre_with_its_own_coefficients():
    scene = load("figure1").with_changes(
        **{"D": 1.0, "v": 0.12, "length": 70.0, "cells": 70, "until": 270.0, "step": 0.4},
        **{"surface.0.slope": 1.6, "rolling.0.amplitude": 100.0, "rolling.0.centre": 60.0},
    )
    times = np.arange(0.0, 271.0, 2.0)
    own = EFFECTIVE.run(scene, times, 140)
    speed = fronts.scarp_speed(own, 45.0)
    law = simple_wave.scarp_speed(problem_of(scene).material, 45.0)
    assert fronts.scarp_speed(AUTOMATON.run(scene, times), 45.0) == pytest.approx(speed, rel=0.03)
    assert 0.6 * law < speed < 0.9 * law


def test_the_reach_of_figure_3_is_that_of_a_drifting_gaussian():
    rolling, surface = mechanisms.reach(0.5)
    scene = load("figure3")
    width, spread = 4.0, math.sqrt(16 + 4 * 0.1 * 10)
    expected = -25 + (spread - width) * math.sqrt(math.log(100))
    assert rolling["pde"] == pytest.approx(expected, abs=0.01)
    assert rolling["pde_theory"] == pytest.approx(expected, abs=0.01)
    for row in (rolling, surface):
        assert row["automaton"] == pytest.approx(row["automaton_theory"], abs=0.1)
        assert row["pde"] == pytest.approx(row["pde_theory"], abs=0.02)
    (pulse,) = scene.rolling
    assert pulse.width == mechanisms.PULSE_WIDTH
    (incline,) = scene.surface
    assert incline.slope - scene.material.Sc == pytest.approx(mechanisms.FIGURE3_EXCESS)


def test_nothing_in_figure_3_climbs_above_the_pulses_own_edge():
    for row in mechanisms.reach(1.0):
        for model in ("automaton", "pde", "pde_effective"):
            assert row[model] < 0


def a_table():
    """A table in which all agree, to be spoilt."""
    rows = [
        {"quantity": quantity, "d": d, "value": value, "automaton": 1.0, "automaton_theory": 1.0}
        for quantity in mechanisms.QUANTITIES
        for d in mechanisms.CELLS
        for value in (1.0, 2.0)
    ]
    same = {"pde": 1.0, "pde_theory": 1.0, "pde_effective": 1.0, "pde_error": 0.0}
    same |= {"difference": 0.0, "difference_effective": 0.0, "verdict": str(Verdict.AGREE)}
    return pd.DataFrame(rows).assign(**same)


def test_a_claim_is_as_good_as_its_worst_case():
    table = a_table()
    claims = uphill_propagation.judge({"comparison": table})
    assert {claim.verdict for claim in claims} == {Verdict.AGREE}
    table.loc[table["quantity"] == mechanisms.WAVE, "verdict"] = str(Verdict.DISAGREE)
    table.loc[table["quantity"] == mechanisms.FRONT, "automaton"] = 1.01
    verdicts = {
        claim.name: claim.verdict for claim in uphill_propagation.judge({"comparison": table})
    }
    assert verdicts["surface wave"] == Verdict.DISAGREE
    assert verdicts["rolling front closed forms"] == Verdict.DISAGREE
    assert verdicts["scarp"] == Verdict.AGREE
