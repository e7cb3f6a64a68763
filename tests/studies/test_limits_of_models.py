"""Each further model where its own term vanishes: BCRE's bits, or BCRE as the limit."""

import numpy as np
import pytest

from bcre_studies.comparison.difference import relative_difference
from bcre_studies.models.registry import (
    ARADIAN,
    AUTOMATON,
    BCRE,
    HADELER_KUTTLER,
    SLOPE_DRIVEN_AUTOMATON,
    THICK_AUTOMATON,
)
from bcre_studies.scenes.scene import load

UNTIL, CELLS = 4.0, 100


def layer(model, cells=CELLS, **changes):
    """R of figure 3 at t = 4, in equal steps of the automaton."""
    scene = load("figure3").with_changes(until=UNTIL, step=0.02, **changes)
    return model.run(scene, [0.0, UNTIL], cells).R[-1]


def apart(model, other, changes, of_other):
    return relative_difference(layer(model, **changes), layer(other, **of_other))


def falls_tenfold(gaps):
    assert gaps[0] > 1e-9
    assert gaps[0] / gaps[1] == pytest.approx(10, rel=0.15)


@pytest.mark.parametrize("model", [BCRE, AUTOMATON], ids=lambda model: model.name)
def test_layer_without_diffusion_is_the_limit_of_little_diffusion(model):
    falls_tenfold([apart(model, model, {"D": D}, {"D": 0.0}) for D in (1e-3, 1e-4)])


def test_automaton_without_diffusion_has_the_bits_of_one_whose_diffusion_does_nothing():
    assert np.array_equal(layer(AUTOMATON, D=0.0), layer(AUTOMATON, D=1e-300))


@pytest.mark.parametrize(
    ("thick", "thin"), [(ARADIAN, BCRE), (THICK_AUTOMATON, AUTOMATON)], ids=["pde", "ca"]
)
def test_thick_flow_tends_to_bcre_as_gamma_vanishes_and_as_its_climb_is_not_limited(thick, thin):
    endless = {"v_up": 1e300}
    falls_tenfold([apart(thick, thin, {"Gamma": Gamma} | endless, {}) for Gamma in (1e-2, 1e-3)])
    falls_tenfold([apart(thin, thin, {"v_up": limit}, {}) for limit in (10.0, 100.0)])
    assert np.array_equal(layer(thin, **endless), layer(thin))


FROZEN = {"D": 0.0, "surface.0.slope": 0.5}
"""On S = Sc nothing is exchanged, so that the slope stays as it is, and beta S = v."""


def test_slope_driven_rule_on_a_slope_at_repose_has_the_bits_of_the_papers():
    assert np.array_equal(layer(SLOPE_DRIVEN_AUTOMATON, **FROZEN), layer(AUTOMATON, **FROZEN))
    steeper = FROZEN | {"surface.0.slope": 0.51}
    assert not np.array_equal(layer(SLOPE_DRIVEN_AUTOMATON, **steeper), layer(AUTOMATON, **steeper))


def test_slope_driven_pde_on_a_slope_at_repose_tends_to_bcre_on_finer_grids():
    """It falls back to first order where a layer thins out, as a pulse does on both sides."""
    coarse, fine = (
        relative_difference(*(layer(model, cells, **FROZEN) for model in (HADELER_KUTTLER, BCRE)))
        for cells in (200, 400)
    )
    assert fine < 5e-4
    assert fine < coarse / 50
