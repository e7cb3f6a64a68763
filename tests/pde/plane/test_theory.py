"""Closed forms on a plane."""

import math

import numpy as np
import pytest
import sympy as sp

from bcre_pde import second_critical_slope
from bcre_pde.plane import Material, theory

TABLE = [
    (0.1, 0.1, 0.1, 0.01, {0.3: 20.268, 0.5: 26.565, 1.0: 39.232, 1.5: 50.769}),
    (0.3, 0.1, 0.1, 0.05, {0.3: 14.963, 1.0: 28.126, 1.5: 35.264}),
]


@pytest.mark.parametrize(("v", "D_x", "D_y", "gamma", "row"), TABLE)
def test_opening_angle_of_the_parameter_rows(v, D_x, D_y, gamma, row):
    for excess, degrees in row.items():
        found = theory.opening_angle(Material(v, D_x, D_y, gamma, 0.5), 0.5 + excess)
        assert found == pytest.approx(degrees, abs=6e-4)


@pytest.mark.parametrize("ratio", [0.25, 1.0, 4.0])
def test_opening_angle_widens_from_nothing_at_repose_to_ninety_degrees_at_Sd(ratio):
    material = Material(0.1, 0.1, 0.1 * ratio, 0.01, 0.5)
    Sd = second_critical_slope(0.1, 0.1, 0.01, 0.5)
    angles = [theory.opening_angle(material, S) for S in np.linspace(0.5 + 1e-9, Sd, 50)]
    assert angles[0] < 0.01
    assert angles[-1] == 90
    assert (np.diff(angles) > 0).all()
    middle = theory.opening_angle(material, (0.5 + Sd) / 2)
    assert middle == pytest.approx(math.degrees(math.atan(math.sqrt(ratio))))
    assert theory.opening_angle(material, Sd + 1) == 90


def test_opening_angle_without_spread_along_is_the_limit():
    thin, none = (Material(0.3, D_x, 0.2, 0.05, 0.5) for D_x in (1e-9, 0.0))
    assert theory.opening_angle(none, 1.5) == pytest.approx(theory.opening_angle(thin, 1.5))


@pytest.mark.parametrize("S", [0.5, 0.1, math.nan])
def test_opening_angle_needs_a_slope_above_repose(S):
    with pytest.raises(ValueError, match=rf"^S = {S!r}: an avalanche needs a slope above Sc"):
        theory.opening_angle(Material(0.1, 0.1, 0.1, 0.01, 0.5), S)


def test_release_obeys_its_equation_and_holds_its_volume():
    x, y = sp.symbols("x y", real=True)
    t, M, v, D, Q, s = sp.symbols("t M v D_x D_y sigma", positive=True)
    R = M / (4 * sp.pi * t * sp.sqrt(D * Q))
    R *= sp.exp(s * t - (x - v * t) ** 2 / (4 * D * t) - y**2 / (4 * Q * t))
    residual = R.diff(t) + v * R.diff(x) - D * R.diff(x, 2) - Q * R.diff(y, 2) - s * R
    assert sp.simplify(residual / R) == 0
    numbers = {x: 1.3, y: 0.4, t: 2.0, M: 3.0, v: 0.4, D: 0.1, Q: 0.3, s: 0.05}
    material = Material(0.4, 0.1, 0.3, 0.05, 0.5)
    found = theory.frozen_slope_release(1.3, 0.4, 2.0, 3.0, material, 1.5)
    assert found == pytest.approx(float(R.subs(numbers)), rel=1e-13)


@pytest.mark.parametrize(("along", "across"), [(2.0, 0.3), (-0.5, 0.1), (0.4, 3.0)])
def test_what_passes_in_all_is_the_time_integral_of_the_release(along, across):
    material, S = Material(0.4, 0.1, 0.3, 0.05, 0.5), 1.7
    logs = np.linspace(-9, 7, 4001)
    times = np.exp(logs)
    R = [theory.frozen_slope_release(along, across, t, 3.0, material, S) for t in times]
    expected = np.trapezoid(np.array(R) * times, logs)
    assert theory.passed_in_all(along, across, 3.0, material, S) == pytest.approx(
        expected, rel=1e-9
    )


def test_what_passes_neither_grows_nor_falls_along_the_edge():
    material, S = Material(0.1, 0.1, 0.25, 0.01, 0.5), 1.0
    edge = math.radians(theory.opening_angle(material, S))
    logs = []
    for angle in (edge - 0.01, edge, edge + 0.01):
        along, across = math.cos(angle), math.sin(angle)
        near, far = (
            theory.passed_in_all(r * along, r * across, 1.0, material, S) * math.sqrt(r)
            for r in (1e4, 2e4)
        )
        logs.append(math.log(far / near))
    assert logs[0] > 1 > 1e-3 > abs(logs[1])
    assert logs[2] < -1


def test_what_passes_at_the_second_critical_slope_is_without_bound():
    with pytest.raises(ValueError, match=r"^S = 3.1: from the second critical slope on"):
        theory.passed_in_all(1.0, 0.0, 1.0, Material(0.1, 0.1, 0.1, 0.01, 0.5), 3.1)


def test_explicit_step_is_that_of_what_rolls_or_under_a_thick_layer_of_what_climbs():
    material = Material(1.0, 0.2, 0.1, 0.3, 0.5)
    thin, thick = (theory.largest_explicit_step(material, 0.5, 0.4, R) for R in (0.1, 100.0))
    spread = 272 / 45 * (0.2 / 0.5**2 + 0.1 / 0.4**2)
    assert 2.78 / thin == pytest.approx(32 / 15 / 0.5 + spread)
    assert 2.78 / thick == pytest.approx(32 / 15 * 0.3 * 100 / 0.5)
    assert theory.largest_explicit_step(Material(0.0, 0.0, 0.0, 0.3, 0.5), 1, 1, 0.0) == math.inf
