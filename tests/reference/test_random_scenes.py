"""A part of the random scenes, small ones of a few forms; ``random_scenes.py`` runs them all."""

import pytest

from drawn_scenes import draw
from judged import CHECKS, judge

FORMS = (
    {"scheme": "upwind", "exchange": "linear", "ends": "open", "dry": "none"},
    {"scheme": "upwind", "exchange": "saturated", "ends": "periodic", "dry": "some"},
    {"scheme": "calibrated", "exchange": "linear", "ends": "open", "dry": "none"},
    {"scheme": "limited", "exchange": "linear", "ends": "periodic", "dry": "none"},
)
"""What decides on the automaton's kernels, which take seconds to compile."""

ALWAYS = {"D": "some", "v": "some", "gamma": "some", "solver": "given"}


def scene(index):
    form = FORMS[index % len(FORMS)]
    kappa = "some" if form["scheme"] == "limited" else "none"
    return draw(index, **form, **ALWAYS, kappa=kappa)


@pytest.mark.parametrize("index", range(8))
def test_scene_holds_against_the_plain_integrations(index, tmp_path):
    found = judge(scene(index), tmp_path)
    assert found
    assert set(found) <= set(CHECKS)
    assert not {name: number for name, number in found.items() if not number.holds}
