"""Sand that is poured, and the wall that holds it."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bcre_pde import Material, Problem, solve
from bcre_pde.source import Source

LENGTH, V, GAMMA, SC = 10.0, 1.0, 0.5, 0.5
SILO = Material(V, 0.0, GAMMA, SC)


def repose(x):
    return SC * (LENGTH - x), np.zeros_like(x)


@given(
    place=st.floats(1, 9),
    width=st.floats(1e-3, 2),
    cells=st.integers(1, 60),
    rate=st.floats(0, 1e3),
)
def test_cells_get_what_is_poured_whatever_the_grid(place, width, cells, rate):
    edges = np.linspace(0, LENGTH, cells + 1)
    w = Source(rate, place, width).over(edges)
    assert (w >= 0).all()
    assert w @ np.diff(edges) == pytest.approx(rate, rel=1e-9)
    covered = (edges[1:] > place - width / 2) & (edges[:-1] < place + width / 2)
    assert not w[~covered].any()


def test_source_pours_between_its_times():
    source = Source(2.0, 5.0, 1.0, start=1.0, until=3.0)
    assert [source.poured(t) for t in (0, 1, 2, 3, 9)] == [0, 0, 2, 4, 4]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"rate": -1.0}, "source rate = -1.0"),
        ({"width": 0.0}, "source width = 0.0"),
        ({"start": math.inf}, "source start = inf"),
        ({"start": 2.0, "until": 1.0}, "source until = 1.0: must be at least 2.0"),
        ({"place": 0.1}, r"source place = 0.1, width = 1.0: must lie on"),
    ],
)
def test_impossible_source_is_refused_by_name(changes, message):
    with pytest.raises(ValueError, match=message):
        Problem(
            repose,
            SILO,
            LENGTH,
            "wall",
            (Source(**{"rate": 1.0, "place": 5.0, "width": 1.0} | changes),),
        )


@pytest.mark.parametrize("ends", ["open", "wall", "periodic"])
def test_mass_with_a_source_is_exact_to_rounding(ends):
    """Two sources that begin and end between the recorded times."""
    sources = (Source(0.3, 2.0, 1.5, 0.7, 3.1), Source(0.2, 6.0, 0.9, 2.2, 9.0))
    problem = Problem(repose, SILO, LENGTH, ends, sources)
    found = solve(problem, [0.0, 1.0, 4.0, 12.0], 40)
    assert found.inflow == pytest.approx([0, 0.09, 0.72 + 0.36, 0.72 + 1.36], rel=1e-14)
    balance = found.mass() + found.outflow - found.inflow - found.mass()[0]
    assert np.abs(balance).max() <= 1e-12 * found.mass()[-1]
    assert bool(found.outflow[-1] > 1) is (ends == "open")


def test_source_begins_and_ends_when_it_says():
    """With nothing but a source R is what has been poured, at times that its steps do not know."""
    still = Material(0.0, 0.0, 0.0, SC)
    problem = Problem(repose, still, LENGTH, "wall", (Source(1.0, 5.0, 2.0, 0.3, 0.9),))
    R = solve(problem, [0.2, 0.5, 2.0], 40).R[:, 20]
    assert pytest.approx([0.0, 0.1, 0.3], abs=1e-13) == R


def test_bcre_fills_a_silo_as_its_closed_form_says():
    """R = w (L - x)/v, S - Sc = -v/(gamma (L - x)), to first order at the wall."""
    w, at = 0.1, np.array([0.5, 0.95]) * LENGTH
    problem = Problem(repose, SILO, LENGTH, "wall", (Source(w * LENGTH, 0.25, 0.5),))
    found = solve(problem, [100.0], 200)
    S = np.interp(at, found.x[:-1] + found.dx / 2, -np.diff(found.h[-1]) / found.dx)
    assert pytest.approx(SC - V / (GAMMA * (LENGTH - at)), rel=1e-2) == S
    assert np.interp(at[0], found.x, found.R[-1]) == pytest.approx(w * at[0] / V, rel=2e-3)
    assert found.R.min() >= 0
