import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bcre_pde import Material, solve
from bcre_pde.travelling_scarp import travelling_scarp

CASES = [Material(0.5, 0.5, 0.5, 0.5), Material(0.3, 0.2, 0.3, 0.5, v_up=0.4)]


def layers(material, H=5.0):
    return travelling_scarp(material, H, 30.0, 40.0, 10.0)


@pytest.mark.parametrize("material", CASES)
def test_scarp_keeps_its_shape_and_balances_its_mass(material):
    scarp = layers(material)
    c = 10.0 / scarp.until
    x = np.linspace(0, 40, 400_001)
    for t in (0.0, scarp.until):
        h, R = scarp.layers(x, t)
        u = h + 0.5 * x
        below = x > 30 - c * t
        assert (u[below] == 0).all()
        assert (u[~below][:-1] == 5.0).all()
        assert np.ptp(R[below]) == 0
        assert R[~below][0] < 1e-6 * R.max()
        wet = (x > 27 - c * t) & ~below
        gap = material.D * np.gradient(R, x) - (material.v + c) * R
        assert np.abs(gap[wet][1:-1]).max() < 1e-6 * R.max()
    ends = [scarp.layers(x, t) for t in (0.0, scarp.until)]
    sand = [np.trapezoid(h + R, x) for h, R in ends]
    outflow = material.v * ends[0][1][-1] * scarp.until
    assert sand[1] + outflow == pytest.approx(sand[0], abs=1e-3 * outflow)


@given(v=st.floats(0.1, 2), D=st.floats(0.05, 2), gamma=st.floats(0.1, 3), H=st.floats(0.2, 9))
def test_linear_law_climbs_at_the_speed_of_mass_balance(v, D, gamma, H):
    material = Material(v, D, gamma, 0.5)
    if gamma * H <= v * (1 + 1e-6):
        with pytest.raises(ValueError, match="gamma H > v"):
            layers(material, H)
    else:
        assert layers(material, H).until == pytest.approx(10.0 / (gamma * H - v), rel=1e-6)


def test_bcre_converges_to_it():
    scarp = layers(CASES[0], 3.0)
    errors = []
    for cells in (100, 400):
        end = solve(scarp.problem, [scarp.until], cells)
        errors.append(float(np.mean(np.abs(end.R[-1] - scarp.layers(end.x, scarp.until)[1]))))
    assert 0.3 < math.log(errors[0] / errors[1], 4) < 1.2
