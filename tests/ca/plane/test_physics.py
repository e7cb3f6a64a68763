"""What sand on a plane must do: closed forms, exact solutions, a radial reference."""

import math
from dataclasses import replace

import numpy as np
import pytest

from bcre_ca import Rule
from bcre_ca.plane import Plane, Run, Sand, Source, advance, frames
from bcre_ca.plane.theory import rill_growth, silo_layer


def growth_at_the_start(rule, s, part=0.9):
    """Growth rate at a fixed cell of a tilted slope, from ln R = a + l t - ln t."""
    size, start, width = 160, 110, 61
    h = -(rule.Sc + s) * rule.d * np.arange(size)[:, None] * np.ones(width)
    R = np.zeros_like(h)
    R[start, width // 2] = 1e-150
    run = Run(Sand(h, R), Plane(rule), threads=1)
    dt = part / (rule.v / rule.d + 4 * rule.D / rule.d**2)
    found = []
    for steps in (300, 300):
        run.take(steps, dt)
        found.append((run.t, math.log(run.R[start, width // 2]) + math.log(run.t)))
    return (found[1][1] - found[0][1]) / (found[1][0] - found[0][0])


def test_second_critical_slope_is_that_of_the_line():
    rule = Rule(0.3, 0.1, 0.05, 0.5, 1.0, 0.5)
    excess = rule.second_critical_slope() - rule.Sc
    rates = [growth_at_the_start(rule, s) for s in (excess - 0.3, excess + 0.3)]
    zero = excess - 0.3 - rates[0] * 0.6 / (rates[1] - rates[0])
    assert zero == pytest.approx(excess, abs=0.01)


def test_pulse_on_a_tilted_plane_converges_in_first_order_to_the_gaussian():
    """Frozen slope S = Sc: R drifts at v and spreads with D along, D_across across."""
    v, D, across, T, width = 0.5, 1.0, 0.1, 4.0, 3.0
    errors = []
    for cells in (40, 80, 160):
        d = 40.0 / cells
        x = (np.arange(cells) + 0.5) * d - 15
        y = (np.arange(cells) + 0.5) * d - 20

        def gaussian(coordinate, centre, diffusion, t):
            squared = width**2 + 4 * diffusion * t
            return width / math.sqrt(squared) * np.exp(-((coordinate - centre) ** 2) / squared)

        R = np.outer(gaussian(x, 0, D, 0), gaussian(y, 0, across, 0))
        plane = Plane(Rule(v, D, 0.0, 0.5, d, dt=0.1), D_across=across)
        end = next(iter(frames(Sand(np.zeros_like(R), R), plane, [T], 0.2 * d**2 / D)))
        exact = np.outer(gaussian(x, v * T, D, T), gaussian(y, 0, across, T))
        errors.append(np.abs(end.R - exact).mean())
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx(1, abs=0.15)


def radial_heap(v, D, gamma, Sc, rate, disc, T, length, dr):
    """A heap poured over a disc, BCRE in the radius by finite volumes of width dr."""
    faces = np.arange(int(length / dr) + 1) * dr
    area = math.pi * np.diff(faces**2)
    poured = math.pi * np.diff(np.minimum(faces, disc) ** 2) / area * rate / (math.pi * disc**2)
    h, R = np.zeros_like(area), np.zeros_like(area)
    steps = math.ceil(T * (2 * v / dr + 2 * D / dr**2 + gamma) / 0.7)
    dt = T / steps
    for _ in range(steps):
        outward = (h[:-1] - h[1:]) / dr
        flux = v * np.sign(outward) * np.where(outward > 0, R[:-1], R[1:])
        flux = 2 * math.pi * faces[1:-1] * (flux - D * np.diff(R) / dr)
        slope = np.maximum(np.append(outward, 0), np.append(0, -outward))
        E = gamma * R * (slope - Sc)
        net = np.append(0, flux) - np.append(flux, 0)
        h, R = h - dt * E, R + dt * (net / area + E + poured)
    return (faces[1:] + faces[:-1]) / 2, h


HEAP = {"v": 1.0, "D": 0.2, "gamma": 2.0, "Sc": 0.5}


@pytest.fixture(scope="module")
def reference():
    return radial_heap(**HEAP, rate=5.0, disc=2.0, T=100.0, length=16.0, dr=1 / 16)


def heap_error(flow, d, reference):
    """Relative L1 error of h of a heap poured in the middle of a closed square."""
    cells = round(32 / d)
    source = Source(5.0, (16.0, 16.0), 4.0)
    plane = Plane(Rule(**HEAP, d=d, dt=0.1), flow, ends="closed", sources=(source,))
    end = next(iter(frames(Sand(*np.zeros((2, cells, cells))), plane, [100.0])))
    assert end.volume(plane) == pytest.approx(500, rel=1e-12)
    x = (np.arange(cells) + 0.5) * d - 16
    expected = np.interp(np.hypot(x[:, None], x), *reference)
    return np.abs(end.h - expected).sum() / expected.sum()


@pytest.mark.parametrize("flow", ["split4", "facet8"])
def test_poured_heap_converges_to_the_radial_solution(flow, reference):
    coarse, fine = (heap_error(flow, d, reference) for d in (0.5, 0.25))
    assert fine < 0.01
    assert coarse / fine > 1.6


def test_poured_heap_of_d8_does_not_converge(reference):
    coarse, fine = (heap_error("d8", d, reference) for d in (0.5, 0.25))
    assert fine > 0.05
    assert coarse / fine < 1.1


@pytest.mark.parametrize("flow", ["split4", "facet8"])
def test_silo_that_fills_has_the_layer_of_its_closed_form(flow):
    a, w, d, rule = 12.0, 0.1, 0.25, Rule(1.0, 0.0, 1.0, 0.5, 0.25, dt=0.1)
    cells = round(2 * a / d)
    x = (np.arange(cells) + 0.5) * d - a
    r = np.hypot(x[:, None], x)
    source = Source(w * d * d * np.count_nonzero(r <= a), (a, a), 4.0)
    plane = Plane(rule, flow, ends="closed", walls=r > a, sources=(source,))
    end = next(iter(frames(Sand(*np.zeros((2, cells, cells))), plane, [60.0])))
    rim = -rule.v / (rule.gamma * rule.Sc) + math.hypot(rule.v / (rule.gamma * rule.Sc), a)
    ring = (r > 3) & (r < 0.85 * rim)
    error = np.abs(end.R - silo_layer(rule.v, w, a, np.where(ring, r, a)))[ring].sum()
    assert error < 0.03 * end.R[ring].sum()


def growth_of_ripples(flow, rule, S, R0, waves, M=64):
    """Predicted and measured rate of ripples across a sheet R0, from 2/l to 4/l after the start.

    By then they have outrun the ripple that decays. R0 of the prediction is that half way between.
    """
    k = 2 * math.pi * waves / (M * rule.d)
    ripple = np.cos(k * rule.d * np.arange(M))
    h = -S * rule.d * np.arange(8)[:, None] + 1e-9 * ripple
    plane = Plane(rule, flow, ends="periodic", sides="periodic", fall=S * rule.d * 8)
    run, found = Run(Sand(h, np.full_like(h, R0)), plane), []

    def rate(sheet):
        return rill_growth(rule.v, rule.D, rule.gamma, S, rule.Sc, sheet, rule.d, k)

    steps = round(2 / rate(R0) / rule.dt)
    for _ in range(2):
        run.take(steps)
        found.append((abs(run.h.mean(0) @ ripple), run.R.mean()))
    (before, thin), (after, thick) = found
    assert thick < 1.2 * thin
    return rate(math.sqrt(thin * thick)), math.log(after / before) / (steps * rule.dt)


def test_ripples_across_an_eroding_sheet_grow_at_their_rate_and_not_at_all_in_d8():
    rule = Rule(1.3, 0.002, 0.12, 0.5, 0.5, dt=0.1)
    expected, found = growth_of_ripples("split4", rule, 0.51, 0.08, waves=7)
    assert found == pytest.approx(expected, rel=0.05)
    expected, found = growth_of_ripples("d8", rule, 0.51, 0.08, waves=7)
    assert abs(found) < 1e-3 * expected


def test_sheet_on_the_repose_slope_is_steady(rule):
    h = -rule.Sc * rule.d * np.arange(40)[:, None] * np.ones(20)
    plane = Plane(rule, ends="periodic", sides="periodic")
    end = next(iter(frames(Sand(h, np.ones_like(h)), plane, [20.0])))
    assert np.abs(end.h - h).max() < 1e-12
    assert np.abs(end.R - 1).max() < 1e-12


@pytest.mark.parametrize("flow", ["split4", "facet8", "d8"])
def test_free_surface_has_no_preferred_axis(flow, rng, rule):
    """Turned or mirrored sand does the same, but for which of equal facets comes first."""
    h, R = rng.normal(size=(12, 12)), rng.random((12, 12))
    plane = Plane(replace(rule, dt=0.05), flow, ends="closed")

    def end(turn):
        run = Run(Sand(*(np.ascontiguousarray(turn(layer)) for layer in (h, R))), plane)
        run.take(30)
        return run.h, run.R

    for turn in (np.rot90, np.fliplr, np.transpose):
        for found, expected in zip(end(turn), end(np.asarray), strict=True):
            assert found == pytest.approx(turn(expected), abs=1e-12)


def test_cut_off_has_a_limit_as_the_step_falls_and_differs_by_a_few_of_it(thick_rule):
    """A pulse below repose: a cell that gains less than that in a step fills all the same."""
    i = np.arange(60)[:, None] + 0.5
    h, R = -0.58 * i * np.ones(12), np.exp(-(((i - 20) / 4) ** 2)) * np.ones(12)
    missing = {}
    for dt in (0.2, 0.02, 0.005):
        rule = replace(thick_rule, v=2.5, gamma=0.01, d=1.0, dt=dt, v_up=1e9)
        planes = (Plane(replace(rule, dry=dry), base=h - 1) for dry in (1e-300, 1e-3))
        exact, cut = (advance(Sand(h, R), plane, round(8 / dt)) for plane in planes)
        assert np.abs(exact.R - cut.R).max() <= 4e-3
        assert np.abs(exact.h - cut.h).max() <= 2e-3
        missing[dt] = (exact.R - cut.R).sum() / 12
    assert 0 < missing[0.005] <= 60e-3
    assert all(abs(missing[dt] - missing[0.005]) <= 60e-3 * dt for dt in missing)
