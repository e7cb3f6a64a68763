"""Both models do not know the unit of height: the same scene, times a."""

import numpy as np
import pytest

from bcre_studies.models.registry import AUTOMATON, BCRE
from bcre_studies.scenes.rescale import rescaled
from bcre_studies.scenes.scene import load


@pytest.mark.parametrize("a", [1 / 16, 8.0])
@pytest.mark.parametrize("scheme", ["upwind", "calibrated", "limited"])
@pytest.mark.parametrize("name", ["figure1", "figure3", "rough_slope"])
def test_the_automaton_rescaled_by_a_power_of_two_is_the_same_to_the_bit(name, scheme, a):
    scene = load(name).with_changes(scheme=scheme, step="auto", kappa=0.003)
    times = [0.0, scene.time.until / 2]
    own, other = AUTOMATON.run(scene, times), AUTOMATON.run(rescaled(scene, a), times)
    assert np.array_equal(other.R, a * own.R)
    assert np.array_equal(other.h, a * own.h)
    assert other.steps == own.steps


@pytest.mark.parametrize("name", ["figure1", "rough_slope"])
def test_bcre_rescaled_is_the_same(name):
    scene = load(name).with_changes(kappa=0.005, until=100.0)
    own, other = (BCRE.run(each, [100.0], 100) for each in (scene, rescaled(scene, 0.0625)))
    assert pytest.approx(0.0625 * own.R, rel=1e-6, abs=1e-9 * own.R.max()) == other.R
    assert other.u == pytest.approx(0.0625 * own.u, rel=1e-6, abs=1e-9 * np.abs(own.u).max())


def test_figure_1_at_slopes_that_sand_has_is_figure_1():
    """Rescaled by 1/16, and tilted to Sc = 0.6 (31 degrees), which neither model feels."""
    figure1, sand = load("figure1"), load("figure1_sand")
    twin = rescaled(figure1, 1 / 16)
    assert sand.material.gamma == twin.material.gamma
    (steep,), (slope,) = twin.surface, sand.surface
    assert slope.slope - sand.material.Sc == pytest.approx(steep.slope - twin.material.Sc)
    assert np.degrees(np.arctan([sand.material.Sc, slope.slope])) == pytest.approx(
        [31, 38.7], abs=0.1
    )
    times = [0.0, 200.0, 400.0]
    own, other = AUTOMATON.run(figure1, times), AUTOMATON.run(sand, times)
    assert pytest.approx(own.R, rel=1e-6, abs=1e-9) == 16 * other.R
    fallen, twice = (run.u - run.u[0] for run in (own, other))
    assert 16 * twice == pytest.approx(fallen, rel=1e-6, abs=1e-6)


@pytest.mark.parametrize(
    ("name", "a", "what"), [("climbing_wave", 0.5, "table"), ("figure1", 0, "a = 0")]
)
def test_what_cannot_be_rescaled_is_refused_by_name(name, a, what):
    with pytest.raises(ValueError, match=what):
        rescaled(load(name), a)
