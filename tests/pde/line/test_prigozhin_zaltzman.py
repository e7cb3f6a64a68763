"""The quasi-static limit: steps of any length, half heap, undermining, a heap in the middle."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bcre_pde.line import prigozhin_zaltzman as pz
from bcre_pde.source import Source

SC = 0.6


def centres(cells, length):
    return (np.arange(cells) + 0.5) * length / cells


@settings(max_examples=40)
@given(
    heights=st.lists(st.floats(-5, 5), min_size=2, max_size=24),
    ends=st.sampled_from(["open", "wall", "periodic"]),
)
def test_what_settles_stands_keeps_its_sand_and_settles_no_further(heights, ends):
    g, dx = np.array(heights), 0.4
    h, left = pz.settle(g, SC, dx, ends, u_foot=6.0)
    slopes = -np.diff(h) / dx
    assert slopes.max() <= SC + 1e-9
    if ends == "wall":
        assert slopes.min() >= -SC - 1e-9
    assert dx * (g.sum() - h.sum()) == pytest.approx(left, abs=1e-9)
    assert pz.settle(h, SC, dx, ends, u_foot=6.0)[0] == pytest.approx(h, abs=1e-9)


@settings(max_examples=20)
@given(seed=st.integers(0, 1000), step=st.floats(0.01, 0.9), cells=st.integers(3, 14))
def test_no_surface_that_stands_is_nearer(seed, step, cells):
    """Nor is any on the way to it: the distance to a convex set has one minimum."""
    rng = np.random.default_rng(seed)
    g, dx = rng.uniform(-2, 2, cells), 0.5
    h, _ = pz.settle(g, SC, dx, "wall")
    other = rng.uniform(-1, 1) + np.cumsum(rng.uniform(-SC * dx, SC * dx, cells))
    between = (1 - step) * h + step * other
    assert ((h - g) ** 2).sum() <= ((between - g) ** 2).sum() + 1e-9


@pytest.mark.parametrize("cells", [100, 200])
@pytest.mark.parametrize("steps", [1, 7])
def test_half_heap_is_exact_where_its_foot_is_an_edge_of_cells(cells, steps):
    """sqrt(2 t rate/Sc) = 3; elsewhere the cell at the foot is off, by second order in all."""
    length, dx = 10.0, 10.0 / cells
    for rate, error in ((0.3, 1e-14), (0.31, 0.01 * dx**2)):
        source, times = Source(rate, dx / 2, dx), np.linspace(0, 9.0, steps + 1)
        h, left = pz.evolve(np.zeros(cells), SC, dx, times, "wall", [source])
        exact = pz.half_heap(centres(cells, length), 9.0, SC, rate)
        assert np.abs(h[-1] - exact).mean() < error
        assert dx * h[-1].sum() == pytest.approx(rate * 9.0, rel=1e-12)
        assert not left.any()


def test_steps_of_a_growing_heap_are_exact_whatever_their_length():
    source = Source(0.3, 1.0, 2.0)
    ends = [
        pz.evolve(np.zeros(60), SC, 0.2, np.linspace(0, 9, steps + 1), "wall", [source])[0][-1]
        for steps in (1, 2, 50)
    ]
    assert ends[0] == pytest.approx(ends[1], abs=1e-13)
    assert ends[0] == pytest.approx(ends[2], abs=1e-12)


@pytest.mark.parametrize("S0", [0.0, 0.35])
def test_undermining_slides_as_far_as_the_wedge_says(S0):
    length, M, errors = 20.0, 1.7, []
    expected = pz.undermined_length(M, S0, SC)
    for cells in (200, 400, 800):
        dx, x = length / cells, centres(cells, length)
        g = S0 * (length - x)
        g[-1] -= M / dx
        h, _ = pz.settle(g, SC, dx, "wall")
        moved = x[S0 * (length - x) - h > 1e-9]
        errors.append(abs(length - (moved[0] - dx / 2) - expected))
        assert errors[-1] < 1.1 * dx
        assert h.sum() == pytest.approx(g.sum(), rel=1e-12)
    assert errors[-1] < 0.03


def test_heap_in_the_middle_stands_at_repose_on_both_sides():
    rate, until, cells, length = 0.4, 5.0, 101, 10.1
    dx, x = length / cells, centres(cells, length)
    source = Source(rate, length / 2, dx)
    h, _ = pz.evolve(np.zeros(cells), SC, dx, [0.0, 2.0, until], "wall", [source])
    exact = np.maximum(math.sqrt(SC * rate * until) - SC * np.abs(x - length / 2), 0.0)
    assert h[-1] == pytest.approx(exact, abs=0.6 * SC * dx)
    assert h[-1] == pytest.approx(h[-1][::-1], abs=1e-10)
    assert dx * h[-1].sum() == pytest.approx(rate * until, rel=1e-12)


def test_open_foot_holds_its_height_and_lets_the_rest_go():
    cells, dx = 50, 0.2
    x = (np.arange(cells) + 0.5) * dx
    g = (SC + 1.0) * (10.0 - x)
    h, left = pz.settle(g, SC, dx, "open", u_foot=SC * 10.0)
    assert h == pytest.approx(SC * (10.0 - x), abs=1e-12)
    assert left == pytest.approx(0.5 * 10.0**2, rel=1e-12)
