"""Following the bounds, and what is seen on the way."""

from dataclasses import replace

import numpy as np
import pytest

from bcre_ca import Rule
from bcre_ca.plane import MARGIN, Plane, Run, Sand, Source, advance, evolve, frames

SLOPE = -1.5 * np.arange(50)[:, None] * np.ones(30)


def avalanche(rule, **options):
    R = np.zeros_like(SLOPE)
    R[10:14, 12:16] = 2.0
    return Sand(SLOPE, R), Plane(replace(rule, gamma=0.1, d=1.0, dt=0.4), **options)


def poured(rule, flow="split4"):
    """A heap poured before a wall on a thin layer, until it runs out of the open foot."""
    walls = np.zeros((20, 16), bool)
    walls[9, 4:9] = True
    sources = (Source(4.0, (5.0, 8.0), 4.0, (3.0, 40.0)),)
    plane = Plane(replace(rule, v=1.0, d=1.0), flow, walls=walls, base=0.0, sources=sources)
    return Sand(np.full((20, 16), 0.01), np.zeros((20, 16))), plane


@pytest.mark.parametrize("step", ["auto", 0.25])
@pytest.mark.parametrize("make", [avalanche, poured])
def test_steps_do_not_depend_on_the_times_that_are_asked_for(make, step, rule):
    sand, plane = make(rule)
    seldom = list(frames(sand, plane, [30.0, 60.0], step))
    often = list(frames(sand, plane, np.linspace(0, 60, 61), step))
    for one, other in zip(seldom, (often[30], often[60]), strict=True):
        assert one.h.tobytes() == other.h.tobytes()
        assert one.R.tobytes() == other.R.tobytes()
        assert (one.t, one.steps, one.outflow) == (other.t, other.steps, other.outflow)


@pytest.mark.parametrize("make", [avalanche, poured])
def test_frames_keep_mass_and_signs_between_steps(make, rule):
    sand, plane = make(rule)
    before = sand.volume(plane)
    for end in frames(sand, plane, np.linspace(0.03, 55.7, 40)):
        balance = end.volume(plane) + end.outflow - end.inflow - before
        assert abs(balance) <= 1e-12 * abs(before)
        assert end.R.min() >= 0
        if plane.base is not None:
            assert end.h[~plane.walls].min() >= 0
    assert end.outflow > 0


def test_source_pours_its_rate_times_its_time_however_the_steps_fall(rule):
    sand, plane = poured(rule)
    for time, volume in ((2.9, 0.0), (13.0, 40.0), (40.1, 148.0), (50.0, 148.0)):
        assert next(iter(frames(sand, plane, [time]))).inflow == pytest.approx(volume, abs=0.5)
    assert next(iter(frames(sand, plane, [50.0]))).inflow == pytest.approx(148.0, rel=1e-13)
    assert next(iter(frames(sand, plane, [50.0], 0.21))).inflow == pytest.approx(148.0, rel=1e-13)


def test_frames_of_a_fixed_step_at_its_ends_are_those_of_evolve(rule):
    sand, plane = avalanche(rule)
    for end, steps in zip(frames(sand, plane, [0.0, 2.0, 8.0], 0.4), (0, 5, 20), strict=True):
        h, R = evolve(sand.h, sand.R, plane, steps)
        assert end.h.tobytes() == h.tobytes()
        assert end.R.tobytes() == R.tobytes()
        assert end.steps == steps


def test_frame_between_two_steps_lies_on_the_line_between_them(rule):
    sand, plane = avalanche(rule)
    found = next(frames(sand, plane, [2.1], 0.4))
    ends = [advance(sand, plane, steps) for steps in (5, 6)]
    assert pytest.approx(0.75 * ends[0].R + 0.25 * ends[1].R, abs=1e-12) == found.R


def test_followed_step_shortens_as_the_avalanche_grows(rule):
    sand, plane = avalanche(rule)
    first = Run(sand, plane).largest_stable_step()
    end = next(iter(frames(sand, plane, [60.0])))
    assert end.lowered > 0
    assert end.steps > 60.0 / (MARGIN * first)
    assert end.R.max() > 4 * sand.R.max()


def test_block_that_outgrew_its_step_is_taken_again_in_shorter_ones():
    """A layer that grows a thousandfold within one block."""
    rule = Rule(v=0.1, D=0.01, gamma=0.5, Sc=0.5, d=1.0, dt=1.0)
    h = -5.5 * np.arange(40)[:, None] * np.ones(10)
    sand, plane = Sand(h, np.full_like(h, 0.01)), Plane(rule)
    end = next(iter(frames(sand, plane, [3.0])))
    assert end.redone > 0
    assert end.R.min() >= 0
    assert end.R.max() > 500 * sand.R.max()
    balance = end.volume(plane) + end.outflow - sand.volume(plane)
    assert abs(balance) <= 1e-12 * np.abs(h).sum()


def test_avalanche_on_a_large_plane_costs_what_it_wets(rule):
    """Its windows hold few of the cells, whatever the plane's size."""
    h = -1.5 * np.arange(400)[:, None] * np.ones(600)
    R = np.zeros_like(h)
    R[100, 300] = 1.0
    run = Run(Sand(h, R), Plane(rule), threads=1)
    run.take(40)
    wet = np.count_nonzero(run.R)
    lo, hi = run._work.windows
    assert wet <= np.maximum(hi - lo, 0).sum() <= 3 * wet
    assert wet < 0.05 * h.size


def test_state_that_is_looked_at_cannot_be_written(rule):
    run = Run(*avalanche(rule))
    with pytest.raises(ValueError, match="read-only"):
        run.R[0, 0] = 1.0


def test_base_bares_where_the_layer_is_gone(thick_rule):
    """On a thin layer the avalanche leaves the slope as it was, S0 and not Sc."""
    sand, plane = avalanche(replace(thick_rule, v_up=1e9, dry=1e-12), base=SLOPE - 0.05)
    end = next(iter(frames(sand, plane, [80.0])))
    bared = np.isclose(end.h, SLOPE - 0.05, atol=1e-12)
    assert 30 < bared.sum() < 1000
    assert (end.h >= SLOPE - 0.05).all()
