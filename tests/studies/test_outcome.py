"""What is read off a run: growth rates, outcomes and slopes, on profiles made by hand."""

import math

import numpy as np
import pytest

from bcre_studies.models.run import Run
from bcre_studies.observables.outcome import (
    Outcome,
    growth_rate,
    outcome,
    reached_the_top,
    slope,
    spent,
)
from bcre_studies.scenes.scene import load

CENTRE = 85.0


def run_of(u_end, R):
    """A run of figure 1 whose surface ends at ``u_end``, and with R(t) at and above the pulse."""
    scene = load("figure1")
    x = scene.centres()
    start = 3.2 * (100 - x)
    t = np.linspace(0.0, 900.0, len(R))
    u = np.linspace(0, 1, len(R))[:, None] * (u_end - start) + start
    layers = np.array(R)[:, None] * np.exp(-(((x - CENTRE) / 3) ** 2))
    outflow = np.zeros(t.size)
    return Run(scene, x, t, u - 0.5 * x, layers, outflow, steps=1, evaluations=1)


def test_the_growth_rate_leaves_the_spreading_out():
    sigma, t = 0.013, np.array([70.0, 160.0])
    R = 1e-150 * np.exp(sigma * t) / np.sqrt(t)
    assert growth_rate(tuple(t), tuple(R)) == pytest.approx(sigma, rel=1e-12)


def test_a_spreading_layer_that_does_not_grow_has_no_growth_rate():
    assert growth_rate((50.0, 200.0), (2.0, 1.0)) == pytest.approx(0, abs=1e-15)


def test_a_slope_brought_down_to_the_repose_line_is_a_yes():
    run = run_of(np.full(100, 5.0), [1.0] * 10)
    assert outcome(run, CENTRE) is Outcome.YES


def test_a_scarp_that_stopped_below_the_top_is_a_no():
    x = load("figure1").centres()
    start = 3.2 * (100 - x)
    run = run_of(np.where(x > 30, 5.0, start), [1.0] * 5 + [0.1, 0.05, 0.02, 0.01, 0.005])
    assert outcome(run, CENTRE) is Outcome.NO


def test_growth_against_the_spreading_is_a_start_and_the_spreading_alone_a_no():
    start = 3.2 * (100 - load("figure1").centres())
    t = np.linspace(0.0, 900.0, 10)
    t[0] = 1.0
    growing, spreading, decaying = (np.exp(sigma * t) / np.sqrt(t) for sigma in (1e-4, 0, -1e-4))
    assert outcome(run_of(start, growing), CENTRE) is Outcome.STARTS
    assert outcome(run_of(start, decaying), CENTRE) is Outcome.NO
    assert outcome(run_of(start, spreading * 0.9999**t), CENTRE) is Outcome.NO


def test_the_top_has_come_down_once_half_of_its_excess_height_is_gone():
    x = np.arange(0.5, 100)
    start = 2.0 * (100 - x)
    assert not reached_the_top(x, start, start - 0.49 * (start[0] - start[-1]))
    assert reached_the_top(x, start, start - 0.51 * (start[0] - start[-1]))


def test_a_slope_below_repose_cannot_run_to_the_top():
    x = np.arange(0.5, 100)
    assert not reached_the_top(x, 0.3 * x, 0.3 * x - 50)


def test_an_avalanche_is_spent_at_a_millionth_of_its_pulse():
    start = 3.2 * (100 - load("figure1").centres())
    assert spent(run_of(start, [1.0, 0.5, 9e-7]))
    assert not spent(run_of(start, [1.0, 0.5, 2e-6]))


def test_the_slope_is_that_of_the_middle_half_whatever_the_ends_do():
    x = np.arange(0.25, 100, 0.5)
    h = 0.37 * (100 - x)
    h[x < 24] += 7
    h[x > 76] -= 3
    assert slope(x, h) == pytest.approx(0.37, rel=1e-12)
    assert slope(x, h + 0.02 * np.sin(math.tau * x)) == pytest.approx(0.37, abs=1e-4)
