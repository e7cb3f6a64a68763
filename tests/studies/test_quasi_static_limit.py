"""The quasi-static limit of a heap: both small numbers, their rates and signs, and the rule."""

import numpy as np
import pandas as pd
import pytest

from bcre_studies.models.registry import AUTOMATON, BCRE, QUASI_STATIC
from bcre_studies.observables.rolling_share import smallness, surface_error
from bcre_studies.scenes.scene import load
from bcre_studies.validation.quasi_static_limit import heaps, rates


def test_numbers_of_a_heap_are_those_it_was_made_with():
    scene = heaps.heap(0.02, 0.03)
    run = AUTOMATON.run(scene, [0.0, scene.time.until])
    assert smallness(run) == pytest.approx((0.02, 0.03), rel=0.1)
    assert smallness(QUASI_STATIC.run(scene, [0.0, scene.time.until]))[1] == 0.0


def test_heap_of_the_limit_has_the_height_and_length_it_was_made_with():
    scene = heaps.heap(0.02, 0.03, length=30.0, Sc=0.7, rate=2.0)
    run = QUASI_STATIC.run(scene, [0.0, scene.time.until])
    exact = np.maximum(0.7 * (30.0 - run.x), 0.0)
    assert run.h[-1] == pytest.approx(exact, abs=0.2 * 0.7 * run.d)


def test_automaton_on_its_own_cells_becomes_the_isotonic_step():
    errors = []
    for small in (4e-3, 2e-3, 1e-3):
        scene = heaps.heap(small, small)
        times = [0.0, scene.time.until]
        run, limit = AUTOMATON.run(scene, times), QUASI_STATIC.run(scene, times)
        errors.append(heaps.measured(run, limit)["error"])
    assert errors[0] / errors[1] == pytest.approx(2, rel=0.15)
    assert errors[1] / errors[2] == pytest.approx(2, rel=0.15)
    assert errors[2] < 3e-3


@pytest.mark.parametrize("name", [AUTOMATON.name, BCRE.name])
def test_slope_and_sand_at_rest_differ_from_the_limit_as_derived(name):
    row = heaps.on_map((name, 0.02, 0.04))
    assert row["slope"] == pytest.approx(0.02 * rates.EXPECTED["slope", "eps"], rel=0.05)
    assert row["at rest"] == pytest.approx(-0.04, rel=0.05)
    assert row["reach"] == pytest.approx(1.5 * 0.02 - 0.04 / 2, abs=2e-3)


def made_up(value):
    """A map on which every quantity is a function of the two numbers."""
    rows = [
        {"model": "ca", "eps": eps, "tau": tau} | dict.fromkeys(heaps.QUANTITIES, value(eps, tau))
        for eps in heaps.EPS
        for tau in heaps.TAU
    ]
    return pd.DataFrame(rows)


@pytest.mark.parametrize(("power", "order"), [(1, 1.0), (2, 2.0)])
def test_order_is_found_beneath_what_the_other_number_adds(power, order):
    table = made_up(lambda eps, tau: 3 * eps**power - 5 * tau**power)
    for row in rates.rates(table):
        assert row["order"] == pytest.approx(order, abs=1e-2)
        if power == 1:
            assert row["coefficient"] == pytest.approx({"eps": 3, "tau": -5}[row["number"]])


def test_coefficient_is_free_of_the_second_order_and_the_limit_of_the_first():
    table = made_up(lambda eps, tau: 0.25 + 3 * eps - 5 * tau + 2 * eps * tau + 4 * eps**2)
    found = next(row for row in rates.rates(table) if row["number"] == "eps")
    assert found["coefficient"] == pytest.approx(3 + 2 * min(heaps.TAU), rel=5e-3)
    left = rates.extrapolated(table, "slope")
    assert left == pytest.approx(0.25 - 8 * min(heaps.EPS) ** 2, rel=1e-9)


def test_surface_error_is_that_of_the_worst_frame_and_figure_1_is_outside_though_its_end_is_not():
    """After figure 1 both stand at repose: only what happens meanwhile tells them apart."""
    scene = load("figure1").with_changes(until=2000.0)
    times = [0.0, 200.0, 2000.0]
    run, limit = AUTOMATON.run(scene, times), QUASI_STATIC.run(scene, times)
    end = np.mean(np.abs(limit.h[-1] - run.h[-1])) / np.mean(np.abs(run.h[-1] - run.h[0]))
    assert end < 1.5 * run.d / 100  # the foot of the limit is an edge of cells
    assert surface_error(limit, run) > 0.4
    assert surface_error(run, run) == 0.0
