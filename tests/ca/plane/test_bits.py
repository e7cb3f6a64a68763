"""Every path of the compiled plane gives the bits of the plain step."""

from dataclasses import replace

import numpy as np
import pytest

from bcre_ca import step as step_of_line
from bcre_ca.plane import Plane, Run, Sand, evolve
from bcre_ca.plane import run as run_module
from bcre_ca.plane import step as plain_step

FLOWS = ("tilted", "split4", "facet8", "d8")


def assert_same(run, expected, sand, plane):
    h, R, lost = expected
    assert run.h.tobytes() == h.tobytes()
    assert run.R.tobytes() == R.tobytes()
    end = run.sand()
    scale = plane.rule.d**2 * (np.abs(sand.h).sum() + sand.R.sum() + end.R.sum())
    assert end.outflow - sand.outflow == pytest.approx(lost, rel=1e-12, abs=1e-14 * scale)
    gained = (end.volume(plane) + end.outflow - end.inflow) - sand.volume(plane)
    assert abs(gained) <= 1e-12 * scale


@pytest.mark.parametrize("part", range(3))
@pytest.mark.parametrize("flow", FLOWS)
def test_compiled_steps_equal_plain_steps_and_keep_mass(scene, plain_march, rng, flow, part):
    for _ in range(25):
        sand, plane = scene(rng, flow)
        steps = int(rng.integers(0, 25))
        run = Run(sand, plane, threads=1)
        run.take(steps)
        assert_same(run, plain_march(sand, plane, steps), sand, plane)


@pytest.mark.parametrize("sides", ["closed", "periodic"])
@pytest.mark.parametrize("ends", ["open", "closed", "periodic"])
@pytest.mark.parametrize("shape", [(1, 1), (1, 5), (5, 1), (2, 2), (3, 16), (9, 33)])
def test_plane_without_walls_equals_plain_steps(plain_march, rng, shape, ends, sides, rule):
    h = rng.normal(size=shape) - 0.42 * np.arange(shape[0])[:, None]
    sand, plane = Sand(h, rng.random(shape)), Plane(rule, D_across=0.2, ends=ends, sides=sides)
    run = Run(sand, plane)
    run.take(19)
    assert_same(run, plain_march(sand, plane, 19), sand, plane)


@pytest.mark.parametrize("flow", FLOWS[:3])
def test_slabs_of_several_threads_equal_plain_steps(scene, plain_march, rng, flow, monkeypatch):
    monkeypatch.setattr(run_module, "SHARED_FROM", 0)
    for threads in (2, 3, 5):
        for _ in range(3):
            shape = int(rng.integers(60, 260)), int(rng.integers(1, 20))
            sand, plane = scene(rng, flow, shape, str(rng.choice(["open", "closed"])))
            run = Run(sand, plane, threads)
            run.take(13)
            assert_same(run, plain_march(sand, plane, 13), sand, plane)


@pytest.mark.parametrize("flow", FLOWS[:3])
def test_window_about_a_small_avalanche_leaves_out_nothing(
    plain_march, rng, flow, rule, thick_rule
):
    """Whatever its place; here in the corners, at the sides and in the middle."""
    for place in ((0, 0), (59, 69), (30, 0), (0, 35), (59, 35), (31, 33)):
        h, R = rng.normal(size=(60, 70)), np.zeros((60, 70))
        R[place] = 0.1
        walls = np.zeros(h.shape, bool)
        for sides in ("closed", "periodic"):
            sand = Sand(h, R)
            rule = thick_rule if flow == "tilted" else rule
            plane = Plane(replace(rule, dt=0.1), flow, sides=sides, walls=walls)
            run = Run(sand, plane)
            run.take(17)
            assert_same(run, plain_march(sand, plane, 17), sand, plane)


def test_steps_in_one_call_equal_steps_one_by_one(scene, rng):
    for flow in FLOWS[:3]:
        sand, plane = scene(rng, flow)
        together, one_by_one = Run(sand, plane), Run(sand, plane)
        together.take(45)
        for _ in range(45):
            one_by_one.take(1)
        assert together.h.tobytes() == one_by_one.h.tobytes()
        assert together.R.tobytes() == one_by_one.R.tobytes()
        assert together.t == one_by_one.t


def test_thin_layers_at_rest_and_saturated_exchange_equal_plain_steps(plain_march, rng, thick_rule):
    h = rng.normal(size=(20, 30)) - 0.42 * np.arange(20)[:, None]
    sand = Sand(h, rng.random((20, 30)))
    plane = Plane(replace(thick_rule, dry=0.05), base=h - 1)
    run = Run(sand, plane)
    run.take(40)
    assert_same(run, plain_march(sand, plane, 40), sand, plane)
    assert (run.R == 0).any()


def test_single_precision_is_kept_and_equals_its_plain_steps(rng, rule):
    h = (rng.normal(size=(20, 30)) - 0.42 * np.arange(20)[:, None]).astype(np.float32)
    R = rng.random((20, 30)).astype(np.float32)
    found = evolve(h, R, Plane(rule), 30)
    expected = h, R
    for _ in range(30):
        expected = plain_step(*expected, Plane(rule))[:2]
    for one, other in zip(found, expected, strict=True):
        assert one.dtype == other.dtype == np.float32
        assert one.tobytes() == other.tobytes()


def test_sand_at_rest_costs_no_steps(rng, rule):
    """A thousand million steps: without the window this would take hours."""
    h = rng.normal(size=(100, 100))
    found = evolve(h, np.zeros_like(h), Plane(rule), 10**9)
    assert found[0].tobytes() == h.tobytes()
    assert not found[1].any()


def test_one_row_of_the_plane_is_the_line_to_the_bit(rng, rule):
    """Columns that are all alike do as the automaton on a line does."""
    h = rng.normal(size=80) - 0.42 * np.arange(80)
    R = rng.random(80)
    for ends in ("open", "periodic"):
        line = h, R
        for _ in range(50):
            line = step_of_line(*line, rule, ends)[:2]
        both = (np.tile(layer[:, None], 7) for layer in (h, R))
        for one, other in zip(evolve(*both, Plane(rule, ends=ends), 50), line, strict=True):
            assert (one == other[:, None]).all()
