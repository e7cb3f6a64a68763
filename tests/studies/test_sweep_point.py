"""A point's row holds what the models say of its scene, and how sure that is."""

import math
import re

import numpy as np
import pytest

from bcre_studies.comparison.compare import compare
from bcre_studies.models.registry import AUTOMATON
from bcre_studies.observables import named
from bcre_studies.scenes.scene import load
from bcre_studies.sweeps.point import MeasurePoint
from bcre_studies.sweeps.spec import load_spec

SPEC = """
title = "Slope against pulse"
scene = "figure2"
models = ["pde effective", "ca", "pde"]
observables = ["R", "slope", "front"]
frames = 2
set = { "time.until" = 5.0 }
[[axis]]
key = "rolling.0.amplitude"
values = [1.0]
"""


@pytest.fixture
def measure(tmp_path):
    def of(text):
        (tmp_path / "spec.toml").write_text(text)
        return MeasurePoint(load_spec(tmp_path / "spec.toml"))

    return of


def test_a_row_is_the_comparison_that_every_study_makes(measure):
    row = measure(SPEC)({"rolling.0.amplitude": 1.0})
    scene = load("figure2").with_changes(until=5.0)
    x, times = scene.centres(), [0.0, 5.0]
    R = compare(scene, times, lambda run: [run.sample(x, frame=i) for i in (0, 1)], 0.05)
    assert row["R_pde_difference"] == pytest.approx(R.difference, rel=1e-6)
    assert row["R_pde_effective_difference"] == pytest.approx(R.difference_effective, rel=1e-6)
    assert row["R_verdict"] == R.verdict
    assert row["R_pde"] == pytest.approx(np.mean(R.pde.value), rel=1e-6)
    assert 0 < row["R_pde_error"] < 0.1 * row["R_pde_difference"] * row["R_pde"]
    automaton = AUTOMATON.run(scene, times)
    assert row["slope_automaton"] == named.slope(automaton)
    assert row["front_automaton"] == named.front(automaton)[-1]
    assert "R_automaton_error" not in row


def test_every_column_that_is_announced_is_filled_and_no_other(measure):
    of_all = measure(SPEC)
    row = of_all({"rolling.0.amplitude": 1.0})
    assert set(row) == set(of_all.columns())
    assert all(isinstance(row[name], kind) for name, kind in of_all.columns().items())
    assert all(math.isfinite(value) for value in row.values() if isinstance(value, float))


@pytest.mark.parametrize(
    ("changed", "told"),
    [
        ({"time.step": 5.0}, "dt = 5 cannot be stable"),
        ({"until": 1e10}, "would take 5e+10 steps of the automaton"),
        ({"rolling.0.width": -1.0}, "rolling.0.width = -1.0"),
    ],
)
def test_a_scene_that_cannot_be_run_says_why(measure, changed, told):
    of_all = measure(SPEC.replace('"pde effective", "ca", "pde"', '"ca"'))
    with pytest.raises(ValueError, match=re.escape(told)):
        of_all(changed)
