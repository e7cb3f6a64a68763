"""An erodible layer of finite thickness on a rigid base."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bcre_pde.plane import Material, Problem, fluxes, solve, theory

MATERIAL = Material(0.1, 0.1, 0.1, 0.01, 0.5)
THICKNESS = 0.2


def rate(u, R, base, grain=0.5):
    layers, rates = np.zeros((3, *u.shape)), np.zeros((3, *u.shape))
    layers[0], layers[1] = u, R
    K = fluxes.Coefficients(
        v=1.1,
        D_x=0.3,
        D_y=0.2,
        gamma=0.5,
        kappa_x=None,
        kappa_y=None,
        saturation=None,
        dx=0.7,
        dy=0.4,
        joined_ends=False,
        joined_sides=True,
        grain=grain,
    )
    fluxes.rate(layers, rates, base, K)
    return rates


@given(rows=st.integers(8, 20), columns=st.integers(3, 12), seed=st.integers(0, 1000))
def test_what_lies_deeper_than_a_grain_erodes_as_without_a_base(rows, columns, seed):
    rng = np.random.default_rng(seed)
    u, R = rng.uniform(-3, 3, (rows, columns)), rng.uniform(-0.3, 2, (rows, columns))
    depth = rng.choice([0.0, 0.25, 0.75, 4.0], (rows, columns))
    free, bounded = rate(u, R, None), rate(u, R, u - depth)
    erodes = free[0] < 0
    share = np.where(erodes, np.minimum(depth / 0.5, 1), 1)
    assert np.array_equal(bounded[0][depth > 0.5], free[0][depth > 0.5])
    assert np.array_equal(bounded[0][~erodes], free[0][~erodes])
    assert bounded[0] == pytest.approx(share * free[0], rel=1e-9, abs=1e-12)
    assert bounded[0] + bounded[1] == pytest.approx(free[0] + free[1], abs=1e-12)


def triangle(cells, grain, until=600.0, thickness=THICKNESS):
    """A pulse on a slope between Sc and Sd, symmetric about y = 0."""
    length, width, S0 = 96.0, 36.0, 1.5

    def start(x, y):
        return S0 * (length - x), np.exp(-((x - 12) ** 2 + y**2) / 9)

    problem = Problem(
        start, MATERIAL, length, width, sides="closed", thickness=thickness, grain=grain
    )
    return solve(problem, [0.0, until], cells, 1e-5)


def edge(solution, x):
    """Where half of the layer is gone, across at x."""
    left = THICKNESS - (solution.h[0] - solution.h[1])
    at_x = [np.interp(x, solution.x, column) for column in left.T]
    return float(np.interp(THICKNESS / 2, at_x, solution.y))


def test_layer_is_never_eroded_below_its_base_and_the_base_is_laid_bare():
    solution = triangle((96, 36), 0.02)
    depth = THICKNESS - (solution.h[0] - solution.h[1])
    assert depth.min() > -1e-12
    assert depth[30:40, 0].max() < 1e-3 * THICKNESS
    volume = solution.mass() + solution.outflow
    assert volume[1] == pytest.approx(volume[0], rel=1e-12)


def test_edge_of_the_triangle_converges_with_the_grid_and_with_the_grain():
    """And it opens, so near to its start, by less than an infinitesimal avalanche."""
    runs = (((96, 36), 0.04), ((96, 36), 0.01), ((192, 72), 0.01))
    solutions = [triangle(*given) for given in runs]
    coarse, fine, finest = (edge(solution, 36.0) for solution in solutions)
    assert fine == pytest.approx(finest, abs=0.01)
    assert coarse == pytest.approx(finest, abs=0.1)
    opening = (finest - edge(solutions[-1], 24.0)) / 12
    assert 0.5 < opening < math.tan(math.radians(theory.opening_angle(MATERIAL, 1.5)))


def test_deep_layer_is_no_bound_to_the_bit():
    deep, endless = (triangle((96, 36), 1.0, 50.0, thickness) for thickness in (1e3, math.inf))
    assert np.array_equal(deep.h, endless.h)
    assert np.array_equal(deep.R, endless.R)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"thickness": 0.0}, r"^thickness = 0.0: must be > 0"),
        ({"thickness": math.nan}, r"^thickness = nan: must be > 0"),
        ({"thickness": 0.2, "grain": 0.0}, r"^grain = 0.0: must be > 0 and at most the thickness"),
        ({"thickness": 0.2, "grain": 0.3}, r"^grain = 0.3: must be > 0 and at most the thickness"),
    ],
)
def test_bad_layer_is_refused_with_its_name_and_value(options, message):
    with pytest.raises(ValueError, match=message):
        Problem(lambda x, y: (x, y), MATERIAL, 10.0, 10.0, **options)
