"""Every path of the compiled automaton gives the bits of the plain step."""

from dataclasses import replace

import numba
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bcre_ca import Rule, evolve, kernels, step
from bcre_ca.kernels import BLOCK, march, sweep

RULE = Rule(v=0.3, D=0.1, gamma=0.02, Sc=0.6, d=0.7, dt=0.4)
ALL_TERMS = replace(RULE, scheme="calibrated", kappa=0.02, v_up=1.5, dry=1e-3)


def gentle(rule, h, R, bound, ends):
    """The rule with a dt in which no layer grows by more than a third a step."""
    d, drops = rule.d, np.abs(np.diff(h, append=h[0])) + abs(rule.Sc) * rule.d * h.size
    growth = rule.gamma * drops.max() / d + 2 * rule.kappa * drops.max() / d**2
    largest = bound(h, R, rule, ends)
    return replace(rule, dt=min(0.5 * largest, 0.3 / growth if growth > 0 else 10.0, 10.0))


def rough(cells, rule):
    rng = np.random.default_rng(cells)
    h = rng.uniform(-1, 1, cells) - rule.Sc * rule.d * np.arange(cells)
    return h, rng.uniform(0, 5, cells)


def assert_same(found, expected, outflow, lost):
    assert found[0].tobytes() == expected[0].tobytes()
    assert found[1].tobytes() == expected[1].tobytes()
    assert outflow == pytest.approx(lost, rel=1e-13)


@settings(max_examples=20)
@given(data=st.data(), cells=st.integers(1, 40), steps=st.integers(0, 40))
def test_compiled_steps_equal_plain_steps_to_the_bit(
    form, rules, piles, bound, plain_march, data, cells, steps
):
    rule = data.draw(rules(form))
    h, R = data.draw(piles(cells, rule))
    rule = gentle(rule, h, R, bound, form.ends)
    *expected, lost = plain_march(h, R, rule, steps, form.ends)
    outflow = march(h, R, rule, steps, form.ends)
    assert_same((h, R), expected, outflow, lost)


@settings(max_examples=6)
@given(data=st.data(), cells=st.integers(140, 500), steps=st.integers(1, 2 * BLOCK + 3))
def test_wet_window_wherever_it_lies_leaves_out_nothing(
    synchronous, rules, piles, bound, plain_march, data, cells, steps
):
    rule = data.draw(rules(synchronous))
    h, R = data.draw(piles(cells, rule))
    rule = gentle(rule, h, R, bound, synchronous.ends)
    *expected, lost = plain_march(h, R, rule, steps, synchronous.ends)
    outflow = march(h, R, rule, steps, synchronous.ends)
    assert_same((h, R), expected, outflow, lost)


@pytest.mark.parametrize("steps", [BLOCK, BLOCK + 1])
@pytest.mark.parametrize("wet", [0, 1, 65, 66, 67, 132, 133, 134, 199])
def test_one_wet_cell_spreads_as_by_plain_steps_however_near_the_ends(
    synchronous, plain_march, wet, steps
):
    """The window of a block is the wet cell and 66 more on either side."""
    rule = replace(RULE, **synchronous.options(kappa=0.02, v_up=1.5, dry=1e-30))
    rng = np.random.default_rng(1)
    h, R = rng.uniform(-1, 1, 200) - 0.42 * np.arange(200), np.zeros(200)
    R[wet] = 3.0
    *expected, lost = plain_march(h, R, rule, steps, synchronous.ends)
    outflow = march(h, R, rule, steps, synchronous.ends)
    assert_same((h, R), expected, outflow, lost)


def test_pile_at_rest_stays_as_it_is_and_costs_no_steps(form):
    """A thousand million steps: without the window this would take minutes."""
    rule = replace(RULE, **form.options(kappa=0.02, v_up=1.5, dry=1e-3))
    h, R = np.random.default_rng(2).uniform(-1, 1, 1000), np.zeros(1000)
    at_rest = h.copy()
    assert march(h, R, rule, 10**9, form.ends) == 0
    assert h.tobytes() == at_rest.tobytes()
    assert not R.any()


@pytest.fixture(scope="module")
def small_tiles():
    """The tiled sweep compiled anew for tiles of 9 cells and up to 5 steps together."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sweep, "TILE", 9)
        patch.setattr(sweep, "TILE_STEPS", 5)
        tiled = numba.njit(error_model="numpy")(sweep._tiled.py_func)
        tiled(*rough(20, ALL_TERMS), ALL_TERMS.coefficients(), 1, np.zeros(2))
    return tiled


@pytest.mark.parametrize("steps", [0, 1, 4, 5, 6, 13])
def test_tiles_equal_plain_steps_whatever_their_edges_cut(small_tiles, plain_march, steps):
    for cells in range(2, 31):
        h, R = rough(cells, ALL_TERMS)
        *expected, lost = plain_march(h, R, ALL_TERMS, steps, "open")
        account = np.zeros(2)
        small_tiles(h, R, ALL_TERMS.coefficients(), steps, account)
        assert_same((h, R), expected, account[0], lost)


@pytest.mark.parametrize("beyond", [-33, -32, -1, 0, 1, 2, 31, 32, 33])
@pytest.mark.parametrize("tiles", [1, 3])
def test_tiles_of_the_size_in_use_equal_plain_steps(plain_march, tiles, beyond):
    h, R = rough(tiles * sweep.TILE + beyond, RULE)
    steps = sweep.TILE_STEPS + 2
    *expected, lost = plain_march(h, R, RULE, steps, "open")
    account = np.zeros(2)
    sweep._tiled(h, R, RULE.coefficients(), steps, account)
    assert_same((h, R), expected, account[0], lost)


def test_pile_large_enough_for_tiles_equals_plain_steps(plain_march):
    h, R = rough(sweep.TILE_FROM + 100, RULE)
    found = evolve(h, R, RULE, 37)
    *expected, _ = plain_march(h, R, RULE, 37, "open")
    assert_same(found, expected, 0.0, 0.0)


LIMITED = replace(RULE, scheme="limited", dt=0.3)
BATCHES = [(RULE, "open"), (replace(LIMITED, kappa=0.02), "periodic")]


@pytest.mark.parametrize(("rule", "ends"), BATCHES, ids=["upwind", "limited"])
@settings(max_examples=12)
@given(scenes=st.integers(1, 9), cells=st.integers(1, 300), seed=st.integers(0, 1000))
def test_batch_equals_its_scenes_one_by_one(rule, ends, scenes, cells, seed):
    rng = np.random.default_rng(seed)
    h, R = rng.uniform(-1, 1, (scenes, cells)), rng.uniform(0, 5, (scenes, cells))
    h -= rule.Sc * rule.d * np.arange(cells)
    R *= rng.random((scenes, 1)) < 0.8
    R[:, : cells // 2] = 0.0
    together = h.copy(), R.copy()
    outflow, lost = march(*together, rule, 70, ends), 0.0
    for layers in zip(h, R, strict=True):
        lost += march(*layers, rule, 70, ends)
    assert_same(together, (h, R), outflow, lost)


def test_batch_keeps_an_account_of_outflow_for_each_scene():
    layers = [rough(50, RULE), rough(50, RULE), rough(50, RULE)]
    h, R = (np.stack(same) for same in zip(*layers, strict=True))
    R *= np.array([[1.0], [0.5], [0.0]])
    alone = [march(h[i].copy(), R[i].copy(), RULE, 70, "open") for i in range(3)]
    accounts = np.zeros((3, 2))
    kernels._batch(h, R, RULE.coefficients(), 70, accounts, None, None, None)
    assert accounts[:, 0].tolist() == alone
    assert alone[0] > alone[1] > alone[2] == 0


def test_evolve_takes_a_batch_and_leaves_its_inputs_alone():
    h, R = (np.stack(layers) for layers in zip(rough(50, RULE), rough(50, RULE), strict=True))
    R[1] *= 0.5
    before = h.tobytes(), R.tobytes()
    new_h, new_R = evolve(h, R, RULE, 30)
    assert (h.tobytes(), R.tobytes()) == before
    for scene in range(2):
        alone = evolve(h[scene], R[scene], RULE, 30)
        assert_same((new_h[scene], new_R[scene]), alone, 0.0, 0.0)


def in_single(layers):
    return tuple(layer.astype(np.float32) for layer in layers)


@pytest.mark.parametrize("ends", ["open", "periodic"])
def test_printed_rule_in_single_precision_equals_its_plain_steps_to_the_bit(plain_march, ends):
    h, R = in_single(rough(300, RULE))
    *expected, lost = plain_march(h, R, RULE, 70, ends)
    assert expected[0].dtype == expected[1].dtype == np.float32
    outflow = march(h, R, RULE, 70, ends)
    assert_same((h, R), expected, outflow, lost)


def test_batch_in_single_precision_equals_its_scenes_one_by_one():
    scenes = [in_single(rough(cells, RULE)) for cells in (40, 40, 40)]
    h, R = (np.stack(layers) for layers in zip(*scenes, strict=True))
    R *= np.array([[1], [0.5], [0]], np.float32)
    together = evolve(h, R, RULE, 70)
    assert together[0].dtype == together[1].dtype == np.float32
    for scene in range(3):
        alone = evolve(h[scene], R[scene], RULE, 70)
        assert_same((together[0][scene], together[1][scene]), alone, 0.0, 0.0)


def test_layers_of_unlike_precision_are_taken_in_double():
    h, R = rough(20, RULE)
    new_h, new_R = evolve(h, R.astype(np.float32), RULE, 3)
    assert new_h.dtype == new_R.dtype == np.float64


def test_limited_step_over_a_peak_is_the_formula_worked_by_hand():
    """v = 1, d = 1, dt = 1/4, no exchange: only the flux with its limited differences acts."""
    rule = Rule(v=1.0, D=0.0, gamma=0.0, Sc=0.0, d=1.0, dt=0.25, scheme="limited")
    R = np.array([0.0, 1.0, 3.0, 4.0, 3.0, 0.0])
    r = np.array([0.0, 1.5, 1.5, 0.0, -2.0, 0.0])
    face = R - 0.25 * r / 2 + r / 2
    flux_in = np.append(0.0, 0.25 * face[:-1])
    _, new_R, outflow = step(np.zeros(6), R, rule)
    assert new_R == pytest.approx(R + flux_in - 0.25 * face, abs=1e-15)
    assert outflow == 0.0
