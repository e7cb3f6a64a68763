"""Observables are what was put in, and a change is measured against its own scale."""

import math

import numpy as np
import pytest

from bcre_studies.models.run import Run
from bcre_studies.observables import named as o
from bcre_studies.scenes.scene import load

OPEN, CLOSED = load("figure3"), load("rough_slope")
L, SC = 100.0, 0.5


def centres(cells=100):
    return (np.arange(cells) + 0.5) * L / cells


def record(h, R=None, x=None, scene=OPEN):
    x = centres() if x is None else x
    h = np.atleast_2d(h)
    R = np.zeros_like(h) if R is None else np.atleast_2d(R)
    t = np.arange(len(h), dtype=float)
    return Run(scene, x, t, h, R, 0 * t, 0, 0)


def start(x):
    return OPEN.initial(x)


def test_scenes_with_joined_ends_pose_no_front_no_reach_and_no_top():
    assert o.posed(OPEN) == o.NAMES
    assert o.posed(CLOSED) == ("slope", "roughness", "eroded", "R")


def test_slope_and_roughness_are_those_of_a_wave_on_an_incline():
    x = centres(400)
    wave = 0.3 * np.sin(2 * np.pi * x / 5)
    found = record(0.7 * (L - x) + wave, x=x)
    assert o.slope(found) == pytest.approx(0.7, abs=2e-3)
    assert o.roughness(found) == pytest.approx(0.3 / math.sqrt(2), rel=1e-2)


@pytest.mark.parametrize("cells", [100, 400])
def test_front_is_the_downhill_edge_of_the_layer_at_every_time(cells):
    x = centres(cells)
    R = [np.clip(1 - np.abs(x - at) / 10, 0, 1) for at in (30, 40, 55)]
    assert o.front(record(0 * np.array(R), R, x)) == pytest.approx([49, 64], abs=0.05)


def test_front_of_what_has_left_or_is_spent_is_the_foot():
    x = centres()
    R = [np.exp(-(((x - 50) / 5) ** 2)), np.where(x > 95, 1.0, 0), 1e-9 * (x < 20)]
    assert list(o.front(record(0 * np.array(R), R))) == [L, L]


def test_eroded_is_the_area_taken_and_not_the_area_laid_down():
    x = centres()
    h, _ = start(x)
    moved = np.where(x < 10, -0.2, np.where(x > 90, 0.5, 0.0))
    found = record([h, h + moved])
    assert o.eroded(found) == pytest.approx(2.0)
    assert o.scale("eroded", found) == pytest.approx(7.0)


@pytest.mark.parametrize("cells", [100, 200])
def test_reach_is_counted_uphill_from_the_centre_of_what_was_released(cells):
    x = centres(cells)
    h, _ = start(x)
    change = np.where(x > 20, 1.0, 0.0)
    assert o.reach(record([h, h + change], x=x)) == pytest.approx(50 - 20, abs=L / cells)
    assert o.reach(record([h, h + 1], x=x)) == pytest.approx(50)
    assert o.reach(record([h, h + 1e-9], x=x)) == 0


def test_top_is_reached_when_its_height_is_lost_and_not_by_rounding():
    x = centres()
    steep = 3.0 * (L - x)
    assert o.top(record([steep, SC * (L - x)])) == 1
    assert o.top(record([steep, steep])) == 0
    level = SC * (L - x)
    assert o.top(record([level * (1 + 1e-15), level - 1e-3])) == 0


def test_change_is_relative_to_the_scale_of_each_observable():
    x = centres()
    h, R = start(x)
    full = record([h, h - 0.01 * (x < 50)], [R, R])
    other = record([h, h - 0.01 * (x < 50) - 0.1 * SC * x], [R, 1.1 * R])
    assert o.change("slope", full, other) == pytest.approx(0.1, rel=1e-9)
    assert o.change("R", full, other) == pytest.approx(0.05, rel=1e-9)
    assert o.change("top", full, other) == 0
    for name in o.NAMES:
        assert o.change(name, full, full) == 0
        assert o.scale(name, full) > 0


def test_layers_are_compared_on_the_cells_of_the_coarser_grid():
    fine = np.linspace(0, 2, 200)
    coarse = fine.reshape(50, 4).mean(axis=1)
    h = np.zeros((1, 200))
    a = record(h, fine, centres(200))
    b = record(h[:, :50], coarse, centres(50))
    assert o.change("R", a, b) == pytest.approx(0, abs=1e-14)
    assert o.change("R", a, record(h[:, :50], 1.2 * coarse, centres(50))) == pytest.approx(0.2)
    assert o.change("R", a, record(h[:, :30], np.ones(30), centres(30))) == pytest.approx(
        0.5, rel=0.02
    )


def test_a_model_without_a_rolling_layer_gives_neither_R_nor_front():
    x = centres()
    h, R = start(x)
    full = record([h, h], [R, R])
    alone = record([h, h], [0 * h, 0 * h])
    assert o.change("R", full, alone) == 1
    assert o.change("front", full, alone) == 1
    assert o.change("slope", full, alone) == 0
