"""The angle at which an avalanche opens, measured in the automaton, against its closed form."""

import math

import numpy as np
import pytest
from scipy.interpolate import RectBivariateSpline
from scipy.optimize import brentq

from bcre_ca import Rule
from bcre_ca.plane import Plane, Run, Sand
from bcre_ca.plane.theory import edge, opening_angle, opening_angle_on

# v, D, gamma, d, S - Sc and the angle in degrees.
EXPECTED = [
    (0.1, 0.1, 0.01, 1, 0.3, 20.9404),
    (0.1, 0.1, 0.01, 1, 0.5, 28.1079),
    (0.1, 0.1, 0.01, 1, 1.0, 44.6475),
    (0.1, 0.1, 0.01, 1, 1.5, 65.6192),
    (0.3, 0.1, 0.05, 1, 0.3, 15.8416),
    (0.3, 0.1, 0.05, 1, 1.0, 34.5880),
    (0.3, 0.1, 0.05, 1, 1.5, 50.2419),
    (0.1, 0.1, 0.01, 0.25, 0.5, 26.9300),
    (0.1, 0.1, 0.01, 0.25, 1.0, 40.4427),
    (0.1, 0.1, 0.01, 0.25, 1.5, 53.5857),
]
UNSEEN = [(0.4, 0.2, 0.05, 0.7, 0.8, 0.05), (0.25, 0.1, 0.03, 0.8, 0.7, 0.3)]


@pytest.mark.parametrize(("v", "D", "gamma", "d", "s", "theta"), EXPECTED)
def test_closed_form(v, D, gamma, d, s, theta):
    assert opening_angle(v, D, D, gamma * s, d) == pytest.approx(theta, abs=1e-4)


def test_closed_form_becomes_that_of_bcre_as_cells_shrink():
    v, D, gamma, s = 0.1, 0.1, 0.01, 0.5
    beyond = v**2 / (4 * D * gamma) - s
    for ratio in (1.0, 0.25):
        continuous = math.degrees(math.atan(math.sqrt(ratio * s / beyond)))
        errors = [
            abs(opening_angle(v, D, ratio * D, gamma * s, d) - continuous) for d in (0.1, 0.05)
        ]
        assert errors[1] < 0.1
        assert errors[0] / errors[1] == pytest.approx(2, rel=0.05)


def test_angle_reaches_90_degrees_at_the_second_critical_slope_of_the_line():
    rule = Rule(0.3, 0.1, 0.05, 0.5, 1.0, 0.5)
    plane, Sd = Plane(rule, D_across=0.02), rule.second_critical_slope()
    assert opening_angle_on(plane, Sd - 1e-9) > 89.9
    assert opening_angle_on(plane, Sd) == pytest.approx(90, abs=0.01)
    assert opening_angle_on(plane, Sd + 1e-9) == 90


@pytest.mark.parametrize(("v", "D", "gamma", "d", "s", "D_across"), UNSEEN)
def test_wave_at_the_edge_is_steady_and_even_along_the_edge(v, D, gamma, d, s, D_across):
    wave = edge(v, D, D_across, gamma * s, d)
    m, n = wave.along * d, wave.across * d
    rate = gamma * s - v / d * (1 - math.exp(-m)) + 2 * D / d**2 * (math.cosh(m) - 1)
    assert rate + 2 * D_across / d**2 * (math.cosh(n) - 1) == pytest.approx(0, abs=1e-12)
    assert m == pytest.approx(n * math.tan(math.radians(wave.theta)), rel=1e-9)


def all_that_passed(v, D, gamma, d, s, D_across, part=0.9, r=24, passes=4, above=25):
    """ln N(i, j), N the sum of R over the steps, from R = 1e-150 in one cell of an even slope.

    As many rows and columns as the radius 4 r needs; until sand at the speed v has passed so often.
    """
    rule = Rule(v, D, gamma, 0.5, d, dt=1.0)
    theta = math.radians(opening_angle(v, D, D_across, gamma * s, d))
    margin = 12 + above * r // 48
    rows = above + margin + int(4 * r * math.cos(0.8 * theta))
    columns = margin + int(4 * r * math.sin(min(1.15 * theta, math.pi / 2)))
    h = -(rule.Sc + s) * d * np.arange(rows)[:, None] * np.ones(2 * columns + 1)
    R = np.zeros_like(h)
    R[above, columns] = 1e-150
    plane = Plane(rule, D_across=D_across)
    run, N = Run(Sand(h, R), plane, threads=1), np.zeros_like(R)
    dt = part / (v / d + 2 * (D + D_across) / d**2)
    for _ in range(int(passes * rows * d / v / dt)):
        N += run.R
        run.take(1, dt)
    return np.log(N[above:, columns:] / 1e-150)


def angle_between(logs, r, theta):
    """Where ln N + (1/2) ln r = r phi(theta) + ln A(theta) + O(1/r) is alike at r and 2 r."""
    smooth = RectBivariateSpline(*(np.arange(n) for n in logs.shape), logs, kx=5, ky=5)

    def gained(theta):
        near, far = (
            float(smooth(radius * math.cos(theta), radius * math.sin(theta))[0, 0])
            for radius in (r, 2 * r)
        )
        return far - near + math.log(2) / 2

    around = math.radians(theta)
    return math.degrees(brentq(gained, 0.8 * around, min(1.15 * around, math.pi / 2 - 0.01)))


def measured_angle(logs, theta, r=24):
    """Off by 1/r^2 from two radii; from three of them that is taken out (Richardson)."""
    near, far = angle_between(logs, r, theta), angle_between(logs, 2 * r, theta)
    return far + (far - near) / 3


@pytest.mark.parametrize(
    ("v", "D", "gamma", "d", "s", "D_across"),
    [(*row[:5], row[1]) for row in EXPECTED if row[3] == 1 and row[5] < 60] + UNSEEN,
)
def test_automaton_opens_at_the_angle_of_its_closed_form(v, D, gamma, d, s, D_across):
    theta = opening_angle(v, D, D_across, gamma * s, d)
    logs = all_that_passed(v, D, gamma, d, s, D_across, part=0.9)
    assert measured_angle(logs, theta) == pytest.approx(theta, abs=0.005)


def test_angle_does_not_depend_on_the_step():
    v, D, gamma, d, s = EXPECTED[1][:5]
    theta = EXPECTED[1][5]
    found = [
        measured_angle(all_that_passed(v, D, gamma, d, s, D, part), theta) for part in (0.9, 0.45)
    ]
    assert found[0] == pytest.approx(found[1], abs=0.01)
