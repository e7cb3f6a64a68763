"""Roughness decays by the automaton's cells, not by BCRE with kappa = 0."""

import math

import numpy as np
import pytest

from bcre_studies.comparison.verdict import Verdict
from bcre_studies.models.registry import AUTOMATON, BCRE
from bcre_studies.observables import fronts
from bcre_studies.scenes.scene import load
from bcre_studies.validation.roughness_decay import study as roughness_decay
from bcre_studies.validation.roughness_decay.modes import R_DECAY, mode_rows

R0, GAMMA, SPAN = 7.3, 0.023, 8.0


def surface_scene(d, dt):
    return load("rough_slope").with_changes(
        **{"gamma": GAMMA, "cells": round(100 / d), "until": SPAN, "step": dt},
        **{"surface.1.amplitude": 1e-6, "surface.1.seed": 5, "rolling.0.amplitude": R0},
    )


def surface_rate(run, waves):
    k = 2 * math.pi * waves / 100
    return fronts.mode_rate(run.x, run.u[0], run.u[-1], SPAN, k)


def rate_of_smoothing(waves, d, dt):
    """-ln|G|/dt with |G|^2 = 1 - 2 c (1 - c)(1 - cos k d)."""
    c = GAMMA * R0 * dt / d
    turn = 2 * math.pi * waves / 100 * d
    return -math.log(1 - 2 * c * (1 - c) * (1 - math.cos(turn))) / (2 * dt)


@pytest.mark.parametrize("waves", [3, 9, 25])
@pytest.mark.parametrize(("d", "dt"), [(1.0, 0.8), (0.5, 0.8)])
def test_the_automaton_smooths_the_surface_at_its_closed_form(waves, d, dt):
    run = AUTOMATON.run(surface_scene(d, dt), [0.0, SPAN])
    expected = rate_of_smoothing(waves, d, dt)
    assert -surface_rate(run, waves).real == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("waves", [3, 9, 25])
def test_bcre_without_kappa_carries_the_surface_uphill_and_does_not_smooth_it(waves):
    scene = surface_scene(1.0, 0.8)
    run = BCRE.run(scene, [0.0, SPAN], 400)
    rate = surface_rate(run, waves)
    assert abs(rate.real) < 0.003 * rate_of_smoothing(waves, 1.0, 0.8)
    assert rate.imag / (2 * math.pi * waves / 100) == pytest.approx(GAMMA * R0, rel=1e-3)


def test_kappa_eff_is_half_a_cell_of_gamma_less_the_courant_number():
    d, dt, waves = 1.0, 0.8, 6
    scene = surface_scene(d, dt)
    kappa = GAMMA * d / 2 * (1 - GAMMA * R0 * dt / d)
    run = BCRE.run(scene.with_changes(kappa=kappa), [0.0, SPAN], 400)
    smoothing = -surface_rate(run, waves).real
    assert smoothing == pytest.approx(kappa * R0 * (2 * math.pi * waves / 100) ** 2, rel=1e-3)
    assert smoothing == pytest.approx(rate_of_smoothing(waves, d, dt), rel=0.02)


def test_modes_of_the_rolling_layer_decay_at_their_closed_forms():
    rows = mode_rows(("R", 0.625))
    assert {row["quantity"] for row in rows} == {"decay rate of R", "downhill speed of R"}
    for row in rows:
        k, decay = row["k"], row["quantity"] == R_DECAY
        assert row["automaton"] == pytest.approx(row["automaton_theory"], rel=1e-3)
        assert row["pde"] == pytest.approx(0.1 * k**2 if decay else 0.1, rel=2e-3)
        effective = (0.1 + 0.1 * 0.625 / 2 * (1 - 0.1)) * k**2 if decay else 0.1
        assert row["pde_effective"] == pytest.approx(effective, rel=3e-3)


def test_finer_cells_smooth_the_surface_less():
    coarse, fine = (mode_rows(("u", d))[3]["automaton"] for d in (1.0, 0.25))
    assert fine == pytest.approx(coarse / 4, rel=0.05)


@pytest.fixture(scope="module")
def tables():
    def here(function, cases, label):
        return [function(case) for case in cases]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(roughness_decay, "each", here)
        return roughness_decay.run()


def test_the_rough_slope_gets_smooth_in_the_automaton_alone(tables):
    table = tables["comparison"]
    rows = table[table["quantity"] == roughness_decay.RMS]
    assert (rows["pde"] > 0.099).all()
    assert (rows["automaton"] < 0.055).all()
    assert rows["pde_effective"].to_numpy() == pytest.approx(rows["automaton"].to_numpy(), rel=0.02)
    assert np.allclose(rows["automaton"], rows["automaton_theory"], rtol=5e-3)


def test_verdicts_tell_long_waves_from_short_ones(tables):
    verdicts = {claim.name: claim.verdict for claim in roughness_decay.judge(tables)}
    assert verdicts["roughness of the surface, long waves"] == Verdict.EXPLAINED
    assert verdicts["roughness of the rolling layer, long waves"] == Verdict.EXPLAINED
    assert verdicts["speeds, long waves"] == Verdict.AGREE
    assert verdicts["short waves"] == Verdict.DISAGREE
    assert verdicts["closed forms"] == Verdict.AGREE


def test_a_wrong_rate_is_noticed(tables):
    spoilt = tables["comparison"].copy()
    spoilt.loc[0, "automaton"] *= 1.01
    verdicts = {c.name: c.verdict for c in roughness_decay.judge({"comparison": spoilt})}
    assert verdicts["closed forms"] == Verdict.DISAGREE
