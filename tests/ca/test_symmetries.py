"""What all schemes share: steadiness at repose, no place and no unit preferred."""

from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from bcre_ca import Pile, Rule, advance

RULE = Rule(v=0.2, D=0.1, gamma=0.05, Sc=0.7, d=0.5, dt=0.2)


def with_terms(form, **changes):
    return replace(RULE, **form.options(kappa=0.03), **changes)


def test_uniform_layer_on_the_repose_slope_is_steady_to_rounding(synchronous):
    h0, R0 = -0.7 * 0.5 * np.arange(200), np.full(200, 3.0)
    end = advance(Pile(h0, R0), with_terms(synchronous), 60, synchronous.ends)
    # What the closed top lets dry out has come 60 cells down by then.
    assert np.abs(end.h - h0)[61:].max() < 1e-11
    assert np.abs(end.R - R0)[61:].max() < 1e-11


def test_no_sand_rolling_changes_no_surface(form):
    h0 = np.random.default_rng(0).uniform(-9, 9, 50)
    end = advance(Pile(h0, np.zeros(50)), with_terms(form), 60, form.ends)
    assert end.h.tobytes() == h0.tobytes()
    assert not end.R.any()


@settings(max_examples=15)
@given(seed=st.integers(0, 1000), shift=st.integers(0, 150), steps=st.integers(1, 70))
def test_pile_moved_by_whole_cells_moves_along_to_the_bit(synchronous, seed, shift, steps):
    """A bit-exact surface needs Sc = 0. Open ends count as long as they are far from the sand."""
    cells, wet = (400, slice(80, 120)) if synchronous.ends == "open" else (150, slice(0, 75))
    rng = np.random.default_rng(seed)
    h, R = np.zeros(cells), np.zeros(cells)
    h[wet], R[wet] = rng.uniform(-1, 1, h[wet].size), rng.uniform(0, 4, h[wet].size)
    rule = with_terms(synchronous, Sc=0.0)
    moved = advance(Pile(np.roll(h, shift), np.roll(R, shift)), rule, steps, synchronous.ends)
    end = advance(Pile(h, R), rule, steps, synchronous.ends)
    assert np.roll(end.h, shift).tobytes() == moved.h.tobytes()
    assert np.roll(end.R, shift).tobytes() == moved.R.tobytes()


@settings(max_examples=10)
@given(seed=st.integers(0, 1000), length=st.integers(-9, 9), time=st.integers(-9, 9))
def test_other_units_of_length_and_time_give_the_same_layers_to_the_bit(form, seed, length, time):
    """Units by powers of two, which round nothing: h, R and dry times a, v times a/b and so on."""
    a, b = 2.0**length, 2.0**time
    rng = np.random.default_rng(seed)
    h, R = rng.uniform(-1, 1, 90) - 0.35 * np.arange(90), rng.uniform(0, 4, 90)
    R[40:] = 0.0
    rule = with_terms(form)
    scaled = replace(
        rule,
        v=rule.v * a / b,
        D=rule.D * a * a / b,
        gamma=rule.gamma / b,
        kappa=rule.kappa * a / b,
        v_up=rule.v_up * a / b,
        dry=rule.dry * a,
        d=rule.d * a,
        dt=rule.dt * b,
    )
    end = advance(Pile(h, R), rule, 70, form.ends)
    other = advance(Pile(a * h, a * R), scaled, 70, form.ends)
    assert (a * end.h).tobytes() == other.h.tobytes()
    assert (a * end.R).tobytes() == other.R.tobytes()
    assert other.outflow == a * a * end.outflow
    assert other.t == b * end.t
