"""The right-hand side about an axis."""

import numpy as np
import pytest
import sympy as sp
from hypothesis import given
from hypothesis import strategies as st

from bcre_pde.plane.radial import fluxes
from bcre_pde.plane.radial.problem import ring_means


def rate(h, R, dr=0.5, supply=None, **given):
    terms = {"v": 0.0, "D": 0.0, "gamma": 0.0, "Sc": 0.5, "saturation": None}
    terms |= {"closed": False, "turning": 0.1} | given
    K = fluxes.Coefficients(**terms, dr=dr)
    layers, rates = np.zeros((3, h.size)), np.zeros((3, h.size))
    layers[0], layers[1] = h, R
    fluxes.rate(layers, rates, np.zeros(h.size) if supply is None else supply, K)
    return rates


def radii(cells, dr=0.5):
    return (np.arange(cells) + 0.5) * dr


def cone(cells, slope=0.5, dr=0.5):
    """Its means over the rings: that of r is r + dr^2/(12 r), r in the middle."""
    r = radii(cells, dr)
    return 30 - slope * (r + dr**2 / (12 * r))


@given(cells=st.integers(8, 40), seed=st.integers(0, 10_000), closed=st.booleans())
def test_volume_changes_by_the_source_and_through_the_rim_alone(cells, seed, closed):
    rng = np.random.default_rng(seed)
    h, R, supply = rng.uniform(-3, 3, cells), rng.uniform(-0.2, 2, cells), rng.uniform(0, 1, cells)
    change = rate(h, R, supply=supply, v=1.1, D=0.3, gamma=0.7, closed=closed)
    ring, disc = 0.5 * radii(cells), (cells * 0.5) ** 2 / 2
    gained = (ring * (change[0] + change[1])).sum()
    supplied, left = disc * change[2, 0], disc * change[2, -1]
    assert supplied == pytest.approx((ring * supply).sum(), rel=1e-12)
    assert left == pytest.approx(0 if closed else 1.1 * cells * 0.5 * R[-1], rel=1e-12)
    scale = (ring * np.abs(change[:2])).sum()
    assert abs(gained - supplied + left) <= 1e-12 * scale


def test_uniform_layer_at_repose_thins_as_circles_widen_and_diffuses_nowhere():
    """v R/r is what widening circles cost."""
    change = rate(cone(30), np.full(30, 2.0), v=1.5, D=0.4, gamma=0.7)
    assert change[1][3:-3] == pytest.approx((-1.5 * 2.0 / radii(30))[3:-3], rel=1e-11)
    assert np.abs(change[0][:-3]).max() < 1e-11


def test_layer_below_zero_exchanges_nothing():
    assert (rate(cone(12, 2.0), np.full(12, -1.0), gamma=1.0)[0] == 0).all()


def test_level_ground_takes_a_layer_at_gamma_Sc():
    change = rate(np.full(20, 3.0), np.full(20, 2.0), gamma=0.7)
    assert change[0][:-3] == pytest.approx(0.7 * 0.5 * 2.0, rel=1e-12)


@pytest.mark.parametrize("face", [1, 2])
def test_stencils_in_the_centre_are_those_of_the_cubic_that_vanishes_there(face):
    """q = r R from its means over three rings; r R_r = q_r - q/r."""
    x, means = sp.symbols("x"), sp.symbols("q0:3")
    terms = sp.symbols("a b c")
    q = sum(term * x**power for power, term in enumerate(terms, 1))
    equations = [sp.integrate(q, (x, k, k + 1)) - means[k] for k in range(3)]
    q = q.subs(sp.solve(equations, terms))
    on_face = sp.expand(q.subs(x, face))
    climb = sp.expand((sp.diff(q, x) - q / x).subs(x, face))
    rng = np.random.default_rng(face)
    layer = rng.uniform(1, 2, 12)
    values = dict(zip(means, radii(12, 1.0) * layer, strict=False))
    h, ring = -0.5 * radii(12, 1.0), radii(12, 1.0)
    for terms, expected in (({"v": 1.0}, on_face), ({"D": 1.0}, -climb)):
        change = rate(h, layer, dr=1.0, **terms)[1]
        passed = -(ring * change)[:face].sum()
        assert passed == pytest.approx(float(expected.subs(values)), rel=1e-12)


@pytest.mark.parametrize("power", range(6))
def test_values_in_the_middle_and_means_over_cells_follow_from_each_other(power):
    """Exactly for degree 5 inside, for cubics next to both ends."""
    edges = np.arange(15.0)
    means = np.diff(edges ** (power + 1)) / (power + 1)
    points, bend, found = (edges[:-1] + 0.5) ** power, np.empty(14), np.empty(14)
    inner = slice(None) if power < 3 else slice(2, -2)
    fluxes.to_points(means, bend, found)
    assert found[inner] == pytest.approx(points[inner], rel=1e-12)
    fluxes.to_means(points, bend, found)
    assert found[inner] == pytest.approx(means[inner], rel=1e-12)


def test_each_term_converges_to_its_derivative_at_fourth_order():
    """On a cone with a bend, away from the rim, and from the centre, where v R/r is infinite."""
    a, k, S = 12.0, 0.9, 0.8

    def layers(r):
        return -S * r - 0.01 * r**2, 2 + np.cos(k * r)

    def exact(r):
        R = 2 + np.cos(k * r)
        drift = -(R / r - k * np.sin(k * r))
        spread = -(k**2) * np.cos(k * r) - k * np.sin(k * r) / r
        return {"v": drift, "D": spread, "gamma": R * (S + 0.02 * r - 0.5)}

    errors = {"v": [], "D": [], "gamma": []}
    for cells in (40, 80, 160):
        h, R = ring_means(layers, a, cells)
        r = radii(cells, a / cells)
        inside = (r > 3) & (r < 9)
        for term, found in errors.items():
            expected = ring_means(lambda r, term=term: (exact(r)[term], r), a, cells)[0]
            change = rate(h, R, dr=a / cells, **{term: 1.0})[1]
            found.append(np.abs(change - expected)[inside].mean())
    for term, found in errors.items():
        assert np.log2(found[0] / found[2]) / 2 > 4, (term, found)
        assert found[2] < 1e-6, (term, found)
