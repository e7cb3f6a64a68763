"""Whatever is given to a public entry of the automaton: a right answer, or a line that names it."""

import pickle
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

import bcre_ca
from bcre_ca import Pile, Rule, UnstableStep, plane

RULE = Rule(v=0.1, D=0.1, gamma=0.01, Sc=0.5, d=1.0, dt=0.2)
FLAT = plane.Plane(RULE)
N = 12

WRONG = {
    "lists of text": ["a"] * N,
    "complex": np.ones(N, complex),
    "objects": np.array([None] * N),
    "booleans": np.ones(N, bool),
    "masked": np.ma.masked_equal(np.arange(N, dtype=float), 3),
    "a column": np.ones((N, 1)),
    "a number": 1.0,
    "nothing": None,
    "ragged": [[1.0], [1.0, 2.0]],
    "empty": [],
    "one cell less": np.ones(N - 1),
    "not a number": np.full(N, np.nan),
    "infinite": np.full(N, np.inf),
}
RIGHT = {
    "list": [1] * N,
    "integers": np.ones(N, int),
    "series": pd.Series(np.ones(N), index=range(5, 5 + N)),
    "every other": np.ones(2 * N)[::2],
    "backwards": np.ones(N)[::-1],
    "big endian": np.ones(N, ">f8"),
    "nothing masked": np.ma.array(np.ones(N)),
    "read only": np.broadcast_to(1.0, N),
}

ON_A_LINE = {
    "evolve": lambda h, R: bcre_ca.evolve(h, R, RULE, 3),
    "step": lambda h, R: bcre_ca.step(h, R, RULE),
    "advance": lambda h, R: bcre_ca.advance(Pile(h, R), RULE, 3).h,
    "frames": lambda h, R: list(bcre_ca.frames(Pile(h, R), RULE, [0.5])),
    "fixed frames": lambda h, R: list(bcre_ca.frames(Pile(h, R), RULE, [0.5], step=0.1)),
    "bound": lambda h, R: bcre_ca.largest_stable_step(Pile(h, R), RULE, "open"),
}
NOT_FINITE = {"not a number", "infinite"}


@pytest.mark.parametrize("entry", ON_A_LINE)
@pytest.mark.parametrize("layer", ["h", "R"])
@pytest.mark.parametrize("kind", WRONG)
def test_a_wrong_layer_is_named(entry, layer, kind):
    if kind in NOT_FINITE and entry in ("step", "bound"):
        return  # they take one step of anything, or say that no step is stable
    layers = {"h": np.ones(N), "R": np.ones(N)} | {layer: WRONG[kind]}
    with pytest.raises(ValueError, match=r"^[hR] "):
        ON_A_LINE[entry](**layers)


@pytest.mark.parametrize("entry", ON_A_LINE)
@pytest.mark.parametrize("kind", RIGHT)
def test_layers_of_any_kind_of_numbers_give_what_arrays_give(entry, kind):
    found = ON_A_LINE[entry](RIGHT[kind], RIGHT[kind])
    np.testing.assert_equal(found, ON_A_LINE[entry](np.ones(N), np.ones(N)))


def test_layers_of_unequal_length_are_refused_before_compiled_code_reads_past_their_end():
    with pytest.raises(ValueError, match=r"R has shape \(50,\): must be that of h, \(100,\)"):
        bcre_ca.frames(Pile(np.ones(100), np.ones(50)), RULE, [1.0])


@pytest.mark.parametrize("entry", sorted(set(ON_A_LINE) - {"step", "bound", "advance"}))
def test_a_negative_rolling_layer_is_refused_with_its_cell(entry):
    R = np.ones(N)
    R[7] = -1e-3
    with pytest.raises(ValueError, match=r"R = -0\.001 in cell 7: must be >= 0"):
        ON_A_LINE[entry](np.ones(N), R)


IN_PLACE = {
    "integers": np.ones(N, int),
    "a list": [1.0] * N,
    "every other": np.ones(2 * N)[::2],
    "read only": np.broadcast_to(1.0, N),
    "a plane": np.ones((3, 4)),
    "big endian": np.ones(N, ">f8"),
}


@pytest.mark.parametrize("kind", IN_PLACE)
def test_march_changes_in_place_or_says_why_not(kind):
    with pytest.raises(ValueError, match=r"^h"):
        bcre_ca.march(IN_PLACE[kind], np.ones(N), RULE, 1)
    h = np.ones(N)
    with pytest.raises(ValueError, match="R: must not share its memory with h"):
        bcre_ca.march(h, h, RULE, 1)
    with pytest.raises(ValueError, match="R has shape"):
        bcre_ca.march(h, np.ones(N, np.float32), RULE, 1)


PILE = Pile(np.ones(N), np.ones(N))
ARGUMENTS = {
    "ends": lambda x: bcre_ca.frames(PILE, RULE, [1.0], ends=x),
    "rule": lambda x: bcre_ca.frames(PILE, x, [1.0]),
    "pile": lambda x: bcre_ca.frames(x, RULE, [1.0]),
    "times": lambda x: bcre_ca.frames(PILE, RULE, x),
    "step": lambda x: bcre_ca.frames(PILE, RULE, [1.0], step=x),
    "margin": lambda x: bcre_ca.frames(PILE, RULE, [1.0], margin=x),
    "steps": lambda x: bcre_ca.evolve(PILE.h, PILE.R, RULE, x),
    "frozen": lambda x: bcre_ca.evolve(PILE.h, PILE.R, RULE, 1, frozen=x),
    "sources": lambda x: bcre_ca.frames(PILE, RULE, [1.0], sources=x),
    "supply": lambda x: bcre_ca.step(PILE.h, PILE.R, RULE, supply=x),
}


@pytest.mark.parametrize("name", ARGUMENTS)
@pytest.mark.parametrize("value", ["Periodic", -1, float("nan"), [None], 1j])
def test_a_wrong_argument_is_named(name, value):
    with pytest.raises(ValueError, match=rf"^{name}\b"):
        ARGUMENTS[name](value)


@pytest.mark.parametrize("ends", ["Periodic", None, 0])
def test_ends_are_never_taken_for_open(ends):
    for run in (bcre_ca.march, bcre_ca.evolve):
        with pytest.raises(ValueError, match="ends = "):
            run(np.ones(N), np.ones(N), RULE, 1, ends)
    with pytest.raises(ValueError, match="ends = "):
        bcre_ca.step(np.ones(N), np.ones(N), RULE, ends)


any_layer = st.one_of(
    st.sampled_from(list(WRONG.values()) + list(RIGHT.values())),
    st.lists(st.floats(width=32) | st.integers(-3, 3), max_size=N),
)


def refusal_of(run, *layers):
    """What a run says that refuses its layers; nothing where it takes them."""
    try:
        with np.errstate(invalid="ignore"):  # a step takes infinite layers too
            run(*layers)
    except (ValueError, FloatingPointError) as refused:
        return str(refused)
    return ""


@given(any_layer, any_layer, st.sampled_from(sorted(ON_A_LINE)))
def test_no_pair_of_layers_crashes_or_fails_without_a_name(h, R, entry):
    refusal = refusal_of(ON_A_LINE[entry], h, R)
    assert not refusal or refusal.startswith(("h ", "R ", "dt = ", "the avalanche outgrew"))


ON_A_PLANE = {
    "evolve": lambda h, R: plane.evolve(h, R, FLAT, 3),
    "step": lambda h, R: plane.step(h, R, FLAT),
    "frames": lambda h, R: list(plane.frames(plane.Sand(h, R), FLAT, [0.5])),
}


@given(any_layer, any_layer, st.sampled_from(sorted(ON_A_PLANE)))
def test_no_pair_of_layers_of_a_plane_crashes_or_fails_without_a_name(h, R, entry):
    with pytest.raises(ValueError, match=r"^[hR] "):  # none of them is of rank 2
        ON_A_PLANE[entry](h, R)


def test_refusal_of_a_step_survives_a_worker():
    with pytest.raises(UnstableStep) as refused:
        replace(RULE, dt=50.0).require_stable()
    again = pickle.loads(pickle.dumps(refused.value))
    assert str(again) == str(refused.value)
    assert (again.dt, again.largest) == (refused.value.dt, refused.value.largest)


def test_piles_are_equal_where_all_that_they_hold_is():
    assert Pile(np.ones(N), np.ones(N)) == PILE
    assert replace(PILE, t=1.0) != PILE
    assert replace(PILE, R=np.zeros(N)) != PILE
    assert (PILE == "a pile") is False


def test_an_unstable_march_goes_on_from_the_negative_layer_that_it_made():
    pile = bcre_ca.Pile(np.linspace(5.0, 0.0, 6), np.array([0.0, 0.1, -0.1, 0.0, 0.0, 0.0]))
    rule = bcre_ca.Rule(v=0.1, D=0.1, gamma=0.01, Sc=0.5, d=1.0, dt=0.5)
    assert bcre_ca.advance(pile, rule, 2).R.min() < 0
