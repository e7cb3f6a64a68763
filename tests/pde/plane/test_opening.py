"""The opening angle of an avalanche, as the solver gives it, against its closed form."""

import math

import numpy as np
import pytest

from bcre_pde.plane import Frame, Material, Problem, march, opening, theory


def measured(material, S, distance, cell):
    """From a pulse of 1e-150; distance and cell in units of D_x/v."""
    unit = material.D_x / material.v
    degrees = theory.opening_angle(material, S)
    along, across = (4 * distance * f(math.radians(degrees)) for f in (math.cos, math.sin))
    top = 20.0
    rows = round((top + along + 12) / cell)
    columns = round((across + 15 * math.sqrt(material.D_y / material.D_x)) / cell)

    def pulse(x, y):
        far = (x - top * unit) ** 2 + y**2 * material.D_x / material.D_y
        return -S * x, 1e-150 * np.exp(-far / (2 * unit) ** 2)

    lengths = rows * cell * unit, columns * cell * unit
    problem = Problem(pulse, material, *lengths, sides="closed")
    decay = material.v**2 / (4 * material.D_x) - material.gamma * (S - material.Sc)
    times = np.arange(0, 4 * distance * unit / material.v + 14 / decay, 3 * unit / material.v)
    N = opening.passed_in_all(march(problem, times, (rows, columns), 1e-4))
    x, y = ((np.arange(n) + 0.5) * cell * unit for n in (rows, columns))
    return opening.opening_angle(N, x, y, (top * unit, 0.0), distance * unit)


@pytest.mark.parametrize(
    ("v", "D_x", "D_y", "gamma", "excess"),
    [(0.1, 0.1, 0.1, 0.01, 0.5), (0.3, 0.1, 0.1, 0.05, 1.0), (0.1, 0.2, 0.1, 0.01, 0.4)],
)
def test_avalanche_opens_at_the_closed_form(v, D_x, D_y, gamma, excess):
    material = Material(v, D_x, D_y, gamma, 0.5)
    found = measured(material, 0.5 + excess, distance=10, cell=1.0)
    expected = theory.opening_angle(material, 0.5 + excess)
    assert found.theta == pytest.approx(expected, abs=0.05)
    assert found.error < 0.5


def closed_form(material, S, size=140.0, n=141):
    x, y = np.linspace(-20, size, n), np.linspace(0.5, size, n)
    return x, y, theory.passed_in_all(*np.meshgrid(x, y, indexing="ij"), 1e-150, material, S)


@pytest.mark.parametrize("S", [0.6, 1.0, 2.0, 2.7])
def test_estimator_finds_the_angle_of_the_closed_form(S):
    material = Material(0.1, 0.1, 0.1, 0.01, 0.5)
    x, y, N = closed_form(material, S)
    found = opening.opening_angle(N, x, y, (0.0, 0.0), 32.0)
    expected = theory.opening_angle(material, S)
    assert found.theta == pytest.approx(expected, abs=2e-4)
    assert abs(found.theta - expected) < found.error < 0.01


def test_estimator_refuses_a_layer_without_an_edge():
    x = y = np.linspace(0, 100, 51)
    with pytest.raises(ValueError, match=r"^r = 20.0: no edge of N lies on the plane there"):
        opening.opening_angle(np.ones((51, 51)), x, y, (0.0, 0.0), 20.0)


def test_sum_over_frames_is_the_time_integral():
    times = np.linspace(0, 12, 25)
    R = np.exp(-((times - 6) ** 2))[:, None, None] * np.ones((1, 2, 3))
    frames = [Frame(t, r, r, 0.0) for t, r in zip(times, R, strict=True)]
    assert opening.passed_in_all(frames) == pytest.approx(math.sqrt(math.pi), rel=1e-12)
    for bad in (frames[:1], [], [frames[0], frames[1], frames[3]]):
        with pytest.raises(ValueError, match=r"^frames: must be at least two, at equal intervals"):
            opening.passed_in_all(bad)
