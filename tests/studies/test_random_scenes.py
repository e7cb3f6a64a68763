"""Scenes drawn at random: the same for ever, allowed, and of every kind."""

import numpy as np

from bcre_studies.performance.random_scenes import random_scene
from bcre_studies.scenes.scene import Scene

FIRST = {"v": 0.1424, "length": 108.6}
MANY = [random_scene(index) for index in range(100)]


def test_a_number_names_the_same_scene_for_ever():
    assert random_scene(7) == MANY[7]
    assert MANY[0].material.v == FIRST["v"]
    assert MANY[0].domain.length == FIRST["length"]


def test_no_two_are_the_same():
    assert len({scene.model_dump_json() for scene in MANY}) == len(MANY)


def test_they_are_of_every_kind():
    periodic = [scene for scene in MANY if scene.domain.ends == "periodic"]
    pulses = [scene for scene in MANY if scene.domain.ends == "open"]
    above = [scene for scene in pulses if scene.surface[0].slope > scene.material.Sc]
    rough = [scene for scene in pulses if len(scene.surface) == 2]
    curved = [scene for scene in MANY if scene.material.kappa > 0]
    assert 10 <= len(periodic) <= 30
    assert 0.5 < len(above) / len(pulses) < 0.9
    assert 0.1 < len(rough) / len(pulses) < 0.4
    assert 20 <= len(curved) <= 50


def test_the_layer_drifts_through_less_than_the_domain_and_grows_by_a_bounded_factor():
    for scene in MANY:
        m, length, until = scene.material, scene.domain.length, scene.time.until
        assert m.v * until / length * (1 + 1e-3) >= 0.1
        assert m.v * until / length <= 0.8 * (1 + 1e-3)
        assert -2.01 <= m.gamma * (scene.surface[0].slope - m.Sc) * until <= 6.01


def test_the_start_is_finite_and_the_layer_lies_inside():
    for scene in MANY:
        h, R = scene.initial(scene.centres(400))
        assert np.isfinite(h).all()
        assert R.min() >= 0
        assert R.max() > 0
        assert isinstance(scene, Scene)
