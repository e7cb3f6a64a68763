"""The right-hand side on a plane: that of the line, column by column, and what acts across."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bcre_pde.line import fluxes as line
from bcre_pde.plane import fluxes

TERMS = ("v", "D_x", "D_y", "gamma", "kappa_x", "kappa_y")
ALL = {"v": 1.1, "D_x": 0.3, "D_y": 0.2, "gamma": 0.5, "kappa_x": 0.2, "kappa_y": 0.15}
DRIFT = {"v": 1.1, "D_x": 0.3, "D_y": 0.2, "gamma": 0.5, "kappa_x": None, "kappa_y": None}


def coefficients(ends=False, sides=True, dx=0.7, dy=0.4, **given):
    """All terms, zero where not given: one version to compile; without curvature another."""
    saturation = 0.0 if given.get("kappa_x", 0.0) is not None else None
    terms = dict.fromkeys(TERMS, 0.0) | {"saturation": saturation, "grain": 0.5} | given
    return fluxes.Coefficients(**terms, dx=dx, dy=dy, joined_ends=ends, joined_sides=sides)


def rate(u, R, K, foot=None, threads=None, base=None):
    """Rates of u, R and the ends."""
    layers, rates = np.zeros((3, *u.shape)), np.zeros((3, *u.shape))
    layers[0], layers[1] = u, R
    layers[2, 0] = 0.0 if foot is None else foot
    if threads is None:
        fluxes.rate(layers, rates, base, K)
    else:
        fluxes.rate_on_threads(layers, rates, base, K, threads)
    return rates


def rate_of_line(u, R, K, foot):
    layers, rates = np.zeros((3, u.size)), np.zeros((3, u.size))
    layers[0], layers[1], layers[2, 0] = u, R, foot
    scratch = np.empty((2, u.size + 6)), np.empty((2, u.size + 1))
    line.rate(
        layers, rates, *scratch, K.v, K.D_x, K.gamma, K.kappa_x, K.dx, K.joined_ends, K.saturation
    )
    return rates


def rough(rows, columns, seed):
    rng = np.random.default_rng(seed)
    return rng.uniform(-3, 3, (rows, columns)), rng.uniform(-0.3, 2, (rows, columns))


shapes = st.tuples(st.integers(8, 24), st.integers(3, 24))
seeds = st.integers(0, 10_000)


@given(rows=st.integers(8, 30), columns=st.integers(3, 9), seed=seeds, ends=st.booleans())
def test_scene_that_does_not_depend_on_y_has_the_rates_of_the_line_to_the_bit(
    rows, columns, seed, ends
):
    for sides, saturation in ((True, 0.0), (False, 1.75)):
        K = coefficients(ends, sides, **ALL, saturation=saturation)
        u, R = rough(rows, 1, seed)
        expected = rate_of_line(u[:, 0], R[:, 0], K, foot=0.3)
        plane = np.broadcast_to(u, (rows, columns)), np.broadcast_to(R, (rows, columns))
        found = rate(*plane, K, foot=0.3)
        assert np.array_equal(found, np.broadcast_to(expected[:, :, None], found.shape))


@given(shape=shapes, seed=seeds, ends=st.booleans())
def test_columns_that_nothing_joins_are_lines_to_the_bit(shape, seed, ends):
    K = coefficients(ends, **(ALL | {"D_y": 0.0, "kappa_y": 0.0}))
    u, R = rough(*shape, seed)
    found = rate(u, R, K, foot=0.3)
    for j in range(shape[1]):
        assert np.array_equal(found[:, :, j], rate_of_line(u[:, j], R[:, j], K, 0.3))


@given(shape=shapes, seed=seeds, ends=st.booleans(), sides=st.booleans())
def test_volume_changes_by_the_flux_through_the_foot_alone(shape, seed, ends, sides):
    K = coefficients(ends, sides, **ALL)
    u, R = rough(*shape, seed)
    change = rate(u, R, K, foot=0.3)
    outflow = 0.0 if ends else K.v * R[-1].sum() / K.dx
    assert change[2, -1].sum() * shape[0] == pytest.approx(outflow, rel=1e-12)
    assert abs(change[:2].sum() + outflow) <= 1e-13 * np.abs(change).sum() * 20


@given(shape=shapes, seed=seeds, shift=st.integers(1, 20), ends=st.booleans())
def test_rates_move_across_joined_sides_with_the_state_to_the_bit(shape, seed, shift, ends):
    K = coefficients(ends, **ALL)
    u, R = rough(*shape, seed)
    here = rate(u, R, K)
    there = rate(np.roll(u, shift, 1), np.roll(R, shift, 1), K)
    assert np.array_equal(np.roll(here, shift, 2), there)


@given(shape=shapes, seed=seeds, shift=st.integers(1, 20))
def test_rates_move_along_joined_ends_with_the_state_to_the_bit(shape, seed, shift):
    K = coefficients(True, False, **ALL)
    u, R = rough(*shape, seed)
    here = rate(u, R, K)
    there = rate(np.roll(u, shift, 0), np.roll(R, shift, 0), K)
    assert np.array_equal(np.roll(here, shift, 1), there)


@given(shape=shapes, seed=seeds, ends=st.booleans())
def test_closed_side_is_a_mirror(shape, seed, ends):
    """The plane beside its mirror image, joined: left and right sums differ in their rounding."""
    u, R = rough(*shape, seed)
    alone = rate(u, R, coefficients(ends, False, **ALL))
    both = [np.hstack([field, field[:, ::-1]]) for field in (u, R)]
    beside = rate(*both, coefficients(ends, True, **ALL))
    size = np.abs(alone).max()
    assert alone == pytest.approx(beside[:, :, : shape[1]], abs=1e-13 * size)
    assert beside[:, :, shape[1] :][:, :, ::-1] == pytest.approx(alone, abs=1e-13 * size)


@given(
    shape=shapes, seed=seeds, ends=st.booleans(), sides=st.booleans(), threads=st.integers(1, 40)
)
def test_numbers_are_the_same_on_any_number_of_threads(shape, seed, ends, sides, threads):
    K = coefficients(ends, sides, **DRIFT)
    u, R = rough(*shape, seed)
    assert np.array_equal(rate(u, R, K, 0.3), rate(u, R, K, 0.3, threads))


@pytest.mark.parametrize("ends", [True, False])
def test_absent_term_is_a_term_of_zero_to_the_bit(ends):
    u, R = rough(20, 9, 0)
    zero = rate(u, R, coefficients(ends, **(DRIFT | {"kappa_x": 0.0, "kappa_y": 0.0})))
    assert np.array_equal(zero, rate(u, R, coefficients(ends, **DRIFT)))


def test_uniform_layer_on_the_repose_plane_is_steady():
    full = np.ones((20, 9))
    assert np.abs(rate(3 * full, 2 * full, coefficients(True, **ALL))).max() < 1e-12


@pytest.mark.parametrize("power", range(6))
def test_spread_across_is_exact_for_polynomials_of_degree_five(power):
    """Away from the sides, and of cell means, whose R_yy is the difference of R_y on the faces."""
    edges = np.arange(15) * 0.4
    means = np.diff(edges ** (power + 1)) / ((power + 1) * 0.4)
    R = np.broadcast_to(means, (8, 14))
    change = rate(np.zeros_like(R), R, coefficients(D_y=1.0))[1]
    expected = np.diff(power * edges ** max(power - 1, 0)) / 0.4
    assert change[0, 3:-3] == pytest.approx(expected[3:-3], rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("power", range(7))
def test_curvature_across_is_exact_for_polynomials_of_degree_six(power):
    y = (np.arange(14) + 0.5) * 0.4
    u = np.broadcast_to(y**power, (8, 14))
    change = rate(u, np.full_like(u, 2.0), coefficients(kappa_y=1.0), foot=y**power)
    expected = 2 * power * (power - 1) * y ** max(power - 2, 0)
    for row in (change[0, 0], change[0, 4], change[2, 0]):  # next to the top, inside, on the foot
        assert row[3:-3] == pytest.approx(expected[3:-3], rel=1e-9, abs=1e-9)


def test_negative_layer_exchanges_nothing():
    u, _ = rough(12, 9, 0)
    K = coefficients(gamma=1.0, kappa_x=1.0, kappa_y=1.0)
    assert (rate(u, np.full_like(u, -1.0), K) == 0).all()


@pytest.mark.parametrize("sides", [True, False])
def test_each_term_converges_to_its_derivative_at_fifth_order(sides):
    """A wave in both directions, even about the sides, so that they may be closed."""
    k, q = 2 * np.pi / 5, 2 * np.pi / 3
    errors = {term: [] for term in ALL}
    for n in (24, 48):
        x, y = (np.arange(n) + 0.5) * 5 / n, (np.arange(n) + 0.5) * 3 / n
        X, Y = np.meshgrid(x, y, indexing="ij")
        u, R = np.sin(k * X) * np.cos(q * Y), 2 + np.cos(k * X + 1) * np.cos(q * Y)
        waves = np.cos(q * Y)
        exact = {
            "v": k * np.sin(k * X + 1) * waves,
            "D_x": -(k**2) * (R - 2),
            "D_y": -(q**2) * (R - 2),
            "gamma": -R * k * np.cos(k * X) * waves,
            "kappa_x": R * k**2 * u,
            "kappa_y": R * q**2 * u,
        }
        for term, expected in exact.items():
            K = coefficients(True, sides, dx=5 / n, dy=3 / n, **{term: 1.0})
            errors[term].append(np.abs(rate(u, R, K)[1] - expected).mean())
    for coarse, fine in errors.values():
        assert np.log2(coarse / fine) > 4.6
        assert fine < 2e-4
