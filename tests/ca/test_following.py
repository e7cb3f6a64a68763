"""A step that follows its bounds, and a fixed one that is outgrown."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bcre_ca import (
    BLOCK,
    MARGIN,
    Pile,
    Rule,
    advance,
    evolve,
    evolve_many,
    frames,
    largest_stable_step,
    march,
    step,
)

FIGURE_1 = Rule(v=0.1, D=0.1, gamma=0.01, Sc=0.5, d=1.0, dt=1.0)
TERMS = {"kappa": 1e-4, "v_up": 1e2, "dry": 1e-90}
CALIBRATED = {"scheme": "calibrated"} | TERMS
LIMITED = {"scheme": "limited", "D": 0.0} | TERMS
SCHEMES = pytest.mark.parametrize(
    "options", [{}, CALIBRATED, LIMITED], ids=["upwind", "calibrated", "limited"]
)


@SCHEMES
@pytest.mark.parametrize("d", [0.7, 2.640695197746448])
def test_followed_steps_are_the_fixed_ones_to_the_bit_where_the_bound_stays(options, d):
    """Layers so thin that the surface stays as it is. Of the second d, d**2 is not d d."""
    rule = replace(FIGURE_1, d=d, **options)
    h = -1 - 2.5 * d * np.arange(300)
    R = 1e-60 * np.random.default_rng(5).uniform(0, 1, 300)
    R[:150] = 0.0
    dt = MARGIN * largest_stable_step(Pile(h, R), rule, "open")
    fixed = h.copy(), R.copy()
    outflow = march(*fixed, replace(rule, dt=dt), 3 * BLOCK, "open")
    (followed,) = frames(Pile(h, R), rule, [3 * BLOCK * dt])
    assert (followed.steps, followed.lowered, followed.raised) == (3 * BLOCK, 0, 0)
    assert followed.outflow == pytest.approx(d * outflow, rel=1e-15)
    assert followed.outflow > 0
    assert followed.h.tobytes() == fixed[0].tobytes()
    assert followed.R.tobytes() == fixed[1].tobytes()


@SCHEMES
def test_figure_1_lowers_its_step_as_it_grows_and_stays_under_the_bound(figure_1, options):
    """A step is no longer than the bound at its block's end. Without D little climbs."""
    rule = replace(FIGURE_1, **options)
    piles = list(frames(figure_1, rule, np.linspace(4, 800, 200)))
    bounds = [largest_stable_step(pile, rule, "open") for pile in piles]
    for i in range(150):
        shortest = 100.0 / (piles[i + 25].steps - piles[i].steps + 1)
        assert shortest <= max(bounds[i : i + 50])
        assert piles[i].R.min() >= 0
    whole = piles[-1]
    assert whole.lowered >= (1 if rule.D == 0 else 6)
    assert whole.mass(1.0) + whole.outflow == pytest.approx(figure_1.mass(1.0), rel=1e-12)


def test_step_grows_again_when_the_avalanche_has_left(figure_1):
    (whole,) = frames(figure_1, FIGURE_1, [6000.0])
    assert whole.raised > 5
    bound = largest_stable_step(whole, FIGURE_1, "open")
    assert bound == pytest.approx(1 / 0.3, rel=0.01)


OUTGROWING = Rule(v=0.1, D=0.1, gamma=0.2, Sc=0.5, d=1.0, dt=1.0)


def outgrowing():
    """So steep that R grows by a tenth of a million within the first block."""
    x = np.arange(200) + 0.5
    return Pile(1.5 * (200 - x), 1e-3 * np.exp(-(((x - 150) / 3) ** 2)))


def test_block_that_is_outgrown_is_taken_again_and_harms_nothing():
    start = outgrowing()
    assert MARGIN * largest_stable_step(start, OUTGROWING, "open") > 2.6
    (end,) = frames(start, OUTGROWING, [150.0])
    assert end.redone > 0
    assert end.mass(1.0) + end.outflow == pytest.approx(start.mass(1.0), rel=1e-13)
    assert end.R.min() >= 0
    fine = advance(start, replace(OUTGROWING, dt=0.02), 7_500)
    assert np.abs(end.h - fine.h).sum() < 0.1 * np.abs(fine.h - start.h).sum()


def test_block_taken_again_leaves_no_trace_of_the_first_try():
    """What is kept is the march in the shorter steps, to the bit; outflow included."""
    start = outgrowing()
    start = replace(start, R=start.R + 1e-6)
    (first,) = frames(start, OUTGROWING, [1.0])
    assert first.redone > 0
    dt = MARGIN * largest_stable_step(start, OUTGROWING, "open") / 2**first.redone
    fixed = start.h.copy(), start.R.copy()
    outflow = march(*fixed, replace(OUTGROWING, dt=dt), BLOCK, "open")
    (end,) = frames(start, OUTGROWING, [BLOCK * dt])
    assert end.steps == BLOCK
    assert end.h.tobytes() == fixed[0].tobytes()
    assert end.R.tobytes() == fixed[1].tobytes()
    assert end.outflow == outflow
    assert dt <= largest_stable_step(end, OUTGROWING, "open")
    twice = start.h.copy(), start.R.copy()
    march(*twice, replace(OUTGROWING, dt=2 * dt), BLOCK, "open")
    assert not 2 * dt <= largest_stable_step(Pile(*twice), OUTGROWING, "open")


def test_calibrated_step_is_its_calibrating_step_where_the_bound_allows_it():
    """Figure 2 at d = 1: 0.368, above four fifths of the bound, 0.385."""
    rule = Rule(2.5, 0.1, 0.01, 0.5, 1.0, 1.0, **CALIBRATED)
    x = np.arange(100) + 0.5
    start = Pile(0.52 * (100 - x), 1e-3 * np.exp(-(((x - 20) / 4) ** 2)))
    bound = largest_stable_step(start, rule, "open")
    assert MARGIN * bound < rule.calibrating_step() < bound
    dt = rule.calibrating_step()
    (end,) = frames(start, rule, [50 * dt])
    assert end.steps == 50
    assert end.R.tobytes() == advance(start, replace(rule, dt=dt), 50).R.tobytes()
    assert replace(rule, dt=dt).effective_diffusion() == pytest.approx(0.1)


def test_smaller_margin_takes_as_much_shorter_steps(figure_1):
    whole, half = (
        next(frames(figure_1, FIGURE_1, [50.0], margin=margin)) for margin in (MARGIN, MARGIN / 2)
    )
    assert (whole.steps, half.steps) == (19, 38)


@settings(max_examples=40)
@given(data=st.data(), cells=st.integers(1, 20), until=st.floats(0.1, 50))
@pytest.mark.parametrize("index", [0, 7])
def test_followed_steps_keep_mass_and_sign_of_any_pile(
    forms, rules, piles, index, data, cells, until
):
    """Below 1e-300 the products of the rule round to multiples of 5e-324, of either sign."""
    rule, ends = replace(data.draw(rules(forms[index])), sign="consistent"), forms[index].ends
    start = Pile(*data.draw(piles(cells, rule)))
    (end,) = frames(start, rule, [until], ends)
    scale = rule.d * (np.abs(start.h).sum() + start.R.sum()) + 1e-300
    assert abs(end.mass(rule.d) + end.outflow - start.mass(rule.d)) <= 1e-12 * scale
    assert end.R.min() >= -1e-300
    assert end.t == until


def first_passed(start, rule, most, bound):
    """Time and cell after the first plain step at whose end dt exceeds the bound."""
    h, R = start.h, start.R
    for taken in range(1, most + 1):
        h, R, _ = step(h, R, rule)
        if rule.dt > bound(h, R, rule, "open") * (1 + 1e-12):
            return taken * rule.dt, int(np.argmax(R)), float(R.max())
    raise AssertionError("the bound was not passed")


@pytest.mark.parametrize("dt", [0.9, 1.2])
def test_fixed_step_that_is_outgrown_names_the_first_time_the_cell_and_the_bound(
    figure_1, dt, bound
):
    rule = replace(FIGURE_1, dt=dt)
    time, cell, largest_R = first_passed(figure_1, rule, 400, bound)
    told = (
        rf"^the avalanche outgrew the step at t = {time:.6g}, in cell {cell}: dt = {dt} cannot be "
        rf"stable: gamma R dt/d must not exceed 1 where R = {largest_R:.6g}; the largest stable "
        r"step is \d"
    )
    steps = round(time / dt)
    with pytest.raises(FloatingPointError, match=told):
        evolve(figure_1.h, figure_1.R, rule, steps + 20)
    with pytest.raises(FloatingPointError, match=told):
        list(frames(figure_1, rule, [dt * (steps + 20)], step=dt))
    h, R = (np.stack([np.zeros(100), layer]).astype("f4") for layer in (figure_1.h, figure_1.R))
    with pytest.raises(FloatingPointError, match=rf"at t = {time:.6g}, in cell {cell}:"):
        evolve_many(h, R, rule, steps + 20)
    evolve(figure_1.h, figure_1.R, rule, steps - 1)


def test_march_whose_layers_are_no_longer_finite_says_when_the_bound_was_passed(figure_1, bound):
    rule = replace(FIGURE_1, dt=1.5)
    time, cell, _ = first_passed(figure_1, rule, 400, bound)
    with pytest.raises(FloatingPointError, match=rf"at t = {time:.6g}, in cell {cell}:"):
        advance(figure_1, rule, 2000)


def test_counts_add_up_over_frames(figure_1):
    piles = list(frames(figure_1, FIGURE_1, [100.0, 300.0, 900.0]))
    for earlier, later in pairwise(piles):
        assert later.steps > earlier.steps
        assert later.lowered >= earlier.lowered
        assert later.redone >= earlier.redone
