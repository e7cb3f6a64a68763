"""Hwa and Kardar's surface: the Cole-Hopf solution, rest, conservation, seeded noise."""

import math

import numpy as np
import pytest
import sympy as sp

from bcre_pde import Problem, solve
from bcre_pde.line import hwa_kardar as hw

LENGTH = 10.0
M = hw.Surface(nu=0.3, lam=0.7, Sc=0.4, level=2.0)
K = 2 * math.pi / LENGTH


def problem(w, material=M, ends="periodic"):
    level = material.level
    return Problem(lambda x: (level - material.Sc * x + w(x), 0 * x), material, LENGTH, ends)


def test_cole_hopf_wave_obeys_the_equation():
    x, t = sp.symbols("x t")
    nu, lam, a, k = sp.symbols("nu lam a k", positive=True)
    phi = 1 + a * sp.exp(-nu * k**2 * t) * sp.cos(k * x)
    w = -2 * nu / lam * phi.diff(x) / phi
    assert sp.simplify(w.diff(t) - nu * w.diff(x, 2) + lam / 2 * (w**2).diff(x)) == 0
    values = {nu: 0.3, lam: 0.7, a: 0.6, k: K, x: 1.3, t: 0.8}
    expected = float(w.subs(values))
    assert hw.decaying_wave(np.array(1.3), 0.8, M, 0.6, K) == pytest.approx(expected, rel=1e-13)


def test_order_of_pde_on_the_cole_hopf_wave_is_at_least_four():
    cells, errors = [16, 32, 64], []
    for n in cells:
        found = solve(
            problem(lambda x: hw.decaying_wave(x, 0.0, M, 0.6, K)),
            [2.0],
            n,
            tolerance=1e-12,
            equation=hw.HwaKardar,
        )
        gap = found.u[-1] - M.level - hw.decaying_wave(found.x, 2.0, M, 0.6, K)
        errors.append(np.abs(gap).mean())
    assert -np.polyfit(np.log(cells), np.log(errors), 1)[0] > 4.5
    assert errors[-1] < 2e-7


@pytest.mark.parametrize("ends", ["open", "wall", "periodic"])
def test_height_is_conserved_and_no_layer_appears(ends):
    found = solve(
        problem(lambda x: 1 + np.sin(3 * x), ends=ends), [0.0, 3.0], 40, equation=hw.HwaKardar
    )
    mass = found.mass() + found.outflow
    assert mass[1] == pytest.approx(mass[0], rel=1e-13)
    assert not found.R.any()
    assert bool(found.outflow[1] > 0) is (ends == "open")


@pytest.mark.parametrize("excess", [1.0, 3.0])
def test_slope_above_repose_falls_below_it_as_one_over_lambda_t(excess):
    """w_x = -s at first, a wave that thins out: w = x/(lambda t) where its top has passed."""
    m = hw.Surface(0.001, 0.2, 0.5)
    t = 400.0
    start = problem(lambda x: excess * (LENGTH - x), m, "open")
    found = solve(start, [t], 100, equation=hw.HwaKardar)
    middle = (found.x > 3) & (found.x < 8)
    s = -np.polyfit(found.x[middle], found.u[-1][middle], 1)[0]
    assert s == pytest.approx(-1 / (m.lam * t), rel=0.05)


def test_noise_is_white_of_its_variance_and_repeats_with_its_seed():
    """Without lambda a mode k has the variance noise/(2 nu k^2 L) (Edwards and Wilkinson)."""
    m, cells, dt = hw.Surface(0.3, 0.0, 0.4, noise=0.05), 20, 0.05
    quiet = problem(lambda x: 0 * x, m)
    times = np.arange(0.0, 700.0, 4.0)
    w = hw.evolve_with_noise(quiet, times, cells, dt, seed=3)
    assert np.array_equal(w[:3], hw.evolve_with_noise(quiet, times[:3], cells, dt, seed=3))
    assert not np.array_equal(w[:3], hw.evolve_with_noise(quiet, times[:3], cells, dt, seed=4))
    modes = np.fft.rfft(w, axis=1)[10:] / cells
    k = K * np.arange(2, 7)
    ratio = (np.abs(modes[:, 2:7]) ** 2).mean(axis=0) * 2 * m.nu * k**2 * LENGTH / m.noise
    # Neighbouring frames are nearly independent: 165 of them, 2 degrees of freedom each.
    assert ratio.mean() == pytest.approx(1, abs=4 / math.sqrt(5 * 165))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"nu": -1.0}, "nu = -1.0"),
        ({"noise": math.nan}, "noise = nan"),
        ({"level": math.inf}, "level = inf"),
    ],
)
def test_impossible_coefficients_are_refused_by_name(changes, message):
    with pytest.raises(ValueError, match=message):
        hw.Surface(**({"nu": 1.0, "lam": 1.0, "Sc": 0.5} | changes))
