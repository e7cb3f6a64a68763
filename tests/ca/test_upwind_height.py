"""The one-layer rule: order, nu_eff, conservation, bounds."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bcre_ca.upwind_height import largest_stable_step, march


def cole_hopf(x, t, nu, lam, a, k):
    """w = -(2 nu/lambda) phi_x/phi, phi = 1 + a exp(-nu k^2 t) cos kx."""
    part = a * np.exp(-nu * k**2 * t)
    return 2 * nu / lam * k * part * np.sin(k * x) / (1 + part * np.cos(k * x))


@pytest.mark.parametrize(("nu", "lam", "a"), [(0.3, 0.7, 0.6), (0.1, 1.4, 0.8)])
def test_order_on_the_cole_hopf_wave_is_one(nu, lam, a):
    length, until, grids, errors = 10.0, 1.2, (64, 128, 256), []
    k = 2 * math.pi / length
    for cells in grids:
        d = length / cells
        x = (np.arange(cells) + 0.5) * d
        start = cole_hopf(x, 0.0, nu, lam, a, k)
        steps = math.ceil(until / (0.4 * largest_stable_step(start, lam, nu, d)))
        w = march(start, lam, nu, d, until / steps, steps)
        errors.append(np.abs(w - cole_hopf(x, until, nu, lam, a, k)).mean())
    assert 0.9 <= -np.polyfit(np.log(grids), np.log(errors), 1)[0] <= 1.1
    assert errors[-1] < 0.01 * np.abs(start).max()


@pytest.mark.parametrize("level", [0.8, -0.8])
def test_small_waves_on_a_level_spread_by_nu_and_half_the_cell(level):
    """nu_eff = nu + (lambda abs(w) d/2)(1 - lambda abs(w) dt/d), and move at lambda w."""
    lam, nu, d, dt, cells, steps = 0.5, 0.05, 0.1, 0.05, 400, 400
    x = (np.arange(cells) + 0.5) * d
    k = 2 * math.pi * 2 / (cells * d)
    w = march(level + 1e-6 * np.cos(k * x), lam, nu, d, dt, steps)
    mode = np.fft.rfft(w - level)[2] / np.fft.rfft(1e-6 * np.cos(k * x))[2]
    speed = lam * abs(level)
    expected = nu + speed * d / 2 * (1 - speed * dt / d)
    assert -math.log(abs(mode)) / (k**2 * steps * dt) == pytest.approx(expected, rel=1e-2)
    assert -np.angle(mode) / (k * steps * dt) == pytest.approx(lam * level, rel=1e-2)


@given(seed=st.integers(0, 1000))
def test_height_is_conserved_and_never_larger_than_at_the_start(seed):
    rng = np.random.default_rng(seed)
    start, lam, nu, d = rng.normal(size=30), 0.7, 0.1, 0.3
    dt = largest_stable_step(start, lam, nu, d)
    end = march(start, lam, nu, d, dt, 20)
    assert end.sum() == pytest.approx(start.sum(), abs=1e-12)
    assert end.max() <= start.max() + 1e-12
    assert end.min() >= start.min() - 1e-12
    assert np.array_equal(start, np.random.default_rng(seed).normal(size=30))


def test_step_past_the_bound_is_refused_with_it():
    with pytest.raises(ValueError, match=r"dt = 0\.6: must be > 0 and at most 0\.5"):
        march(np.array([1.0, -2.0]), 0.5, 0.5, 1.0, 0.6, 1)
