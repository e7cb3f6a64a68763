"""Thick layers, which carry v R + Gamma R^2/2."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bcre_ca import Rule, UnstableStep, evolve, step
from bcre_ca.line import kernels

RULE = Rule(v=0.7, D=0.2, gamma=0.3, Sc=0.5, d=0.5, dt=0.05, v_up=1.5, Gamma=0.4)


def layers(seed, cells=60):
    rng = np.random.default_rng(seed)
    h = 0.2 * rng.normal(size=cells) - 0.6 * 0.5 * np.arange(cells)
    return h, np.where(rng.random(cells) < 0.3, 0.0, 2 * rng.random(cells))


@given(seed=st.integers(0, 2**32 - 1), Gamma=st.floats(1e-3, 2))
def test_compiled_steps_are_the_plain_ones_to_the_bit(seed, Gamma):
    rule = replace(RULE, Gamma=Gamma, D=0.0)
    h, R = layers(seed)
    account, compiled = np.zeros(2), (h.copy(), R.copy())
    kernels.march(*compiled, rule, 5, "open", account)
    lost = []
    for _ in range(5):
        h, R, outflow = step(h, R, rule)
        lost.append(outflow)
    assert np.array_equal(compiled[0], h)
    assert np.array_equal(compiled[1], R)
    assert account[0] == pytest.approx(math.fsum(lost), rel=1e-14)


@given(seed=st.integers(0, 2**32 - 1), ends=st.sampled_from(["open", "periodic"]))
def test_thick_layer_carries_half_gamma_r_squared_more(seed, ends):
    h, R = layers(seed)
    thick, thin = (step(h, R, replace(RULE, Gamma=Gamma), ends) for Gamma in (0.4, 0.0))
    more = 0.2 * R**2 * RULE.dt / RULE.d
    into = np.roll(more, 1)
    if ends == "open":
        into[0] = 0.0
    assert thick[0] == pytest.approx(thin[0], abs=1e-15)
    assert thick[1] == pytest.approx(thin[1] + into - more, abs=1e-14)
    assert thick[2] == pytest.approx(thin[2] + (more[-1] if ends == "open" else 0.0))


def order(cells, errors):
    return float(-np.polyfit(np.log(cells), np.log(errors), 1)[0])


@pytest.mark.parametrize(
    ("v", "gamma", "Gamma", "v_up"), [(0.6, 0.5, 0.4, 0.9), (0.3, 0.8, 0.9, 2.0)]
)
def test_order_of_the_rule_on_the_simple_wave_of_a_thick_layer_is_one(v, gamma, Gamma, v_up):
    """R = R0(x + c(R) t), u = -R - (v/gamma) ln R - (Gamma/gamma + v/v_up) R - (Gamma/v_up) R^2/2.

    In the middle, which what the ends do has not reached.
    """
    length, until, grids, errors = 40.0, 2.0, (200, 400, 800), []
    for cells in grids:
        d = length / cells
        x = (np.arange(cells) + 0.5) * d

        def R_at(t, x=x):
            R = np.ones_like(x)
            for _ in range(300):
                c = gamma * R / (1 + gamma * R / v_up)
                R = 1 + 0.3 * np.exp(-(((x + c * t - 20) / 2.5) ** 2))
            return R

        def u_of(R):
            linear = Gamma / gamma + v / v_up
            return -R - v / gamma * np.log(R) - linear * R - Gamma / v_up * R**2 / 2

        rule = Rule(v, 0.0, gamma, 0.5, d, until / (2 * cells), v_up=v_up, Gamma=Gamma)
        h, R = evolve(u_of(R_at(0)) - 0.5 * x, R_at(0), rule, 2 * cells)
        inside = (x > 12) & (x < 28)
        exact = R_at(until)
        gaps = R - exact, h + 0.5 * x - u_of(exact)
        errors.append([np.abs(gap[inside]).mean() for gap in gaps])
    for kind in np.transpose(errors):
        assert 0.9 <= order(grids, kind) <= 1.1
        assert kind[-1] < 3e-3


def test_rule_without_gamma_leaves_the_term_out():
    thin = replace(RULE, Gamma=0.0)
    assert thin.parameters().Gamma is None
    assert thin.coefficients().thickening is None
    assert RULE.coefficients().thickening == 0.4 * 0.05 / (2 * 0.5)


@given(v=st.floats(0, 3), Gamma=st.floats(1e-3, 3), D=st.floats(0, 3), layer=st.floats(0, 20))
def test_step_is_bounded_by_the_speed_of_the_wave_of_a_thick_layer(v, Gamma, D, layer):
    """(v + Gamma R) dt/d + 2 D dt/d^2 + gamma dt (Sc - S) <= 1 and gamma X(R) dt/d <= 1."""
    rule = replace(RULE, v=v, Gamma=Gamma, D=D)
    X = layer / (1 + 0.3 * layer / 1.5)
    rates = [(v + Gamma * layer) / 0.5 + 2 * D / 0.25 + 0.3 * 0.2, 0.3 * X / 0.5]
    assert rule.max_stable_step(layer, 0.3) == pytest.approx(1 / max(rates), rel=1e-12)


def test_unstable_step_names_the_bound_of_thick_layers():
    h, R = np.zeros(20), np.full(20, 50.0)
    with pytest.raises(UnstableStep, match=r"\(v \+ Gamma R\) dt/d"):
        evolve(h, R, RULE, 1)


@pytest.mark.parametrize("scheme", ["calibrated", "limited"])
def test_only_the_upwind_scheme_carries_thick_layers(scheme):
    with pytest.raises(ValueError, match=f"Gamma = 0.4: must be 0 where scheme = '{scheme}'"):
        replace(RULE, scheme=scheme)
    with pytest.raises(ValueError, match=r"Gamma = 0\.4: must be 0\.0 where order = 'left'"):
        replace(RULE, v_up=math.inf, order="left")


@given(R0=st.floats(0, 3), dt=st.floats(1e-3, 0.1))
def test_effective_diffusion_is_that_of_the_wave_under_the_layer(R0, dt):
    rule = replace(RULE, dt=dt)
    speed = 0.7 + 0.4 * R0
    expected = 0.2 + speed * 0.5 / 2 * (1 - speed * dt / 0.5)
    assert rule.effective_diffusion(R0) == pytest.approx(expected, rel=1e-12)
    climb = 0.3 * R0 / (1 + 0.3 * R0 / 1.5)
    expected = 0.3 * 0.5 / 2 * (1 - climb * dt / 0.5)
    assert rule.effective_curvature(R0) == pytest.approx(expected, rel=1e-12)
