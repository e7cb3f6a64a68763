"""Scenes on a plane: what they describe, and what is refused in one line."""

import math

import numpy as np
import pytest

from bcre_studies.scenes import scene as line
from bcre_studies.scenes.listing import built_in_names, plane_names
from bcre_studies.scenes.plane.scene import load
from bcre_studies.scenes.refusal import SceneError

SCENE = """
title = "A pulse"
[material]
v = 0.5
D = 0.1
gamma = 0.05
Sc = 0.5
[domain]
length = 12.0
cells = 24
width = 8.0
[time]
until = 2.0
"""


def scene(folder, text="", *overrides):
    path = folder / "scene.toml"
    path.write_text(SCENE + text)
    return load(path, overrides)


def test_six_built_in_scenes_lie_on_a_plane_and_none_of_them_on_a_line():
    names = plane_names()
    assert {"triangular_avalanche", "uphill_avalanche", "pouring_a_heap"} < set(names)
    assert {"collapsing_cone", "obstacle", "terrain"} < set(names)
    assert not set(names) & set(built_in_names())


@pytest.mark.parametrize("name", plane_names())
def test_built_in_scene_has_finite_layers_and_no_sand_rolls_in_a_wall(name):
    built_in = load(name)
    h, R = built_in.initial()
    assert h.shape == R.shape == built_in.domain.shape
    assert np.isfinite(h).all()
    assert (R >= 0).all()
    assert (R[built_in.walls()] == 0).all()


@pytest.mark.parametrize("name", plane_names())
def test_command_for_lines_says_where_planes_are_taken(name):
    with pytest.raises(
        SceneError, match=f"^{name}: is a scene on a plane, for bcre run, show and play"
    ):
        line.load(name)


def test_cells_across_follow_from_the_width(tmp_path):
    assert scene(tmp_path).domain.shape == (24, 16)
    assert scene(tmp_path, "", "width=5.0").domain.shape == (24, 10)


def test_incline_falls_downhill_to_zero_at_the_foot_and_a_cone_to_its_rim(tmp_path):
    terms = """
[[surface]]
kind = "incline"
slope = 0.5
[[surface]]
kind = "cone"
centre = [6.0, 4.0]
slope = 2.0
radius = 3.0
"""
    h, _ = scene(tmp_path, terms).initial()
    at = scene(tmp_path).domain.centres()
    r = np.hypot(at.x - 6.0, at.y - 4.0)
    assert h == pytest.approx(0.5 * (12.0 - at.x) + np.maximum(2.0 * (3.0 - r), 0), rel=1e-14)


def test_noise_has_its_root_mean_square_and_is_the_same_on_every_grid(tmp_path):
    noise = '[[surface]]\nkind = "noise"\namplitude = 0.3\nseed = 4\n'
    coarse, _ = scene(tmp_path, noise, "cells=48").initial()
    fine, _ = scene(tmp_path, noise, "cells=144").initial()
    assert math.sqrt(np.mean(fine**2)) == pytest.approx(0.3, rel=1e-9)
    assert fine[1::3, 1::3] == pytest.approx(coarse, abs=1e-12)
    other, _ = scene(tmp_path, noise, "cells=48", "surface.0.seed=5").initial()
    assert np.abs(other - coarse).max() > 0.1


def test_pulse_is_round_and_its_nearest_image_counts_where_sides_are_joined(tmp_path):
    pulse = '[[rolling]]\nkind = "gaussian"\namplitude = 2.0\ncentre = [6.0, 0.0]\nwidth = 1.5\n'
    at = scene(tmp_path).domain.centres()
    _, R = scene(tmp_path, pulse, 'sides="periodic"').initial()
    across = np.minimum(at.y, 8.0 - at.y)
    expected = 2 * np.exp(-((at.x - 6.0) ** 2 + across**2) / 1.5**2)
    assert np.abs(R - expected).max() < 1e-14
    _, alone = scene(tmp_path, pulse).initial()
    assert alone[12, -1] < 1e-10 < R[12, -1]


def test_walls_are_discs_and_boxes(tmp_path):
    walls = """
[[wall]]
kind = "disc"
centre = [3.0, 4.0]
width = 2.0
[[wall]]
kind = "box"
corners = [[9.0, 6.0], [8.0, 2.0]]
[[rolling]]
kind = "uniform"
amplitude = 1.0
"""
    built = scene(tmp_path, walls)
    at, covered = built.domain.centres(), built.walls()
    disc = np.hypot(at.x - 3.0, at.y - 4.0) <= 1.0
    box = (at.x >= 8.0) & (at.x <= 9.0) & (at.y >= 2.0) & (at.y <= 6.0)
    assert np.array_equal(covered, disc | box)
    assert np.array_equal(built.initial()[1], np.where(covered, 0.0, 1.0))


def test_changed_scene_keeps_its_other_values(tmp_path):
    changed = scene(tmp_path, "[base]\nthickness = 0.2\n").with_changes(v=0.7, thickness=0.4)
    assert (changed.material.v, changed.base.thickness, changed.material.D) == (0.7, 0.4, 0.1)


@pytest.mark.parametrize(
    ("override", "message"),
    [
        (
            "width=7.9",
            r"^domain.width = 7.9: must be that of domain.cells_across = 16 square cells",
        ),
        ("cells=1000000000", r"^domain.cells = 1000000000: must be less than or equal to"),
        ("cells_across=99999999", r"^domain.width = 8.0: must be that of domain.cells_across"),
        ("cells=1", r"^domain.cells = 1: must be greater than or equal to 2"),
        ("width=1e30", r"^domain.cells_across = 200000000: must be less than"),
        ("width=nan", r"^domain.width = nan: must be"),
        ('flow="d9"', r"^automaton.flow = 'd9': must be 'tilted', 'split4', 'facet8' or 'd8'"),
        ('ends="shut"', r"^domain.ends = 'shut': must be 'open', 'closed' or 'periodic'"),
        ("thickness=-1.0", r"^base.thickness = -1.0: must be greater than 0"),
        ("kappa=0.1", r"^kappa = 0.1: no such key; allowed are v, D"),
        ("rolling.0.centre=[1.0]", r"^rolling.0.centre.1: missing"),
        (
            "rolling.0.kind='cone'",
            r"^rolling.0.kind = 'cone': must be one of 'gaussian', 'uniform'",
        ),
        ("wall.0.kind='ring'", r"^wall.0.kind = 'ring': must be one of 'disc', 'box'"),
        ("source.0.until=0.5", r"^source.until = 0.5: must be at least source.from = 1.0"),
        ("source.0.rate=-1.0", r"^source.0.rate = -1.0: must be greater than or equal to 0"),
        ('ends="periodic"', r"^surface: the inclines add up to 0; with periodic ends"),
    ],
)
def test_bad_value_is_refused_with_its_key_and_what_is_allowed(tmp_path, override, message):
    text = """
[[rolling]]
kind = "gaussian"
amplitude = 1.0
centre = [6.0, 4.0]
width = 1.0
[[wall]]
kind = "disc"
centre = [3.0, 4.0]
width = 2.0
[[source]]
rate = 1.0
place = [6.0, 4.0]
width = 1.0
from = 1.0
"""
    with pytest.raises(SceneError, match=message) as refused:
        scene(tmp_path, text, override)
    assert "\n" not in str(refused.value)
