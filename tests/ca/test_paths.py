"""Every path of the compiled automaton gives the bits of the plain step."""

import math
from dataclasses import replace

import numba
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bcre_ca import (
    BLOCK,
    Pile,
    Rule,
    UnstableStep,
    evolve,
    evolve_many,
    march,
    stepped_cells,
)
from bcre_ca.line import kernels
from bcre_ca.line.kernels import sweep

RULE = Rule(v=0.3, D=0.1, gamma=0.02, Sc=0.6, d=0.7, dt=0.3)


def rough(cells, rule=RULE):
    rng = np.random.default_rng(cells)
    h = rng.uniform(-1, 1, cells) - rule.Sc * rule.d * np.arange(cells)
    return h, rng.uniform(0, 5, cells)


def assert_same(found, expected):
    """Layers to the bit; what left was summed in another order."""
    assert found[0].tobytes() == expected[0].tobytes()
    assert found[1].tobytes() == expected[1].tobytes()
    assert found[2:] == pytest.approx(expected[2:], rel=1e-13)


def marched(h, R, rule, steps, ends):
    h, R, account = h.copy(), R.copy(), np.zeros(2)
    kernels.march(h, R, rule, steps, ends, account)
    return h, R, float(account[0])


@settings(max_examples=40)
@given(data=st.data(), cells=st.integers(1, 40), steps=st.integers(0, 40))
def test_compiled_steps_equal_plain_steps_to_the_bit(
    form, rules, piles, gentle, plain_march, data, cells, steps
):
    rule = data.draw(rules(form))
    h, R = data.draw(piles(cells, rule))
    rule = gentle(rule, h, R, form.ends)
    expected = plain_march(h, R, rule, steps, form.ends)
    assert_same(marched(h, R, rule, steps, form.ends), expected)


@pytest.mark.parametrize("options", [{}, {"sign": "printed", "order": "left"}], ids=["", "printed"])
def test_compiled_steps_equal_plain_steps_to_the_bit_at_every_size(form, plain_march, options):
    """Sizes round the width of a vector register, where a compiler's peeled loop would show."""
    if form.synchronous:
        options = {"sign": options.get("sign", "consistent")}
    rule = replace(RULE, **(form.options() | options))
    for cells in (1, 2, 3, 4, 5, 8, 17, 64, 1001):
        h, R = rough(cells)
        expected = plain_march(h, R, rule, 25, form.ends)
        assert_same(marched(h, R, rule, 25, form.ends), expected)


@settings(max_examples=6)
@given(data=st.data(), cells=st.integers(140, 500), steps=st.integers(1, 2 * BLOCK + 3))
def test_wet_window_wherever_it_lies_leaves_out_nothing(
    synchronous, rules, piles, gentle, plain_march, data, cells, steps
):
    rule = data.draw(rules(synchronous))
    h, R = data.draw(piles(cells, rule))
    rule = gentle(rule, h, R, synchronous.ends)
    expected = plain_march(h, R, rule, steps, synchronous.ends)
    assert_same(marched(h, R, rule, steps, synchronous.ends), expected)


@pytest.mark.parametrize("steps", [BLOCK, BLOCK + 1])
def test_one_wet_cell_spreads_as_by_plain_steps_however_near_the_ends(
    synchronous, plain_march, steps
):
    """The window of a block is the wet cell and 66 more on either side."""
    rule = replace(RULE, **synchronous.options(dry=1e-30))
    h, _ = rough(200)
    for wet in (0, 1, 65, 66, 67, 132, 133, 134, 199):
        R = np.zeros(200)
        R[wet] = 3.0
        expected = plain_march(h, R, rule, steps, synchronous.ends)
        assert_same(marched(h, R, rule, steps, synchronous.ends), expected)


def test_steps_in_one_call_equal_steps_one_by_one_to_the_bit(form):
    rule, (h, R) = replace(RULE, **form.options()), rough(30)
    whole, single = (h.copy(), R.copy()), (h.copy(), R.copy())
    march(*whole, rule, 57, form.ends)
    for _ in range(57):
        march(*single, rule, 1, form.ends)
    assert_same(whole, single)


def test_pile_at_rest_stays_as_it_is_and_costs_no_steps(form):
    """A thousand million steps: without the window this would take minutes."""
    rule = replace(RULE, **form.options())
    h, R = rough(1000)[0], np.zeros(1000)
    at_rest = h.copy()
    assert march(h, R, rule, 10**9, form.ends) == 0
    assert h.tobytes() == at_rest.tobytes()
    assert not R.any()


def test_stepped_cells_are_the_wet_ones_and_those_that_a_block_can_reach():
    R = np.zeros(400)
    assert stepped_cells(R) == 0
    R[[200, 209]] = 1.0
    assert stepped_cells(R) == 10 + 2 * 66
    R[0] = 1.0
    assert stepped_cells(R) == 210 + 66
    assert stepped_cells(np.ones(400)) == 400


@pytest.fixture(scope="module")
def small_tiles():
    """The tiled sweep compiled anew for tiles of 9 cells and up to 5 steps together."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sweep, "TILE", 9)
        patch.setattr(sweep, "TILE_STEPS", 5)
        tiled = numba.njit(error_model="numpy")(sweep._tiled)
        tiled(*rough(20), TILED.coefficients(), 1, np.zeros(2))
    return tiled


TILED = replace(RULE, scheme="calibrated", kappa=0.02, v_up=1.5, dry=1e-3)


def test_tiles_equal_plain_steps_whatever_their_edges_cut(small_tiles, plain_march):
    for steps in (0, 1, 4, 5, 6, 13):
        for cells in range(2, 31):
            h, R = rough(cells)
            expected = plain_march(h, R, TILED, steps, "open")
            account = np.zeros(2)
            small_tiles(h, R, TILED.coefficients(), steps, account)
            assert_same((h, R, account[0]), expected)


@pytest.mark.parametrize("beyond", [-33, -32, -1, 0, 1, 2, 31, 32, 33])
def test_tiles_of_the_size_in_use_equal_plain_steps(plain_march, beyond):
    cells = math.ceil(sweep.TILE_FROM / sweep.TILE + 1) * sweep.TILE + beyond
    h, R = rough(cells)
    steps = sweep.TILE_STEPS + 2
    assert_same(marched(h, R, RULE, steps, "open"), plain_march(h, R, RULE, steps, "open"))


MANY = [
    (np.float64, {"scheme": "limited", "kappa": 0.02, "v_up": 1.5}, "periodic"),
    (np.float32, {}, "open"),
]


@pytest.mark.parametrize(("number", "options", "ends"), MANY, ids=["limited", "upwind, single"])
@settings(max_examples=12)
@given(piles=st.integers(1, 9), cells=st.integers(1, 300), seed=st.integers(0, 1000))
def test_many_piles_are_each_evolved_as_one(number, options, ends, piles, cells, seed):
    rng, rule = np.random.default_rng(seed), replace(RULE, **options, dt=0.2)
    h, R = rng.uniform(-1, 1, (piles, cells)), rng.uniform(0, 5, (piles, cells))
    h -= rule.Sc * rule.d * np.arange(cells)
    R *= rng.random((piles, 1)) < 0.8
    R[:, : cells // 2] = 0.0
    h, R = h.astype(number), R.astype(number)
    before = h.tobytes(), R.tobytes()
    together = evolve_many(h, R, rule, 70, ends)
    assert (h.tobytes(), R.tobytes()) == before
    assert {layer.dtype for layer in together} == {np.dtype(number)}
    for pile in range(piles):
        alone = evolve(h[pile], R[pile], rule, 70, ends)
        assert_same((together[0][pile], together[1][pile]), alone)


KINDS = [{}, {"D": 0.0}, {"scheme": "limited"}, {"order": "left"}, {"order": "right"}]


@pytest.mark.parametrize("ends", ["open", "periodic"])
@settings(max_examples=4)
@given(seed=st.integers(0, 1000), cells=st.integers(2, 150))
def test_many_piles_with_a_rule_each_are_each_evolved_as_one(ends, seed, cells):
    rng = np.random.default_rng(seed)
    kinds = rng.permutation(KINDS * 2)
    dts = rng.uniform(0.05, 0.2, len(kinds))
    rules = [
        replace(RULE, gamma=RULE.gamma * rng.uniform(0.5, 1), dt=dt, **kind)
        for kind, dt in zip(kinds, dts, strict=True)
    ]
    h, R = (np.stack([layer] * len(rules)) for layer in rough(cells))
    h, R = 0.1 * h, R * rng.uniform(0, 0.5, (len(rules), 1))
    together = evolve_many(h, R, rules, 70, ends)
    for i, rule in enumerate(rules):
        assert_same((together[0][i], together[1][i]), evolve(h[i], R[i], rule, 70, ends))


def test_one_unstable_rule_of_many_is_refused_as_it_is_alone():
    h, R = (np.stack([layer] * 3) for layer in rough(50))
    rules = [replace(RULE, dt=dt) for dt in (0.1, 50.0, 0.1)]
    with pytest.raises(UnstableStep, match="dt = 50 cannot be stable"):
        evolve_many(h, R, rules, 10)
    with pytest.raises(ValueError, match="there are 2 for 3 piles; must be as many"):
        evolve_many(h, R, rules[:2], 10)


@pytest.mark.parametrize("ends", ["open", "periodic"])
def test_printed_rule_in_single_precision_equals_its_plain_steps_to_the_bit(plain_march, ends):
    h, R = (layer.astype(np.float32) for layer in rough(300))
    expected = plain_march(h, R, RULE, 70, ends)
    assert expected[0].dtype == expected[1].dtype == np.float32
    assert_same(marched(h, R, RULE, 70, ends), expected)


def test_layers_of_unlike_precision_are_taken_in_double():
    h, R = rough(20)
    new_h, new_R = evolve(h, R.astype(np.float32), RULE, 3)
    assert new_h.dtype == new_R.dtype == np.float64


@settings(max_examples=30)
@given(data=st.data(), cells=st.integers(1, 60), steps=st.integers(0, 40))
def test_compiled_steps_on_a_frozen_slope_equal_plain_steps_to_the_bit(
    freezable, rules, piles, gentle, plain_march, data, cells, steps
):
    rule = data.draw(rules(freezable))
    h, R = data.draw(piles(cells, rule))
    frozen = h + np.linspace(0, 1, cells)
    rule = gentle(rule, frozen, R, freezable.ends)
    expected = plain_march(h, R, rule, steps, freezable.ends, frozen)
    kernels.march_frozen(h, R, rule, steps, freezable.ends, frozen)
    assert_same((h, R), expected[:2])


def test_frozen_slope_is_the_rule_for_one_step_and_stays_that_of_the_start():
    h, R = rough(80)
    for ends in ("open", "periodic"):
        assert_same(evolve(h, R, RULE, 1, ends, frozen=h), evolve(h, R, RULE, 1, ends))
        once = evolve(h, R, RULE, 9, ends, frozen=h)
        twice = evolve(*evolve(h, R, RULE, 4, ends, frozen=h), RULE, 5, ends, frozen=h)
        assert_same(twice, once)
        assert not np.array_equal(once[1], evolve(h, R, RULE, 9, ends)[1])
    # Linear in R: a layer twice as thick stays so.
    assert (
        evolve(h, 2 * R, RULE, 9, frozen=h)[1].tobytes()
        == (2 * evolve(h, R, RULE, 9, frozen=h)[1]).tobytes()
    )


def test_frozen_slope_bounds_the_step_by_its_own_deficit_and_not_by_the_layer():
    h = -0.6 * 0.7 * np.arange(50)
    thick = np.full(50, 1e3)
    new_h, _ = evolve(h, thick, replace(RULE, gamma=0.5), 10, frozen=h)
    assert np.isfinite(new_h).all()
    with pytest.raises(ValueError, match="cannot be stable: v dt/d"):
        evolve(h, thick, replace(RULE, gamma=0.5, dt=0.9), 1, frozen=10 * h[::-1])


@pytest.mark.parametrize("options", [{"scheme": "limited"}, {"order": "left"}])
def test_frozen_slope_is_for_the_synchronous_upwind_rule_only(options):
    rule, (h, R) = replace(RULE, **options), rough(5)
    with pytest.raises(ValueError, match="a frozen slope is defined for the synchronous upwind"):
        evolve(h, R, rule, 1, frozen=h)


def test_frozen_surface_has_the_shape_of_the_layers():
    h, R = rough(5)
    with pytest.raises(ValueError, match=r"frozen has shape \(4,\): must be that of h, \(5,\)"):
        evolve(h, R, RULE, 1, frozen=h[1:])


def test_layer_that_outgrows_all_numbers_on_a_frozen_slope_is_refused():
    h, R = rough(50)
    with pytest.raises(FloatingPointError, match="outgrew all numbers on the frozen slope"):
        evolve(h, R, replace(RULE, gamma=2.0), 5000, frozen=-9.0 * np.arange(50))


def test_mass_holds_over_many_steps_with_outflow(open_form):
    rule = Rule(0.5, 0.1, 0.02, 0.4, 1.0, 0.4)
    rule = replace(rule, **open_form.options(kappa=1e-6, v_up=1e9, dry=1e-12))
    h, R = 0.6 * np.arange(200.0)[::-1], rough(200)[1]
    before = Pile(h, R).mass(1.0)
    outflow = march(h, R, rule, 20_000, "open")
    assert outflow > 100
    assert abs(Pile(h, R).mass(1.0) + outflow - before) <= 1e-12 * before
