import itertools

import numba
import numpy as np
import pytest
from numba import types
from numba.core.runtime import _nrt_python, rtsys

from bcre_pde import Material, exchange
from bcre_pde.line import fluxes

law = exchange.exchange
GAMMA, KAPPA, SATURATION = 0.7, 0.3, 1.75


def arguments(n, kappa, saturation, periodic=False, seed=3, D=0.2):
    rng = np.random.default_rng(seed)
    state = np.array([rng.normal(size=n), rng.uniform(-0.5, 3, n), rng.normal(size=n)])
    scratch = np.empty((2, n + 6)), np.empty((2, n + 1))
    return state, np.empty((3, n)), *scratch, 1.3, D, GAMMA, kappa, 0.5, periodic, saturation


def test_linear_law_is_gamma_R_times_the_excess_slope_and_kappa_R_times_the_curvature():
    assert law(2.0, -0.5, 0.0, GAMMA, None, None) == pytest.approx(GAMMA * 2.0 * 0.5)
    assert law(2.0, 0.0, 0.25, GAMMA, KAPPA, None) == pytest.approx(-KAPPA * 2.0 * 0.25)
    assert law(2.0, -0.5, 0.25, GAMMA, KAPPA, None) == pytest.approx(2.0 * (0.35 - 0.075))


def test_saturated_law_tends_to_the_linear_one_for_a_thin_layer_and_to_v_up_for_a_thick_one():
    v_up = 0.4
    thin = law(1e-9, -0.5, 0.0, GAMMA, None, GAMMA / v_up)
    thick = law(1e9, -0.5, 0.0, GAMMA, None, GAMMA / v_up)
    assert thin == pytest.approx(law(1e-9, -0.5, 0.0, GAMMA, None, None), rel=1e-8)
    assert thick == pytest.approx(v_up * 0.5, rel=1e-8)


def test_layer_below_zero_exchanges_nothing_under_any_law():
    for kappa, saturation in itertools.product((None, KAPPA), (None, SATURATION)):
        assert law(-1.0, -0.5, 0.25, GAMMA, kappa, saturation) == 0


@pytest.mark.parametrize("kappa", [None, KAPPA])
@pytest.mark.parametrize("saturation", [None, SATURATION])
def test_compiled_right_hand_side_holds_the_law_of_the_module(kappa, saturation):
    """To the bit, next to the ends too: cached code of an older law would show."""
    n, dx = 21, 0.5
    given = arguments(n, kappa, saturation)
    fluxes.rate(*given)
    (u, R, _), (du, dR, _), (padded, _), (u_face, flux) = given[:4]
    for i in range(3, n - 3):
        w = padded[i : i + 7]
        bend = 2 * (w[0] + w[6]) - 27 * (w[1] + w[5]) + 270 * (w[2] + w[4]) - 490 * w[3]
        per_bend = None if kappa is None else kappa / (180 * dx * dx)
        E = law(R[i], u_face[i + 1] - u_face[i], bend, GAMMA / dx, per_bend, saturation)
        assert du[i] == -E
        assert dR[i] == (flux[i] - flux[i + 1]) / dx + E
    edge = None if kappa is None else kappa / dx**2
    first = (-11 * u[0] + 18 * u[1] - 9 * u[2] + 2 * u[3]) / 6
    assert du[0] == -law(R[0], first, 0.0, GAMMA / dx, edge, saturation)


@pytest.mark.parametrize("periodic", [True, False])
@pytest.mark.parametrize("seed", range(5))
def test_absent_term_is_a_term_of_zero_to_the_bit(periodic, seed):
    rates = []
    for D, kappa, saturation in itertools.product((None, 0.0), repeat=3):
        given = arguments(40, kappa, saturation, periodic, seed, D)
        fluxes.rate(*given)
        rates.append(given[1])
    assert all(np.array_equal(rates[0], other) for other in rates)


def operations(kappa, saturation):
    """How often the compiled law multiplies and divides."""
    compiled = numba.njit(error_model="numpy")(law)
    x = types.float64
    signature = (x, x, x, x, kappa, saturation)
    compiled.compile(signature)
    text = compiled.inspect_llvm(signature)
    return text.count("fmul double"), text.count("fdiv double")


def test_absent_terms_are_not_in_the_compiled_code():
    x, absent = types.float64, types.none
    without = operations(absent, absent)
    assert without[1] == 0
    assert operations(x, absent)[0] > without[0]
    assert operations(x, absent)[1] == 0
    assert operations(absent, x)[1] > 0


def test_material_passes_an_absent_term_as_none():
    assert Material(1.0, 0.1, 0.3, 0.5).saturation is None
    assert Material(1.0, 0.1, 0.3, 0.5, v_up=0.6).saturation == pytest.approx(0.5)


def allocations(function, given):
    """By numba's runtime, in 50 calls."""
    function(*given)
    before = rtsys.get_allocation_stats().alloc
    for _ in range(50):
        function(*given)
    return rtsys.get_allocation_stats().alloc - before


@pytest.mark.parametrize("n", [10, 1000])
def test_right_hand_side_allocates_nothing(n):
    """No more, that is, than what receiving its arrays takes in a function that does nothing."""

    @numba.njit
    def nothing(state, out, padded, faces):
        pass

    rtsys.initialize(numba.core.registry.cpu_target.target_context)
    _nrt_python.memsys_enable_stats()
    try:
        given = arguments(n, KAPPA, SATURATION)
        received = allocations(nothing, given[:4])
        assert allocations(fluxes.rate, given) == received
    finally:
        _nrt_python.memsys_disable_stats()
    assert received > 0
