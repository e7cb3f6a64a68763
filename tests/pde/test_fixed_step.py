import math

import numpy as np
import pytest
from numpy.polynomial import polynomial
from scipy.optimize import bisect

from bcre_pde import Material, Problem, largest_explicit_step, solve, theory
from bcre_pde.equation import BCRE
from bcre_pde.explicit import Step, tableau
from bcre_pde.fixed_step import take_fixed_steps

METHODS = ["runge-kutta", "RK45", "DOP853"]
ORDERS = {"runge-kutta": 4, "RK45": 5, "DOP853": 8}
CELLS, DIRECTIONS = 64, {"drift": (1, 0, 0), "spread": (0, 1, 0), "both": (1, 0.3, 0)}
DIRECTIONS |= {"climb": (0, 0, 1)}


def steps_of_a_wave(method, numbers, wave, steps):
    """``steps`` steps of u where it climbs under R = 1, else of R alone; dx = dt = 1."""
    courant, diffusion_number, climb_number = numbers
    material = Material(courant, diffusion_number, climb_number, 0.5)
    if climb_number:
        return take_fixed_steps(material, wave, np.ones(CELLS), 1.0, 1.0, steps, method)[0]
    return take_fixed_steps(material, np.zeros(CELLS), wave, 1.0, 1.0, steps, method)[1]


def rough(seed):
    """So small that products of waves vanish, and of mean zero."""
    noise = np.random.default_rng(seed).uniform(-1e-150, 1e-150, CELLS)
    return noise - noise.mean()


@pytest.mark.parametrize("method", METHODS)
def test_stability_polynomial_is_the_exponential_up_to_the_order(method):
    P = theory.stability_polynomial(method)
    order = ORDERS[method]
    exponential = [1 / math.factorial(k) for k in range(P.size)]
    assert P[: order + 1] == pytest.approx(exponential[: order + 1], rel=1e-13)
    assert abs(P[order + 1] / exponential[order + 1] - 1) > 0.02


def test_fehlberg_keeps_its_fourth_order_solution():
    """z^5/104 is that of the fourth-order formula; the fifth-order one would have z^5/120."""
    assert theory.stability_polynomial("runge-kutta")[5] == pytest.approx(1 / 104, rel=1e-13)


def test_spectrum_tends_to_that_of_the_equation_for_long_waves():
    k = 0.05
    assert theory.spectrum(0.7, 0.3, k) == pytest.approx(
        theory.rolling_mode_rate(0.7, 0.3, k), abs=1e-8
    )
    assert theory.spectrum(0.7, 0.0, k).conj() == pytest.approx(
        theory.surface_mode_rate(0.35, 0.0, 2.0, k), abs=1e-8
    )


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    ("numbers", "shortest"),
    [((0.7, 0, 0), 10), ((0, 0.3, 0), 32), ((0.7, 0.2, 0), 10), ((0, 0, 0.6), 10)],
)
def test_one_step_multiplies_a_wave_by_the_polynomial(method, numbers, shortest):
    """Every wave under diffusion; under drift and climb those the limiter leaves alone."""
    P = theory.stability_polynomial(method)
    for waves in range(1, shortest + 1):
        angle = 2 * math.pi * waves / CELLS
        wave = 1e-150 * np.cos(angle * np.arange(CELLS) + 0.3)
        after = steps_of_a_wave(method, numbers, wave, 1)
        measured = np.fft.fft(after)[waves] / np.fft.fft(wave)[waves]
        courant, diffusion_number, climb_number = numbers
        rate = theory.spectrum(courant, diffusion_number, angle)
        if climb_number:
            rate = theory.spectrum(climb_number, 0.0, angle).conj()
        assert measured == pytest.approx(complex(polynomial.polyval(rate, P)), abs=1e-13)


def test_wave_of_few_cells_is_limited_towards_the_cell_upwind():
    """The shortest one of all entirely: it decays as the first-order upwind scheme has it."""
    zigzag = 1e-150 * (-1.0) ** np.arange(CELLS)
    P = theory.stability_polynomial("RK45")
    found = steps_of_a_wave("RK45", (0.2, 0, 0), zigzag, 1)[0] / zigzag[0]
    smooth = polynomial.polyval(theory.spectrum(0.2, 0.0, math.pi), P).real
    upwind = polynomial.polyval(theory.spectrum(0.2, 0.0, math.pi, rough=True), P).real
    assert found == pytest.approx(upwind, rel=1e-12)
    assert abs(found - smooth) > 0.1


@pytest.mark.parametrize("direction", DIRECTIONS)
@pytest.mark.parametrize("method", ["runge-kutta", "RK45"])
def test_rough_layers_grow_from_the_predicted_boundary_on(method, direction):
    """2 % below the boundary of rough waves nothing grows, 3 % above everything does."""

    def numbers(size):
        return tuple(size * part for part in DIRECTIONS[direction])

    def excess(size):
        return theory.amplification_bound(*numbers(size), method, rough=True) - 1 - 1e-9

    boundary = bisect(excess, 0.05, 10.0)
    for seed in range(3):
        noise = rough(seed)
        below = steps_of_a_wave(method, numbers(0.98 * boundary), noise, 300)
        assert np.abs(below).max() < 2 * np.abs(noise).max()
        above = steps_of_a_wave(method, numbers(1.03 * boundary), noise, 300)
        assert not np.abs(above).max() < 10 * np.abs(noise).max()


def test_prediction_needs_the_rough_waves_where_drift_and_diffusion_act_together():
    """At this step every smooth wave decays, and rough layers grow fourfold all the same."""
    numbers = (0.98, 0.294, 0.0)
    assert theory.amplification_bound(*numbers, "runge-kutta") == pytest.approx(1)
    assert not theory.stable(*numbers, "runge-kutta")
    noise = rough(0)
    grown = steps_of_a_wave("runge-kutta", numbers, noise, 20)
    assert np.abs(grown).max() > 1e6 * np.abs(noise).max()


def test_prediction_promises_too_much_for_the_drift_of_dop853():
    noise = rough(0)
    assert theory.stable(2.6, 0.0, 0.0, "DOP853")
    assert np.abs(steps_of_a_wave("DOP853", (2.6, 0, 0), noise, 100)).max() > np.abs(noise).max()
    calm = steps_of_a_wave("DOP853", (1.9, 0, 0), noise, 300)
    assert np.abs(calm).max() < 2 * np.abs(noise).max()


def test_growth_is_that_of_the_fastest_wave_under_diffusion():
    bound = theory.amplification_bound(0.0, 0.55, 0.0, "runge-kutta")
    sizes = [
        np.abs(steps_of_a_wave("runge-kutta", (0, 0.55, 0), rough(1), steps)).max()
        for steps in (800, 820)
    ]
    assert (sizes[1] / sizes[0]) ** (1 / 20) == pytest.approx(bound, rel=1e-6)
    assert bound > 1.5


def test_largest_explicit_step_is_stable_by_the_prediction():
    for v, D, gamma in [(1.0, 0.0, 0.2), (0.01, 0.2, 0.3), (1.0, 0.2, 3.0)]:
        dx, R = 0.5, 2.0
        dt = largest_explicit_step(Material(v, D, gamma, 0.5), dx, R)
        numbers = v * dt / dx, D * dt / dx**2, gamma * R * dt / dx
        assert theory.stable(*numbers, "runge-kutta")


@pytest.mark.parametrize("ends", ["open", "periodic"])
@pytest.mark.parametrize("method", METHODS)
def test_short_fixed_steps_reach_the_adaptive_solution(method, ends):
    material, length = Material(1.0, 0.2, 0.3, 0.5, 0.05), 20.0

    def initial(x):
        u = 0.3 * np.cos(2 * math.pi * x / length)
        return u - 0.5 * x, 1 + 0.4 * np.sin(2 * math.pi * x / length)

    reference = solve(Problem(initial, material, length, ends), [1.0], 40, tolerance=1e-12)
    h, R = initial(reference.x)
    foot = float(initial(np.array([length]))[0][0]) + 0.5 * length
    u = h + 0.5 * reference.x
    found = take_fixed_steps(material, u, R, 0.5, 0.01, 100, method, ends, foot)
    assert found[0] == pytest.approx(reference.u[0], abs=1e-8)
    assert found[1] == pytest.approx(reference.R[0], abs=1e-8)


@pytest.mark.parametrize("ends", ["open", "periodic"])
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("more", [{}, {"kappa": 0.05, "v_up": 2.0}])
def test_compiled_steps_are_those_of_the_solvers_to_the_bit(method, ends, more):
    material = Material(1.0, 0.2, 0.3, 0.5, **more)
    rng = np.random.default_rng(2)
    u, R = rng.uniform(-1, 1, 40), rng.uniform(0, 1, 40)
    grid = BCRE.grid(20.0, 40, ends)
    layers, new = BCRE.state(grid, u, R, 0.3).data, np.empty((3, 40))
    step = Step(BCRE(material, grid), tableau(method))
    for number in range(7):
        step(layers, number * 0.1, 0.1, new)
        layers, new = new.copy(), new
    found = take_fixed_steps(material, u, R, 0.5, 0.1, 7, method, ends, 0.3)
    assert np.array_equal(found, layers[:2])


def test_no_step_leaves_the_layers_alone():
    u, R = rough(0), np.abs(rough(1))
    found = take_fixed_steps(Material(1.0, 0.2, 0.3, 0.5), u, R, 1.0, 1.0, 0)
    assert np.array_equal(found, [u, R])


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"dt": 0.0}, r"^dt = 0.0: must be a finite number > 0"),
        ({"dx": math.nan}, r"^dx = nan: must be a finite number > 0"),
        ({"steps": -1}, r"^steps = -1: must be a whole number, at least 0"),
        ({"method": "BDF"}, r"^method = 'BDF': must be explicit"),
        ({"u": np.zeros(7)}, r"^cells = 7: must be a whole number, at least 8"),
    ],
)
def test_bad_argument_is_refused_with_its_name_and_value(options, message):
    arguments = {"u": np.zeros(8), "R": np.ones(8), "dx": 1.0, "dt": 0.1, "steps": 1} | options
    with pytest.raises(ValueError, match=message):
        take_fixed_steps(Material(1.0, 0.2, 0.3, 0.5), **arguments)
