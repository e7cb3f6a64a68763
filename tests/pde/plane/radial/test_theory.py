"""Closed forms about an axis."""

import numpy as np
import pytest
import sympy as sp

from bcre_pde import Material
from bcre_pde.plane.radial import theory

MATERIAL = Material(1.3, 0.05, 0.8, 0.5)


def test_filling_silo_obeys_the_equations():
    r, w, a, v, gamma, Sc = sp.symbols("r w a v gamma Sc", positive=True)
    R = w * (a**2 - r**2) / (2 * v * r)
    S = Sc - w / (gamma * R)
    E = gamma * R * (S - Sc)
    assert sp.simplify(E + w) == 0
    assert sp.simplify(sp.diff(r * v * R, r) / r - E) == 0
    numbers = {r: 3.0, w: 0.2, a: 9.0, v: 1.3, gamma: 0.8, Sc: 0.5}
    assert theory.filling_layer(3.0, 0.2, 9.0, MATERIAL) == pytest.approx(float(R.subs(numbers)))
    assert theory.filling_slope(3.0, 9.0, MATERIAL) == pytest.approx(float(S.subs(numbers)))


def test_filling_silo_is_flat_from_where_its_slope_would_pass_zero():
    a = 9.0
    flat = theory.flat_from(a, MATERIAL)
    r = np.linspace(0.5, a, 200)
    S, R = theory.filling_slope(r, a, MATERIAL), theory.filling_layer(r, 0.2, a, MATERIAL)
    assert theory.filling_slope(flat, a, MATERIAL) == pytest.approx(0, abs=1e-12)
    assert (S[r < flat] > 0).all()
    assert S[r > flat] == pytest.approx(0, abs=1e-12)
    assert R[r > flat] == pytest.approx(0.2 / (0.8 * 0.5))
    assert 0 < flat < a


def test_rills_grow_as_the_equations_say_to_first_order():
    """R = R0 (1 + ...), h across a slope S: the steepest descent turns by h_y/S."""
    rate, k, R0, S = sp.symbols("l k R0 S", positive=True)
    v, D, gamma, Sc = sp.symbols("v D gamma Sc", positive=True)
    # R_t = v (R0/S) h_yy + D R_yy + sigma R, h_t = -sigma R, for amplitudes of e^(l t + i k y)
    sigma = gamma * (S - Sc)
    growth = sp.Matrix([[sigma - D * k**2, -v * R0 * k**2 / S], [-sigma, 0]])
    expected = rate**2 + rate * (D * k**2 - sigma) - sigma * v * R0 * k**2 / S
    assert sp.simplify((rate * sp.eye(2) - growth).det() - expected) == 0
    material = Material(1.0, 0.1, 0.3, 0.5)
    found = theory.rill_growth_rate(material, 0.2, 0.9, 3.0)
    numbers = {k: 3.0, R0: 0.2, S: 0.9, v: 1.0, D: 0.1, gamma: 0.3, Sc: 0.5}
    assert found == pytest.approx(
        max(float(sp.re(x)) for x in sp.solve(expected.subs(numbers), rate))
    )


def test_without_diffusion_the_shortest_rills_grow_fastest():
    bare, damped = Material(1.0, 0.0, 0.3, 0.5), Material(1.0, 0.1, 0.3, 0.5)
    waves = np.geomspace(0.1, 1e4, 30)
    without = [theory.rill_growth_rate(bare, 0.2, 0.9, k) for k in waves]
    spread = [theory.rill_growth_rate(damped, 0.2, 0.9, k) for k in waves]
    assert (np.diff(without) > 0).all()
    assert without[-1] > 100
    bound = 0.12 / 2 + np.sqrt((0.12 / 2) ** 2 + 0.12 * 0.2 / 0.9 / 0.1 * 12)
    assert max(spread) < bound
