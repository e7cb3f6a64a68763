"""Which parameter moves which property: what drops out, and what the claims hang on."""

import numpy as np
import pandas as pd
import pytest
from scipy.stats import sobol_indices, uniform

from bcre_studies.comparison.verdict import Verdict
from bcre_studies.system.files import REPORTS
from bcre_studies.validation import sensitivity

POINT = {"v": 0.1, "D": 0.1, "gamma": 0.01, "Sc": 0.5, "S0": 3.5, "pulse": 1.0, "d": 1.0, "dt": 0.8}


def test_the_repose_slope_drops_out_where_the_slope_is_as_much_above_it():
    here = sensitivity.measure(**POINT)
    tilted = sensitivity.measure(**POINT | {"Sc": 0.3, "S0": 3.3})
    assert tilted == pytest.approx(here, abs=1e-6)


def test_figure_1_runs_to_the_top_and_a_gentler_slope_does_not():
    slope, _, reach, top = sensitivity.measure(**POINT)
    assert (abs(slope) < 0.01, reach > 80, top) == (True, True, 1.0)
    slope, _, reach, top = sensitivity.measure(**POINT | {"S0": 0.8})
    assert (abs(slope - 0.3) < 0.05, reach < 20, top) == (True, True, 0.0)


def test_every_parameter_is_passed_in_its_own_place():
    (row,) = sensitivity.measure_all([list(POINT.values())])
    assert list(POINT) == list(sensitivity.PARAMETERS)
    assert tuple(row) == sensitivity.measure(**POINT)


def test_a_parameter_without_any_part_gets_its_value_as_interval():
    indices = sobol_indices(
        func=lambda x: x[0], n=64, dists=[uniform(), uniform()], rng=np.random.default_rng(0)
    )
    value = float(indices.total_order[1])
    row = sensitivity._with_interval("total_order", value, float("nan"), float("nan"))
    assert row == {"total_order": 0.0, "total_order_low": 0.0, "total_order_high": 0.0}


@pytest.fixture(scope="module")
def table():
    return pd.read_csv(REPORTS / "sensitivity" / "comparison.csv")


def verdict(table, name):
    claims = {claim.name: claim for claim in sensitivity.judge({"comparison": table})}
    return claims[name].verdict


def changed(table, parameter, total, spread):
    table = table.copy()
    rows = table["parameter"] == parameter
    table.loc[rows, "total_order"] = total
    table.loc[rows, "total_order_low"] = total - spread
    table.loc[rows, "total_order_high"] = total + spread
    return table


@pytest.mark.parametrize(("parameter", "name"), [("d", "cell length"), ("dt", "time step")])
def test_a_numerical_parameter_matters_where_its_part_is_surely_more_than_a_twentieth(
    table, parameter, name
):
    assert verdict(changed(table, parameter, 0.2, 0.05), name) is Verdict.DISAGREE
    assert verdict(changed(table, parameter, 0.05, 0.03), name) is Verdict.UNRESOLVED
    assert verdict(changed(table, parameter, 0.01, 0.01), name) is Verdict.AGREE


def test_one_parameter_decides_where_it_moves_more_than_half_by_itself(table):
    name = "one parameter decides"
    assert verdict(table, name) is Verdict.DISAGREE
    alone = table.assign(
        first_order=np.where(table["parameter"] == "S0", 0.8, 0.0),
        first_order_low=np.where(table["parameter"] == "S0", 0.7, 0.0),
    )
    assert verdict(alone, name) is Verdict.AGREE


def test_first_order_parts_add_up_to_one_at_most_and_totals_to_one_at_least(table):
    sums = table.groupby("observable")[["first_order", "total_order"]].sum()
    assert (sums["first_order"] < 1.05).all()
    assert (sums["total_order"] > 0.95).all()
    assert set(table["observable"]) == set(sensitivity.OBSERVABLES)


def test_the_same_study_twice_gives_the_same_intervals_and_leaves_numpys_generator_alone(
    monkeypatch,
):
    def observables(points):
        return np.array([points[0], points[1] * points[7], points[4], points[5]])

    monkeypatch.setattr(sensitivity, "_observables", observables)
    monkeypatch.setattr(sensitivity, "SAMPLE", 16)
    before = np.random.get_state()[1].tolist()  # noqa: NPY002
    first, second = (sensitivity.run()["comparison"] for _ in range(2))
    pd.testing.assert_frame_equal(first, second)
    assert np.random.get_state()[1].tolist() == before  # noqa: NPY002
