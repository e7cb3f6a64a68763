"""What does not fit is refused where it enters, by name."""

import math
from dataclasses import replace

import numpy as np
import pytest

from bcre_ca import UnstableStep
from bcre_ca.plane import Plane, Run, Sand, Source, advance, evolve, frames, step
from bcre_ca.plane.theory import max_stable_step, opening_angle, opening_angle_on

H, R = np.zeros((4, 5)), np.ones((4, 5))

ENTRIES = {
    "evolve": lambda h, R, plane: evolve(h, R, plane, 1),
    "advance": lambda h, R, plane: advance(Sand(h, R), plane, 1),
    "frames": lambda h, R, plane: frames(Sand(h, R), plane, [1.0]),
    "run": lambda h, R, plane: Run(Sand(h, R), plane),
    "step": step,
}


def spoiled(layer, cell, value):
    changed = layer.copy()
    changed[cell] = value
    return changed


BAD_LAYERS = [
    (H[0], R[0], r"h has the shape \(5,\)"),
    (H[None], R[None], r"h has the shape \(1, 4, 5\)"),
    (H[:0], R[:0], r"h has the shape \(0, 5\)"),
    (H, R[:, :3], r"R has the shape \(4, 3\)"),
    (H.astype(int), R, "h has the type int64"),
    (H, R.astype(complex), "R has the type complex128"),
    (H.astype(np.float16), R, "h has the type float16"),
    (H.astype(object), R, "h has the type object"),
    (spoiled(H, (1, 2), np.nan), R, r"h = nan in cell \(1, 2\)"),
    (H, spoiled(R, (3, 4), np.inf), r"R = inf in cell \(3, 4\)"),
    (H, spoiled(R, (2, 0), -1e-3), r"R = -0.001 in cell \(2, 0\): must be >= 0"),
    (H, R.astype(np.float32), "R has the type float32: must be that of h, float64"),
]


@pytest.mark.parametrize("entry", ENTRIES)
@pytest.mark.parametrize(("h", "R", "message"), BAD_LAYERS)
def test_layers_are_checked_wherever_they_enter(entry, h, R, message, rule):
    with pytest.raises(ValueError, match=message):
        ENTRIES[entry](h, R, Plane(replace(rule, dt=0.1)))


def test_layers_may_be_views_and_are_not_changed(rule):
    h, R = np.asfortranarray(np.eye(6)), np.ones((12, 12))[::2, ::2]
    before = h.copy()
    found = evolve(h, R, Plane(rule), 5)
    assert found[0].flags.c_contiguous
    assert (h == before).all()
    expected = evolve(h.copy(order="C"), R.copy(), Plane(rule), 5)
    assert found[0].tobytes() == expected[0].tobytes()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"flow": "d4"}, "flow = 'd4'"),
        ({"ends": "shut"}, "ends = 'shut'"),
        ({"sides": "open"}, "sides = 'open'"),
        ({"D_across": -1.0}, "D_across = -1.0"),
        ({"D_across": math.nan}, "D_across = nan"),
        ({"fall": math.inf}, "fall = inf"),
        ({"walls": np.zeros((4, 5))}, "walls has the type float64"),
        ({"base": np.full((4, 5), np.nan)}, "base"),
        ({"sources": ("here",)}, "sources"),
    ],
)
def test_plane_names_what_does_not_fit(options, message, rule):
    with pytest.raises(ValueError, match=message):
        Plane(rule, **options)


@pytest.mark.parametrize(
    "changes", [{"order": "right"}, {"scheme": "calibrated"}, {"scheme": "limited"}, {"kappa": 0.1}]
)
def test_rules_of_the_line_alone_are_refused(changes, rule):
    with pytest.raises(ValueError, match=f"{next(iter(changes))} = .* on a plane"):
        Plane(replace(rule, **changes))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"rate": -1.0}, "rate = -1.0"),
        ({"place": (1.0,)}, "place"),
        ({"place": (1.0, math.nan)}, "place"),
        ({"width": 0.0}, "width = 0.0"),
        ({"times": (2.0, 1.0)}, "times"),
        ({"times": (0.0, math.nan)}, "times"),
    ],
)
def test_source_names_what_does_not_fit(options, message):
    with pytest.raises(ValueError, match=message):
        Source(**({"rate": 1.0, "place": (1.0, 1.0), "width": 2.0} | options))


def test_walls_and_base_must_fit_the_sand(rule):
    with pytest.raises(ValueError, match=r"walls has the shape \(3, 5\)"):
        evolve(H, R, Plane(rule, walls=np.zeros((3, 5), bool)), 1)
    with pytest.raises(ValueError, match=r"R = 1.0 in cell \(1, 3\): must be 0 at a wall"):
        evolve(H, R, Plane(rule, walls=spoiled(np.zeros((4, 5), bool), (1, 3), True)), 1)
    with pytest.raises(ValueError, match=r"h = 0.0 in cell \(2, 2\): must not lie below the base"):
        evolve(H, R, Plane(rule, base=spoiled(H - 1, (2, 2), 0.5)), 1)
    with pytest.raises(ValueError, match=r"sources\[0\]: no cell"):
        evolve(H, R, Plane(rule, sources=(Source(1.0, (50.0, 1.0), 2.0),)), 1)


@pytest.mark.parametrize("steps", [-1, 0.5, True])
def test_number_of_steps_must_be_whole(steps, rule):
    with pytest.raises(ValueError, match="steps"):
        evolve(H, R, Plane(rule), steps)


@pytest.mark.parametrize("times", [[2.0, 1.0], [-1.0], [math.inf], [math.nan]])
def test_times_must_ascend_and_are_refused_at_once(times, rule):
    with pytest.raises(ValueError, match="times"):
        frames(Sand(H, R), Plane(rule), times)


@pytest.mark.parametrize(("flow", "w"), [("tilted", ""), ("split4", "2 "), ("facet8", "")])
def test_unstable_step_names_the_bound_and_the_cell(flow, w, rule):
    plane = Plane(replace(rule, dt=100.0), flow)
    with pytest.raises(UnstableStep, match=rf"{w}v dt/d .* where S = .* in cell \(\d, \d\)"):
        evolve(spoiled(H, (1, 3), -2.0), R, plane, 1)
    with pytest.raises(
        UnstableStep, match=rf": {w}gamma R dt/d .* where R = 1e.06 in cell \(2, 3\)"
    ):
        evolve(H, spoiled(R, (2, 3), 1e6), replace(plane, rule=rule), 1)
    with pytest.raises(UnstableStep, match=r"cell \(2, 3\)"):
        frames(Sand(H, spoiled(R, (2, 3), 1e6)), replace(plane, rule=rule), [1.0], step=0.3)


@pytest.mark.parametrize("flow", ["tilted", "split4", "facet8", "d8"])
def test_step_that_is_recommended_is_accepted_and_a_longer_one_is_not(flow, rng, rule):
    h, R = rng.normal(size=(7, 8)), rng.random((7, 8)) * 300
    try:
        evolve(h, R, Plane(replace(rule, dt=50.0), flow), 1)
    except UnstableStep as refused:
        largest = refused.largest
    with pytest.raises(UnstableStep):
        evolve(h, R, Plane(replace(rule, dt=1.001 * largest), flow), 0)
    evolve(h, R, Plane(replace(rule, dt=largest), flow), 0)


def test_avalanche_that_outgrows_a_fixed_step_is_named(rule):
    h = -4.0 * np.arange(60)[:, None] * np.ones(5)
    plane = Plane(replace(rule, gamma=0.1, dt=0.5))
    with pytest.raises(
        FloatingPointError, match=r"outgrown the step by t = .* in cell \(\d+, \d\)"
    ):
        evolve(h, np.ones_like(h), plane, 5000)
    with pytest.raises(FloatingPointError, match="outgrown"):
        list(frames(Sand(h, np.ones_like(h)), plane, [2500.0], step=0.5))
    with pytest.raises(FloatingPointError, match=r"no longer finite .* in cell"):
        advance(Sand(h, np.ones_like(h)), plane, 5000)


def test_bound_of_a_slope_below_repose_is_that_of_the_formula(rule):
    assert max_stable_step(Plane(rule, D_across=0.3), 0.0, 0.5) == pytest.approx(
        1 / (0.3 / 0.7 + 2 * 0.4 / 0.49 + 0.02 * 0.5)
    )
    assert max_stable_step(Plane(rule, "split4"), 1e4) == pytest.approx(0.7 / (2 * 0.02 * 1e4))


def test_opening_angle_needs_growth_and_a_tilted_plane(rule):
    with pytest.raises(ValueError, match="sigma"):
        opening_angle(0.1, 0.1, 0.1, 0.0, 1.0)
    with pytest.raises(ValueError, match="flow = 'split4'"):
        opening_angle_on(Plane(rule, "split4"), 1.0)
