"""Observed orders on exact solutions of no file, and that one per cent turns them red."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bcre_pde import exact
from bcre_studies import order_of_accuracy as study
from bcre_studies.claim import Verdict

SOLUTIONS = {
    "climbing": exact.climbing_hump(
        v=0.7, gamma=0.8, height=0.2, width=1.1, length=14.0, until=1.5, Sc=0.3
    ),
    "release": exact.frozen_slope_release(excess=0.9, v=0.8, D=0.4, gamma=0.15),
    "rolling": exact.rolling_mode(wavenumber=0.8, v=0.6, D=0.2, Sc=0.7),
}
SCHEMES = [("ca", 0.25), ("ca", 0.5), ("ca", 0.9), ("pde", "runge-kutta"), ("pde", "DOP853")]


@pytest.fixture
def fit(monkeypatch):
    """The study's own fit of order and error, for any solution; without the slowest grids."""
    finer = {"ca": study.GRIDS["ca"], "pde": study.GRIDS["pde"][:-1]}
    coarser = {model: grids[:4] for model, grids in finer.items()}

    def fit(solution, model, scheme):
        monkeypatch.setattr(study, "solutions", lambda: {"this": solution})
        monkeypatch.setattr(study, "GRIDS", coarser if solution.material.D > 0 else finer)
        rows = pd.DataFrame(study._errors_of(("this", model, scheme)))
        key = {"solution": "this", "model": model, "scheme": str(scheme)}
        return study._fit(key, rows)

    return fit


def with_wrong(solution, name, factor):
    """The solution, of which the models are told a wrong coefficient."""
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
@pytest.mark.parametrize(("model", "scheme"), [("ca", 0.5), ("pde", "runge-kutta")])
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


def test_pde_with_a_wrong_coefficient_does_not_converge(fit):
    row = fit(with_wrong(SOLUTIONS["rolling"], "v", 1.01), "pde", "runge-kutta")
    assert abs(row["order_L1"]) < 0.5
    assert row["L1_on_finest"] > study.LARGEST_ERROR["pde"]


def test_errors_are_those_in_the_window_at_the_end():
    solution = SOLUTIONS["release"]
    x = np.linspace(0.5, 59.5, 60)
    expected = solution.layers(x, solution.until)[1]
    inside = (x >= solution.window[0]) & (x <= solution.window[1])
    off = np.where(inside, 3e-101, 1.0)
    found = study.errors(solution, x, expected + off)
    assert found == pytest.approx({"L1": 3e-101, "L2": 3e-101, "max": 3e-101}, rel=1e-9, abs=0)


@pytest.mark.parametrize("order", [0.7, 1.0, 5.0])
def test_observed_order_of_a_power_law_is_its_exponent(order):
    cells = np.array([25.0, 50, 100, 200, 400])
    assert study.observed_order(cells, 3 * cells**-order, 0.0) == pytest.approx(order, rel=1e-12)


def test_observed_order_is_fitted_to_the_three_finest_grids_above_the_floor():
    cells = np.array([10.0, 30, 50, 120, 200])
    error = np.array([1e-2, *cells[1:4] ** -4.0, 1e-12])
    assert study.observed_order(cells, error, 1e-11) == pytest.approx(4, rel=1e-12)
    assert study.observed_order(cells, error, 0.0) > 8
    assert np.isnan(study.observed_order(cells, error, 1e-3))


def test_order_that_is_no_number_is_not_agreement():
    rows = pd.DataFrame({"cells": [10, 20, 40], "L1": 1e-9, "L2": 1e-9, "max": 1e-9, "floor": 1e-8})
    row = study._fit({"solution": "a", "model": "pde", "scheme": "b"}, rows)
    assert np.isnan(row["order_L1"])
    assert row["verdict"] == Verdict.DISAGREE


@pytest.mark.parametrize("model", ["ca", "pde"])
def test_past_the_breaking_time_the_order_is_about_one_or_below(monkeypatch, model):
    monkeypatch.setattr(study, "BROKEN_GRIDS", (50, 100, 200, 400))
    rows = study._past_breaking(model)
    assert [row["t_over_t_star"] for row in rows] == [1.1, 1.5, 2.0]
    for row in rows:
        assert row["order"] <= 1.4
        assert row["change_on_finest"] > 1e-5


def test_before_the_breaking_time_the_same_differences_fall_at_the_formal_order():
    solution = SOLUTIONS["climbing"]
    x, grids = np.linspace(0.5, 13.5, 300), (50, 100, 200, 400)
    profiles = [study.pde_layer(solution, cells, "runge-kutta") for cells in grids]
    exact_R = solution.layers(x, solution.until)[1]
    errors = [study.errors(solution, *profile)["L1"] for profile in profiles]
    assert study.observed_order(np.array(grids, float), np.array(errors), 0.0) >= 4
    assert np.ptp(exact_R) > 0.15


def test_verdicts_of_the_claims_turn_with_one_bad_row():
    def claims(order, error, broken):
        rows = [
            study._fit(
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
        past = {
            "model": "ca",
            "t_over_t_star": [1.1],
            "order": [broken],
            "largest_at_x": [1.0],
        }
        tables = {"comparison": pd.DataFrame(rows), "past_breaking": pd.DataFrame(past)}
        return [claim.verdict for claim in study.judge(tables)]

    agree, disagree = Verdict.AGREE, Verdict.DISAGREE
    assert claims(1.0, 1e-5, 0.9) == [agree, agree, agree]
    assert claims(0.8, 1e-5, 0.9) == [disagree, agree, agree]
    assert claims(1.2, 1e-5, 0.9) == [disagree, agree, agree]
    assert claims(1.0, 1e-3, 0.9) == [agree, disagree, agree]
    assert claims(1.0, 0.02, 0.9) == [disagree, disagree, agree]
    assert claims(1.0, 1e-5, 1.5) == [agree, agree, disagree]
