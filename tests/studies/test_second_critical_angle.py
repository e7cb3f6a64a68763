"""Sd by growth at a fixed place, on parameters that stand in no scene and no study; who climbs."""

import pandas as pd
import pytest

import bcre_pde
from bcre_ca.theory import second_critical_excess
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.models.effective import effective, effective_at_critical_slope
from bcre_studies.models.registry import AUTOMATON, BCRE, EFFECTIVE
from bcre_studies.observables.outcome import Outcome
from bcre_studies.validation.second_critical_angle import finite_pulses, study
from bcre_studies.validation.second_critical_angle.climb import (
    Bracket,
    climb,
    pulse_scene,
    threshold,
)
from bcre_studies.validation.second_critical_angle.critical_slope import (
    calibrated_rule,
    measure_sd_automaton,
    measure_sd_pde,
    upwind_rule,
)

MATERIALS = [
    bcre_pde.Material(v=0.17, D=0.23, gamma=0.021, Sc=0.4),
    bcre_pde.Material(v=3.1, D=0.06, gamma=0.7, Sc=0.0),
    bcre_pde.Material(v=0.04, D=0.5, gamma=0.3, Sc=1.2),
]


@pytest.mark.parametrize("material", MATERIALS)
@pytest.mark.parametrize("d", [0.7, 2.0])
def test_the_automatons_Sd_is_its_closed_form_within_a_thousandth(material, d):
    expected = second_critical_excess(material.v, material.D, material.gamma, d)
    assert measure_sd_automaton(upwind_rule(material, d)) == pytest.approx(expected, rel=1e-3)


def test_the_automatons_Sd_at_figure_1_is_a_number():
    """(sqrt(0.2) - sqrt(0.1))^2/0.01 = 10 (3 - 2 sqrt 2), whatever the code's closed form says."""
    measured = measure_sd_automaton(upwind_rule(bcre_pde.Material(0.1, 0.1, 0.01, 0.5), 1.0))
    assert measured == pytest.approx(1.715729, rel=1e-3)


@pytest.mark.parametrize("material", MATERIALS)
def test_the_Sd_of_bcre_is_v_squared_over_4_D_gamma_within_a_hundredth(material):
    measured = measure_sd_pde(material)
    expected = material.v**2 / (4 * material.D * material.gamma)
    assert measured.value == pytest.approx(expected, rel=1e-2)
    assert measured.error < 1e-3 * expected


def test_half_a_cells_drift_counted_as_diffusion_gives_the_automatons_Sd_on_small_cells():
    material = bcre_pde.Material(v=0.17, D=0.23, gamma=0.021, Sc=0.4)
    d = 0.2 * material.D / material.v
    effective = measure_sd_pde(effective_at_critical_slope(material, d)).value
    assert measure_sd_automaton(upwind_rule(material, d)) == pytest.approx(effective, rel=3e-3)
    assert measure_sd_automaton(upwind_rule(material, d)) < 0.95 * measure_sd_pde(material).value


def test_Sd_of_a_layer_that_is_not_carried_is_refused():
    with pytest.raises(ValueError, match="v = 0"):
        measure_sd_pde(bcre_pde.Material(v=0.0, D=0.1, gamma=0.01, Sc=0.5))


@pytest.mark.parametrize(
    ("excess", "pulse", "automaton", "pde", "effective"),
    [
        (2.1, 1e-6, Outcome.STARTS, Outcome.NO, Outcome.STARTS),
        (1.0, 10.0, Outcome.YES, Outcome.NO, Outcome.YES),
        (1.35, 10.0, Outcome.YES, Outcome.YES, Outcome.YES),
        (0.7, 10.0, Outcome.NO, Outcome.NO, Outcome.NO),
    ],
)
def test_between_the_thresholds_only_what_has_the_cells_diffusion_climbs(
    excess, pulse, automaton, pde, effective
):
    assert climb(AUTOMATON, 100, excess, pulse) is automaton
    assert climb(BCRE, 100, excess, pulse) is pde
    assert climb(EFFECTIVE, 100, excess, pulse) is effective


def test_what_counts_as_effective_has_the_step_that_the_run_takes():
    """D + (v d/2)(1 - v dt/d) with dt = 0.2; at Sd alone D + v d/2."""
    scene = pulse_scene(1.0, 1.0)
    run = AUTOMATON.run(scene, [0.0, 400.0])
    assert run.steps == pytest.approx(400.0 / scene.time.step)
    assert pytest.approx(0.1 + 0.05 * (1 - 0.1 * scene.time.step)) == effective(scene).material.D
    material = bcre_pde.Material(0.1, 0.1, 0.01, 0.5)
    assert pytest.approx(0.15) == effective_at_critical_slope(material, 1.0).D


def test_a_finite_pulse_climbs_at_less_than_an_infinitesimal_one():
    whole = Bracket(0.5, 2.75)
    small, large = (threshold(AUTOMATON, (100,), pulse, whole) for pulse in (1e-7, 5.0))
    assert small.value == pytest.approx(1.715729, rel=0.025)
    assert large.high < 0.6 * small.low


def test_a_threshold_must_hold_on_every_grid():
    whole = Bracket(0.5, 2.75)
    coarse = threshold(AUTOMATON, (100,), 1.0, whole)
    both = threshold(AUTOMATON, (100, 200), 1.0, whole)
    fine = threshold(AUTOMATON, (200,), 1.0, whole)
    assert both.low <= coarse.value <= both.high < 1.02 * fine.value
    assert both.error > coarse.error


def _table(automaton_sd=1.7157, automaton_outcome="yes", **figure1):
    """Made-up rows; ``figure1`` changes those of Sd at figure 1's parameters."""
    numbers = {"pde": 2.5, "pde_effective": 1.7, "difference": 0.31, "difference_effective": 0.02}
    numbers |= {"automaton d/4": 2.2, "verdict": str(Verdict.EXPLAINED)}
    sd = numbers | {"quantity": study.SD, "v": 0.1, "D": 0.1, "gamma": 0.01, "d": 1.0}
    sd |= {"automaton": automaton_sd, "automaton_theory": 1.7157, "pde_theory": 2.5}
    outcome = {"quantity": finite_pulses.OUTCOME, "S0 - Sc": 1.0, "pulse": 10.0, "pde": "no"}
    outcome |= {"automaton": automaton_outcome, "pde_effective": "yes", "automaton d/4": "no"}
    thresholds = [
        numbers
        | {"quantity": finite_pulses.THRESHOLD, "pulse": pulse, "automaton": slope}
        | {"pde": slope + 0.2, "automaton d/4": slope + 0.1}
        for pulse, slope in ((1e-6, 1.75), (1.0, 1.27))
    ]
    far = {"v": 2.5, "automaton": 168.0, "automaton_theory": 168.0, "pde": 1562.5}
    far |= {"pde_theory": 1562.5, "difference_effective": 0.45, "verdict": "disagree"}
    rows = [
        sd | {"case": "figure 1"} | figure1,
        sd | {"case": "other materials", "v": 0.05},
        sd | {"case": "figures 2 and 3"} | far,
        outcome | {"verdict": str(Verdict.EXPLAINED)},
        *thresholds,
        sd | {"quantity": study.SD_CALIBRATED},
    ]
    return {"comparison": pd.DataFrame(rows)}


def claims(**changes):
    return {claim.name: claim for claim in study.judge(_table(**changes))}


@pytest.mark.parametrize("who", ["automaton", "calibrated automaton"])
def test_the_verdict_on_a_closed_form_turns_when_the_measurement_is_off_by_a_percent(who):
    good, bad = (claims(automaton_sd=sd)[f"closed form of Sd, {who}"] for sd in (1.7157, 1.7330))
    assert (good.verdict, bad.verdict) == (Verdict.AGREE, Verdict.DISAGREE)


def test_Sd_is_judged_per_set_of_parameters_and_no_sand_stands_at_that_of_figures_2_and_3():
    found = claims()
    assert found["second critical slope, figure 1"].verdict is Verdict.EXPLAINED
    assert found["second critical slope, other materials"].verdict is Verdict.EXPLAINED
    steep = found["second critical slope, figures 2 and 3"]
    assert steep.verdict is Verdict.DISAGREE
    assert "does not reach Pe = 25" in steep.evidence
    assert "89.7" in steep.evidence
    assert "no sand stands" in steep.evidence
    assert "no sand stands" not in found["second critical slope, figure 1"].evidence
    turned = claims(verdict="disagree", difference_effective=0.06)
    assert turned["second critical slope, figure 1"].verdict is Verdict.DISAGREE


@pytest.mark.parametrize("material", MATERIALS)
@pytest.mark.parametrize("d", [0.7, 2.0])
def test_the_calibrated_automatons_Sd_is_that_of_its_rule_and_nearer_to_bcre(material, d):
    rule = calibrated_rule(material, d)
    assert rule.effective_diffusion() == pytest.approx(material.D, rel=1e-9)
    assert rule.dt <= rule.max_stable_step()
    measured = measure_sd_automaton(rule)
    assert measured == pytest.approx(rule.second_critical_slope() - rule.Sc, rel=1e-3)
    upwind = second_critical_excess(material.v, material.D, material.gamma, d)
    bcre = material.v**2 / (4 * material.D * material.gamma)
    assert abs(measured - bcre) < abs(upwind - bcre)


def test_the_evidence_names_the_cases_that_differ():
    claim = claims()["runs to the top"]
    assert claim.verdict is Verdict.EXPLAINED
    assert "1 and pulse 10 (yes/no, effective yes" in claim.evidence
    assert "differ at S0 - Sc = none" in claims(automaton_outcome="no")["runs to the top"].evidence
