"""Solutions about an axis: heaps, silos, cones."""

import math

import numpy as np
import pytest

from bcre_pde import Material
from bcre_pde.plane.radial import Problem, Source, solve, theory
from bcre_pde.plane.radial.problem import ring_means

MATERIAL = Material(1.0, 0.1, 0.5, 0.5)


def level(r):
    return 0 * r, 0 * r


def volume(solution):
    return solution.mass() + solution.outflow - solution.supplied


def heap(cells, turning=0.05, radius=20.0):
    source = Source(5.0, 3.0, until=40.0)
    problem = Problem(level, MATERIAL, radius, source=source, turning=turning)
    return solve(problem, [0.0, 30.0, 60.0], cells, 1e-5)


def difference(one, other):
    """Relative L1 difference of the last h, means over as many rings."""
    means = []
    for solution in (one, other):
        r, h = solution.r.reshape(40, -1), solution.h[-1].reshape(40, -1)
        means.append((r * h).sum(axis=1) / r.sum(axis=1))
    r = (np.arange(40) + 0.5) / 2
    return (r * np.abs(means[0] - means[1])).sum() / (r * means[1]).sum()


def test_poured_heap_converges_with_the_grid_and_does_not_depend_on_where_grains_turn():
    coarse, fine, finest = (heap(cells) for cells in (40, 80, 160))
    assert difference(fine, finest) < 1e-3
    assert difference(coarse, finest) > 3 * difference(fine, finest)
    assert difference(heap(80, turning=0.1), fine) < 1e-3


def test_poured_heap_holds_what_was_poured_and_is_nowhere_steeper_than_repose():
    solution = heap(80)
    assert solution.supplied == pytest.approx([0, 150, 200], rel=1e-12)
    assert np.abs(volume(solution)).max() < 1e-10 * 200
    slope = -np.diff(solution.h[-1]) / solution.dr
    assert 0.2 < slope.max() < 0.5


def test_outflow_over_the_rim_is_accounted_for():
    solution = heap(80, radius=8.0)
    assert solution.outflow[-1] > 1
    assert np.abs(volume(solution)).max() < 1e-10 * 200


def test_layer_on_a_cone_at_repose_moves_out_as_circles_widen():
    """R = f(r - v t)/r with D = 0, an exact solution of the nonlinear equations."""
    material, a, t = Material(1.0, 0.0, 0.5, 0.5), 30.0, 5.0

    def layers(r, t=0.0):
        return 20 - 0.5 * r, np.exp(-(((r - 12 - t) / 2) ** 2)) / r

    errors = []
    for cells in (60, 120, 240):
        solution = solve(Problem(layers, material, a), [t], cells, 1e-9)
        _, R = ring_means(lambda r: layers(r, t), a, cells)
        errors.append(np.abs(solution.R[0] - R).mean() / R.mean())
    assert -np.polyfit(np.log([60, 120, 240]), np.log(errors), 1)[0] > 4.2
    assert errors[-1] < 1e-5


def test_silo_fills_as_the_closed_form_says():
    """A wall at the rim; the closed form leaves out D, and what lies under the source."""
    material, a, w = Material(1.0, 0.01, 0.5, 0.5), 10.0, 0.01
    flat = theory.flat_from(a, material)

    def start(r):
        fine = np.linspace(0, a, 2001)
        fall = np.cumsum(theory.filling_slope(np.maximum(fine, 0.5), a, material)) * a / 2000
        return -np.interp(r, fine, fall), theory.filling_layer(np.maximum(r, 1.0), w, a, material)

    source = Source(w * math.pi * a**2, 1.0)
    problem = Problem(start, material, a, "closed", source)
    solution = solve(problem, [0.0, 30.0], 80, 1e-5)
    assert np.abs(volume(solution) - volume(solution)[0]).max() < 1e-9
    inside = (solution.r > 2) & (solution.r < flat - 1)
    expected = theory.filling_layer(solution.r, w, a, material)
    assert solution.R[-1][inside] == pytest.approx(expected[inside], rel=0.02)
    slope = -np.gradient(solution.h[-1], solution.r)
    steepest = theory.filling_slope(solution.r, a, material)
    assert slope[inside] == pytest.approx(steepest[inside], abs=0.01)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"radius": 0.0}, r"^radius = 0.0: must be a finite number > 0"),
        ({"turning": 0.0}, r"^turning = 0.0: must be a finite number > 0"),
        ({"rim": "shut"}, r"^rim = 'shut': must be one of"),
        ({"source": Source(1.0, 11.0)}, r"^source radius = 11.0: must be at most that of the disc"),
        ({"material": Material(1.0, 0.1, 0.5, 0.5, 0.1)}, r"^kappa = 0.1: must be 0"),
    ],
)
def test_bad_problem_is_refused_with_its_name_and_value(options, message):
    arguments = {"initial": level, "material": MATERIAL, "radius": 10.0} | options
    with pytest.raises(ValueError, match=message):
        Problem(**arguments)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"rate": -1.0}, r"^source rate = -1.0: must be a finite number > 0"),
        ({"radius": math.inf}, r"^source radius = inf: must be a finite number > 0"),
        ({"until": 0.0}, r"^source until = 0.0: must be > 0"),
    ],
)
def test_bad_source_is_refused_with_its_name_and_value(options, message):
    with pytest.raises(ValueError, match=message):
        Source(**({"rate": 1.0, "radius": 2.0} | options))


@pytest.mark.parametrize(
    ("times", "cells", "message"),
    [
        ([1.0], 7, r"^cells = 7: must be a whole number, at least 8"),
        ([2.0, 1.0], 8, r"must ascend"),
    ],
)
def test_bad_argument_is_refused(times, cells, message):
    with pytest.raises(ValueError, match=message):
        solve(Problem(level, MATERIAL, 10.0), times, cells)
