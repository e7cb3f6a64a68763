"""Every built-in scene on a plane accounts for its sand to rounding."""

import pytest

from bcre_studies.models.plane import automaton
from bcre_studies.scenes.listing import plane_names
from bcre_studies.scenes.plane.scene import load

PART = 0.1
"""Of each scene's time."""


@pytest.mark.parametrize("name", plane_names())
def test_sand_of_every_scene_is_kept_poured_or_has_left_through_the_foot(name):
    until = PART * load(name).time.until
    run = automaton.run(load(name, [f"until={until!r}"]), [0.0, until / 2, until], threads=1)
    assert run.mass_error() <= 1e-12
    assert run.R.min() >= 0
    assert run.R[-1].max() > 0
