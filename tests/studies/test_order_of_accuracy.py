"""Observed orders on exact solutions of no file, and that one per cent turns them red."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

import bcre_ca
from bcre_pde import exact
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.verification.order_of_accuracy import (
    further_models,
    layers,
    observed,
    study,
)
from bcre_studies.verification.order_of_accuracy.claims import order_of
from bcre_studies.verification.order_of_accuracy.expected import EXPECTED

SOLUTIONS = {
    "climbing": exact.climbing_hump(
        v=0.7, gamma=0.8, height=0.2, width=1.1, length=14.0, until=1.5, Sc=0.3
    ),
    "release": exact.frozen_slope_release(excess=0.9, v=0.8, D=0.4, gamma=0.15),
    "rolling": exact.rolling_mode(wavenumber=0.8, v=0.6, D=0.2, Sc=0.7),
}
UPWIND = [("ca", ("upwind", share)) for share in (0.25, 0.5, 0.9)]
SCHEMES = [*UPWIND, ("pde", "runge-kutta"), ("pde", "DOP853")]


@pytest.fixture
def fit(monkeypatch):
    """The study's own fit of order and error, for any solution; without the slowest grids."""
    finer = {"ca": observed.GRIDS["ca"], "pde": observed.GRIDS["pde"][:-1]}
    coarser = {model: grids[:4] for model, grids in finer.items()}
    limited = observed.LIMITED_GRIDS

    def fit(solution, model, scheme):
        monkeypatch.setattr(observed, "solutions", lambda: {"this": solution})
        diffuses = solution.material.D > 0
        monkeypatch.setattr(observed, "GRIDS", coarser if diffuses else finer)
        monkeypatch.setattr(observed, "LIMITED_GRIDS", limited[:4] if diffuses else limited)
        rows = pd.DataFrame(observed.errors_of(("this", model, scheme)))
        named = observed.named(*scheme) if model == "ca" else scheme
        key = {"solution": "this", "model": model, "scheme": named}
        return observed.fit(key, rows)

    return fit


def with_wrong(solution, name, factor):
    """The solution, with a wrong coefficient in the models."""
    wrong = factor * getattr(solution.material, name)
    return replace(solution, material=replace(solution.material, **{name: wrong}))


@pytest.mark.parametrize("name", SOLUTIONS)
@pytest.mark.parametrize(("model", "scheme"), SCHEMES)
def test_every_scheme_has_its_formal_order_and_a_small_error(fit, name, model, scheme):
    row = fit(SOLUTIONS[name], model, scheme)
    assert row["verdict"] == Verdict.AGREE
    assert row["formal_order"] == (1 if model == "ca" else 5)
    low, high = (0.9, 1.1) if model == "ca" else (4.0, 7.0)
    for norm in ("L1", "L2"):
        assert low <= row[f"order_{norm}"] <= high
    assert row["L1_on_finest"] <= (0.01 if model == "ca" else 1e-6)


@pytest.mark.parametrize("factor", [0.99, 1.01])
@pytest.mark.parametrize(("model", "scheme"), [("ca", ("upwind", 0.5)), ("pde", "runge-kutta")])
@pytest.mark.parametrize(
    ("name", "coefficient"),
    [
        ("climbing", "v"),
        ("climbing", "gamma"),
        ("release", "v"),
        ("release", "gamma"),
        ("rolling", "v"),
        ("rolling", "D"),
    ],
)
def test_coefficient_off_by_one_percent_turns_the_order_or_the_error_red(
    fit, name, coefficient, model, scheme, factor
):
    row = fit(with_wrong(SOLUTIONS[name], coefficient, factor), model, scheme)
    assert row["verdict"] == Verdict.DISAGREE


SATURATED = exact.saturated_flow(amplitude=0.2, wavenumber=0.7, v=0.8, v_up=1.1, Sc=0.3)
CURVED = exact.surface_mode(wavenumber=0.7, gamma=0.6, kappa=0.05, v=0.8)


@pytest.mark.parametrize("solution", [SOLUTIONS["rolling"], SOLUTIONS["climbing"], SATURATED])
def test_limited_scheme_is_of_order_two(fit, solution):
    row = fit(solution, "ca", ("limited", 0.5))
    assert (row["formal_order"], row["verdict"]) == (2, Verdict.AGREE)
    assert row["L1_on_finest"] < 1e-4


def test_calibrated_scheme_is_of_order_two_where_nothing_but_R_varies_and_else_of_order_one(fit):
    linear = fit(SOLUTIONS["rolling"], "ca", ("calibrated", 0.5))
    wave = fit(SOLUTIONS["climbing"], "ca", ("calibrated", 0.5))
    assert linear["order_L1"] > 1.8
    assert 0.9 <= wave["order_L1"] <= 1.1
    assert {linear["verdict"], wave["verdict"]} == {Verdict.AGREE}


@pytest.mark.parametrize("scheme", ["upwind", "calibrated"])
@pytest.mark.parametrize("solution", [SATURATED, CURVED], ids=["saturated", "curved"])
def test_automaton_with_a_closure_converges_to_the_exact_solution(fit, solution, scheme):
    row = fit(solution, "ca", (scheme, 0.5))
    assert row["order_L1"] >= 0.9
    assert row["verdict"] == Verdict.AGREE


@pytest.mark.parametrize("scheme", [("upwind", 0.5), ("limited", 0.5)])
@pytest.mark.parametrize(("solution", "name"), [(SATURATED, "v_up"), (CURVED, "kappa")])
def test_automaton_with_a_wrong_closure_does_not(fit, solution, name, scheme):
    good, bad = (fit(with_wrong(solution, name, f), "ca", scheme) for f in (1.0, 1.1))
    assert bad["L1_on_finest"] > 2 * good["L1_on_finest"]
    assert bad["order_L1"] < good["order_L1"] - 0.2


def test_thick_step_is_twice_the_limited_one_and_keeps_the_layer_positive():
    x = (np.arange(50) + 0.5) * SATURATED.length / 50
    pile = bcre_ca.Pile(*SATURATED.layers(x, 0.0))
    rule = bcre_ca.Rule(0.8, 0.0, 1e14, 0.3, SATURATED.length / 50, 1.0, v_up=1.1)
    bound = layers.thick_step(pile, rule)
    assert layers.thick_step(pile, replace(rule, scheme="limited")) <= bound
    end = bcre_ca.advance(pile, replace(rule, dt=bound), 200, "periodic")
    assert end.R.min() > 0
    assert bound > 1e10 * bcre_ca.largest_stable_step(pile, rule, "periodic")


def test_limited_order_with_curvature_is_two_where_v_dt_over_d_is_small_on_every_grid():
    """That of the study, on Sc = 0 so that the many small steps leave less rounding."""
    studied = layers.solutions()["surface mode, kappa = 0.1"].material
    solution = exact.surface_mode(0.5, studied.gamma, studied.kappa, studied.v, Sc=0.0)
    m, cells = solution.material, (100, 200, 400)

    def error(n, share):
        d = solution.length / n
        x = (np.arange(n) + 0.5) * d
        if share is not None:
            return layers.errors(solution, *layers.automaton_layer(solution, n, share, "limited"))
        steps = int(np.ceil(solution.until / (0.01 * d**2 / m.kappa)))
        dt = solution.until / steps
        rule = bcre_ca.Rule(m.v, 0, m.gamma, m.Sc, d, dt, scheme="limited", kappa=m.kappa)
        assert m.v * dt / d < 0.02
        _, R = bcre_ca.evolve(*solution.layers(x, 0.0), rule, steps, "periodic")
        return layers.errors(solution, x, R)

    def order(share):
        found = np.array([error(n, share)["L1"] for n in cells])
        return observed.observed_order(np.array(cells, float), found, 0.0)

    assert order(None) > 1.8
    assert order(0.5) < 1.7


def test_pde_with_a_wrong_coefficient_does_not_converge(fit):
    row = fit(with_wrong(SOLUTIONS["rolling"], "v", 1.01), "pde", "runge-kutta")
    assert abs(row["order_L1"]) < 0.5
    assert row["L1_on_finest"] > EXPECTED["pde"].error


def test_errors_are_those_in_the_window_at_the_end():
    solution = SOLUTIONS["release"]
    x = np.linspace(0.5, 59.5, 60)
    expected = solution.layers(x, solution.until)[1]
    inside = (x >= solution.window[0]) & (x <= solution.window[1])
    off = np.where(inside, 3e-101, 1.0)
    found = layers.errors(solution, x, expected + off)
    assert found == pytest.approx({"L1": 3e-101, "L2": 3e-101, "max": 3e-101}, rel=1e-9, abs=0)


@pytest.mark.parametrize("order", [0.7, 1.0, 5.0])
def test_observed_order_of_a_power_law_is_its_exponent(order):
    cells = np.array([25.0, 50, 100, 200, 400])
    assert observed.observed_order(cells, 3 * cells**-order, 0.0) == pytest.approx(order, rel=1e-12)


def test_observed_order_is_fitted_to_the_three_finest_grids_above_the_floor():
    cells = np.array([10.0, 30, 50, 120, 200])
    error = np.array([1e-2, *cells[1:4] ** -4.0, 1e-12])
    assert observed.observed_order(cells, error, 1e-11) == pytest.approx(4, rel=1e-12)
    assert observed.observed_order(cells, error, 0.0) > 8
    assert np.isnan(observed.observed_order(cells, error, 1e-3))


def test_order_that_is_no_number_is_not_agreement():
    rows = pd.DataFrame({"cells": [10, 20, 40], "L1": 1e-9, "L2": 1e-9, "max": 1e-9, "floor": 1e-8})
    row = observed.fit({"solution": "a", "model": "pde", "scheme": "b"}, rows)
    assert np.isnan(row["order_L1"])
    assert row["verdict"] == Verdict.DISAGREE


@pytest.mark.parametrize("model", ["ca", "pde"])
def test_past_the_breaking_time_the_order_is_about_one_or_below(monkeypatch, model):
    monkeypatch.setattr(observed, "BROKEN_GRIDS", (50, 100, 200, 400))
    rows = observed.past_breaking(model)
    assert [row["t_over_t_star"] for row in rows] == [1.1, 1.5, 2.0]
    for row in rows:
        assert row["order"] <= 1.4
        assert row["change_on_finest"] > 1e-5


def test_before_the_breaking_time_the_same_differences_fall_at_the_formal_order():
    solution = SOLUTIONS["climbing"]
    x, grids = np.linspace(0.5, 13.5, 300), (50, 100, 200, 400)
    profiles = [layers.pde_layer(solution, cells, "runge-kutta") for cells in grids]
    exact_R = solution.layers(x, solution.until)[1]
    errors = [layers.errors(solution, *profile)["L1"] for profile in profiles]
    assert observed.observed_order(np.array(grids, float), np.array(errors), 0.0) >= 4
    assert np.ptp(exact_R) > 0.15


def test_verdicts_of_the_claims_turn_with_one_bad_row():
    agree, disagree = Verdict.AGREE, Verdict.DISAGREE

    def claims(order, error, broken):
        rows = [
            observed.fit(
                {"solution": "a", "model": model, "scheme": "b"},
                pd.DataFrame(
                    {
                        "cells": [100, 200, 400],
                        **{
                            norm: error * np.array([4.0**p, 2.0**p, 1.0])
                            for norm in ("L1", "L2", "max")
                        },
                        "floor": 0.0,
                    }
                ),
            )
            for model, p in (("ca", order), ("pde", 5.0))
        ]
        rows += [
            {**rows[0], "scheme": f"{scheme}, 0.5", "verdict": "agree", "order_L1": 2.0}
            for scheme in ("calibrated", "limited")
        ]
        past = {
            "model": "ca",
            "t_over_t_star": [1.1],
            "order": [broken],
            "largest_at_x": [1.0],
        }
        further = {
            "solution": ["c"],
            "model": "ca",
            "cells": 8,
            "order": 1.0,
            "error": 1e-5,
            "verdict": "agree",
        }
        tables = {
            "comparison": pd.DataFrame(rows),
            "past_breaking": pd.DataFrame(past),
            "further_models": pd.DataFrame(further),
        }
        found = [claim.verdict for claim in study.judge(tables)]
        assert found[2:4] == [agree, agree]
        return [*found[:2], found[4]]

    assert claims(1.0, 1e-5, 0.9) == [agree, agree, agree]
    assert claims(0.8, 1e-5, 0.9) == [disagree, agree, agree]
    assert claims(1.2, 1e-5, 0.9) == [disagree, agree, agree]
    assert claims(1.0, 1e-3, 0.9) == [agree, disagree, agree]
    assert claims(1.0, 0.02, 0.9) == [disagree, disagree, agree]
    assert claims(1.0, 1e-5, 1.5) == [agree, agree, disagree]


def test_claim_of_a_scheme_turns_with_one_bad_row_and_names_it():
    def row(scheme, order, error):
        rows = pd.DataFrame({"cells": [100, 200, 400], "floor": 0.0})
        for norm in ("L1", "L2", "max"):
            rows[norm] = error * np.array([4.0**order, 2.0**order, 1.0])
        named = observed.named(scheme, 0.5)
        return observed.fit({"solution": "a", "model": "ca", "scheme": named}, rows)

    def verdicts(calibrated, limited):
        table = pd.DataFrame([row("calibrated", *calibrated), row("limited", *limited)])
        return [
            order_of(s, table[table["scheme"].str.startswith(s)]).verdict
            for s in ("calibrated", "limited")
        ]

    agree, disagree = Verdict.AGREE, Verdict.DISAGREE
    assert verdicts((1.0, 1e-4), (2.0, 1e-4)) == [agree, agree]
    assert verdicts((2.5, 1e-4), (2.0, 1e-4)) == [agree, agree]
    assert verdicts((0.8, 1e-4), (1.7, 1e-4)) == [disagree, disagree]
    assert verdicts((1.0, 0.02), (2.3, 1e-4)) == [disagree, disagree]
    off = order_of("limited", pd.DataFrame([row("limited", 1.7, 1e-4)]))
    assert "a: 1.7" in off.evidence


def further(solution, model):
    """The number of a case of the further models."""
    cases = further_models.CASES
    return next(i for i, case in enumerate(cases) if case[:2] == (solution, model))


@pytest.mark.parametrize(
    ("solution", "model"),
    [
        ("exponential slope", "pde"),
        ("Cole-Hopf wave", "ca"),
        ("half heap", "quasi-static"),
        ("undermining", "quasi-static"),
    ],
)
def test_further_model_converges_to_its_own_exact_solution(solution, model):
    assert further_models.observed(further(solution, model))["verdict"] == "agree"


@pytest.mark.parametrize("spoilt", [lambda e: 0 * e + 1e-4, lambda e: 100 * e])
def test_further_model_that_stalls_or_is_far_off_does_not_agree(monkeypatch, spoilt):
    number = further("Cole-Hopf wave", "ca")
    case = further_models.CASES[number]
    cases = list(further_models.CASES)
    cases[number] = case._replace(error=lambda cells: spoilt(case.error(cells)))
    monkeypatch.setattr(further_models, "CASES", tuple(cases))
    assert further_models.observed(number)["verdict"] == "disagree"


def test_rule_of_another_speed_misses_the_cole_hopf_wave(monkeypatch):
    march = further_models.upwind_height.march
    monkeypatch.setattr(
        further_models.upwind_height, "march", lambda w, lam, *rest: march(w, 1.02 * lam, *rest)
    )
    number = further("Cole-Hopf wave", "ca")
    assert further_models.observed(number)["verdict"] == "disagree"
