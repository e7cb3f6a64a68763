"""Closed-form factors against one step of the rule, and boundaries against measured growth."""

import numpy as np
import pandas as pd
import pytest

import bcre_ca
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.verification.stability import amplification, beyond, boundaries, growth, study
from bcre_studies.verification.stability.amplification import Numbers, rule_with, stable
from bcre_studies.verification.stability.diagram import (
    CLIMB_AND_DRIFT,
    DRIFT_AND_SPREAD,
    VARIANTS,
    Diagram,
)

CELLS, WAVES = 120, 7
UPWIND, CALIBRATED, LIMITED, RIGHT, LEFT = VARIANTS


def factor_of_one_step(numbers, variant, layer):
    """Of a wave in the middle of a long row, where a sweep's first cells no longer count."""
    wave = np.exp(2j * np.pi * WAVES / CELLS * np.arange(CELLS))
    rule, after = rule_with(numbers, variant), np.zeros(CELLS, complex)
    for part, unit in ((wave.real, 1.0), (wave.imag, 1j)):
        R = growth._steady_layer(rule, CELLS)
        h, start = np.zeros(CELLS), R.copy()
        (R if layer == "R" else h)[:] += 1e-8 * part
        h, R, _ = bcre_ca.step(h, R, rule, "periodic")
        after = after + unit * (R - start if layer == "R" else h)
    return (after / wave)[CELLS // 2] / 1e-8


@pytest.mark.parametrize("variant", [UPWIND, CALIBRATED, RIGHT, LEFT])
@pytest.mark.parametrize("numbers", [(0.3, 0.1, 0.0), (0.15, 0.3, 0.0), (0.05, 0.02, 0.0)])
def test_step_multiplies_waves_of_the_layer_by_G(variant, numbers):
    w = np.exp(2j * np.pi * WAVES / CELLS)
    expected = amplification._rolling(Numbers(*numbers), variant, w)
    assert factor_of_one_step(Numbers(*numbers), variant, "R") == pytest.approx(expected, abs=1e-7)


@pytest.mark.parametrize("variant", [UPWIND, CALIBRATED, RIGHT, LEFT])
@pytest.mark.parametrize("numbers", [(0.3, 0.1, 0.4), (0.2, 0.0, 0.7), (0.0, 0.0, 0.3)])
def test_step_multiplies_waves_of_the_surface_by_G(variant, numbers):
    c, b, a = numbers
    seen = a * (1 - b) / (1 - c - b) if variant is RIGHT else a
    w = np.exp(2j * np.pi * WAVES / CELLS)
    expected = amplification._climbing(seen, variant, w)
    assert factor_of_one_step(Numbers(*numbers), variant, "u") == pytest.approx(expected, abs=1e-7)


def test_shortest_wave_of_the_limited_rule_is_the_one_whose_limiter_cuts_off():
    zigzag, numbers = np.resize([1.0, -1.0], CELLS), Numbers(0.3, 0.1, 0.0)
    R = 1 + 1e-8 * zigzag
    _, after, _ = bcre_ca.step(np.zeros(CELLS), R, rule_with(numbers, LIMITED), "periodic")
    expected = amplification._limited(0.3, 0.1, 0.0, -1.0)
    assert ((after - 1) / zigzag)[50] / 1e-8 == pytest.approx(expected, abs=1e-7)


@pytest.mark.parametrize(
    ("variant", "ray", "boundary"),
    [
        (UPWIND, (1, 1, 0), 1 / 3),
        (UPWIND, (0.5, 0, 1), 1),
        (CALIBRATED, (1, 1, 0), 2**0.5 - 1),
        (RIGHT, (1, 1, 0), 1 / 2),
        (RIGHT, (1, 0, 1), 1 / 2),
        (RIGHT, (0, 1, 0.5), 1.0),
        (LEFT, (1, 1, 0), 1 / 2),
        (LEFT, (0.2, 0, 1), 1),
        (LIMITED, (0.1, 1, 0), 1 / 2),
    ],
)
def test_boundaries_are_those_of_pencil_and_paper_and_are_measured(variant, ray, boundary):
    ray = Numbers(*map(float, ray))
    assert stable(ray.times(0.999 * boundary), variant)
    assert not stable(ray.times(1.001 * boundary), variant)
    assert not growth.automaton_grows(ray.times(0.98 * boundary), variant)
    assert growth.automaton_grows(ray.times(1.02 * boundary), variant)


def test_a_thick_layer_shortens_the_step_of_a_sweep_downhill_only():
    numbers = Numbers(0.6, 0.0, 0.6)
    assert growth.automaton_grows(numbers, RIGHT)
    assert not growth.automaton_grows(numbers, UPWIND)
    assert not growth.automaton_grows(numbers, LEFT)
    refused = rule_with(numbers, RIGHT)
    with pytest.raises(bcre_ca.UnstableStep):
        bcre_ca.evolve(np.zeros(8), np.ones(8), refused, 1, "periodic")


def test_small_planes_are_measured_predicted_and_accepted_alike(monkeypatch):
    monkeypatch.setattr(boundaries, "POINTS", 8)
    monkeypatch.setattr(boundaries, "RAYS", 3)
    row, rays, points = boundaries.measure(Diagram("ca", RIGHT, CLIMB_AND_DRIFT))
    assert row["points"] == 64
    assert row["predicted_stable_but_grows"] == row["accepted_but_grows"] == 0
    assert row["distance_percent"] <= 2
    assert row["verdict"] == Verdict.AGREE
    assert sum(line["stable"].count("0") for line in points) == row["grow"] == row["refused"]
    assert all(ray["bound"] == pytest.approx(ray["predicted"], rel=0.01) for ray in rays)
    row, _, _ = boundaries.measure(Diagram("pde", "DOP853", DRIFT_AND_SPREAD))
    assert row["predicted_stable_but_grows"] > 0 == row["accepted_but_grows"]
    assert row["verdict"] == Verdict.DISAGREE


@pytest.mark.parametrize("variant", VARIANTS)
def test_no_layer_becomes_negative_within_the_bound(variant, monkeypatch):
    monkeypatch.setattr(beyond, "LAYER_CELLS", 5000)
    row = beyond.positivity(variant)
    assert row["least_percent_of_bound"] >= 99.9
    assert row["verdict"] == Verdict.AGREE
    assert (row["most_percent_of_bound"] > 101) == (variant not in (UPWIND, CALIBRATED))


def test_measured_growth_takes_what_is_not_finite_for_growth():
    assert growth._grows(1.0, np.inf, np.inf)
    assert growth._grows(1.0, 1.0, np.nan)
    assert growth._grows(1.0, 1e6, 1e6)
    assert not growth._grows(1.0, 300.0, 200.0)
    assert np.isnan(growth._largest(np.zeros(2), np.array([0.0, np.nan])))


def made_up(**changes):
    rows = [
        {
            "model": model,
            "variant": variant,
            "plane": DRIFT_AND_SPREAD,
            "points": 1600,
            "predicted_stable_but_grows": 0,
            "distance_percent": 1.0,
            "distance_visible_percent": 1.0,
            "accepted_but_grows": 0,
            "bound_percent_least": 90,
            "bound_percent_most": 100,
        }
        | (changes if variant == "upwind" else {})
        for model, variant in [
            ("ca", "upwind"),
            ("ca", "limited"),
            ("pde", "runge-kutta"),
            ("pde", "DOP853"),
        ]
    ]
    layers = {"variant": "limited", "least_percent_of_bound": 100.0, "verdict": str(Verdict.AGREE)}
    implicit = {"method": "BDF", "bounded": True, "mean_step_at_least_ten": True}
    return {
        "comparison": pd.DataFrame(rows),
        "positivity": pd.DataFrame([layers]),
        "implicit": pd.DataFrame([implicit | {"verdict": str(Verdict.AGREE)}]),
    }


def test_claims_fail_by_what_they_claim():
    def verdicts(**changes):
        return [claim.verdict is Verdict.AGREE for claim in study.judge(made_up(**changes))]

    assert verdicts() == [True] * 6
    assert verdicts(distance_percent=2.1) == [False] + [True] * 5
    assert verdicts(predicted_stable_but_grows=1) == [False] + [True] * 5
    assert verdicts(accepted_but_grows=1) == [True] * 4 + [False, True]
