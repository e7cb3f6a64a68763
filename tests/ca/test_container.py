"""Lines with sources and walls, and a layer that the slope drives."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bcre_ca import Pile, Rule, Source, UnstableStep, evolve, frames, largest_stable_step, step
from bcre_ca.line import kernels
from bcre_ca.line.sources import supply_of

UPWIND = Rule(v=0.7, D=0.2, gamma=0.3, Sc=0.5, d=0.5, dt=0.05, Gamma=0.2, v_up=1.5, kappa=0.02)
DRIVEN = Rule(v=0.0, D=0.1, gamma=0.35, Sc=0.45, d=0.5, dt=0.05, beta=0.9)
KINDS = pytest.mark.parametrize("rule", [UPWIND, DRIVEN], ids=["upwind", "slope driven"])
LENGTH = 10.0
SOURCES = (Source(0.4, 0.5, 1.0, 0.3, 7.7), Source(0.2, 6.1, 0.7, 2.2, 5.0))


def rough(seed, rule, cells=20):
    rng = np.random.default_rng(seed)
    x = (np.arange(cells) + 0.5) * rule.d
    h = rule.Sc * (cells * rule.d - x) + 0.2 * rng.normal(size=cells)
    return h, np.where(rng.random(cells) < 0.4, 0.0, rng.random(cells))


@KINDS
@given(seed=st.integers(0, 2**32 - 1), ends=st.sampled_from(["open", "wall", "periodic"]))
def test_compiled_steps_are_the_plain_ones_to_the_bit(rule, seed, ends):
    h, R = rough(seed, rule)
    supply = np.random.default_rng(seed).random(h.size)
    account, compiled, lost = np.zeros(2), (h.copy(), R.copy()), []
    kernels.march(*compiled, rule, 7, ends, account, supply)
    for _ in range(7):
        h, R, outflow = step(h, R, rule, ends, supply=supply)
        lost.append(outflow)
    assert np.array_equal(compiled[0], h)
    assert np.array_equal(compiled[1], R)
    assert account[0] == pytest.approx(math.fsum(lost), rel=1e-14)
    assert bool(account[0]) is (ends == "open")


@given(
    seed=st.integers(0, 2**32 - 1),
    dry=st.sampled_from([0.0, 1e-2]),
    ends=st.sampled_from(["open", "periodic"]),
)
def test_line_that_nothing_pours_on_is_the_papers_to_the_bit(seed, dry, ends):
    rule = replace(UPWIND, dry=dry)
    h, R = rough(seed, rule, cells=16)  # so that Sc d N, in either order, is the same number
    expected = step(h, R, rule, ends)
    found = step(h, R, rule, ends, supply=np.zeros(h.size))
    assert all(np.array_equal(a, b) for a, b in zip(found, expected, strict=True))


def test_slope_driven_layer_on_an_even_slope_is_the_papers_to_the_bit():
    """beta S = v at every face, in numbers that no operation rounds, and the slope frozen."""
    S, cells = 0.75, 40
    h = S * 0.5 * (cells - np.arange(cells))
    R = np.exp(-(((np.arange(cells) - 20) / 4) ** 2))
    paper = Rule(v=0.375, D=0.125, gamma=0.25, Sc=0.5, d=0.5, dt=0.25)
    driven = replace(paper, v=0.0, beta=0.5)
    _, expected, _ = step(h, R, paper)
    _, found, _ = step(h, R, driven)
    assert found[:-1] == pytest.approx(expected[:-1], rel=1e-15)
    no_spread = [replace(rule, D=0.0) for rule in (paper, driven)]
    (_, expected, _), (_, found, _) = (step(h, R, rule) for rule in no_spread)
    assert np.array_equal(found[:-1], expected[:-1])


@KINDS
@pytest.mark.parametrize("ends", ["open", "wall"])
@pytest.mark.parametrize("dt", ["auto", 0.05])
def test_mass_with_sources_is_exact_to_rounding(rule, ends, dt):
    h, R = rough(1, rule)
    times = [0.0, 1.0, 4.0, 30.0]
    piles = list(frames(Pile(h, R), rule, times, ends, dt, sources=SOURCES))
    for pile in piles:
        poured = 0.4 * max(min(pile.t, 7.7) - 0.3, 0) + 0.2 * max(min(pile.t, 5.0) - 2.2, 0)
        balance = pile.mass(rule.d) + pile.outflow - poured - piles[0].mass(rule.d)
        assert abs(balance) <= 1e-12 * (piles[0].mass(rule.d) + poured)
        assert pile.R.min() >= 0
    assert bool(piles[-1].outflow > 0) is (ends == "open")


def test_steps_do_not_depend_on_the_recorded_times():
    h, R = rough(2, UPWIND)
    few, many = (
        list(frames(Pile(h, R), UPWIND, times, "wall", sources=SOURCES))[-1]
        for times in ([9.0], [0.1, 0.25, 3.0, 7.7, 9.0])
    )
    assert np.array_equal(few.h, many.h)
    assert np.array_equal(few.R, many.R)


def test_source_begins_and_ends_when_it_says():
    still = Rule(v=0.0, D=0.0, gamma=0.0, Sc=0.5, d=0.5, dt=0.1)
    pour = Source(1.0, 5.0, 2.0, 0.3, 0.9)
    piles = frames(Pile(np.zeros(20), np.zeros(20)), still, [0.2, 0.5, 2.0], "wall", sources=[pour])
    assert [pile.R[10] for pile in piles] == pytest.approx([0.0, 0.1, 0.3], abs=1e-14)


@given(
    place=st.floats(1, 9),
    width=st.floats(1e-3, 2),
    cells=st.integers(1, 60),
    rate=st.floats(1e-3, 1e3),
)
def test_cells_get_what_is_poured_whatever_the_grid(place, width, cells, rate):
    d = LENGTH / cells
    supply = supply_of([Source(rate, place, width)], 0.0, cells, d)
    assert (supply >= 0).all()
    assert supply.sum() * d == pytest.approx(rate, rel=1e-12)
    i = np.arange(cells)
    covered = ((i + 1) * d > place - width / 2) & (i * d < place + width / 2)
    assert not supply[~covered].any()


@pytest.mark.parametrize(("R0", "A"), [(0.8, 1e-3), (0.5, -1e-3)])
def test_order_of_the_slope_driven_rule_on_the_exponential_slope_is_one(R0, A):
    """R = R0, S - Sc = A exp((gamma/beta)(x + gamma R0 t)): what falls faster is what is eroded.

    In the middle, which what the ends do has not reached.
    """
    rule, until, grids, errors = replace(DRIVEN, D=0.0), 2.0, (100, 200, 400), []
    rate = rule.gamma / rule.beta
    for cells in grids:
        d = 16.0 / cells
        x = (np.arange(cells) + 0.5) * d

        def h_at(t, x=x):
            return -rule.Sc * x - A / rate * np.exp(rate * (x + rule.gamma * R0 * t))

        steps = 6 * cells
        h, R = evolve(h_at(0), np.full(cells, R0), replace(rule, d=d, dt=until / steps), steps)
        inside = (x > 6) & (x < 10)
        errors.append([np.abs(R - R0)[inside].mean(), np.abs(h - h_at(until))[inside].mean()])
    for kind in np.transpose(errors):
        assert 0.9 <= -np.polyfit(np.log(grids), np.log(kind), 1)[0] <= 1.1
        assert kind[-1] < abs(A)


def silo(rule, d):
    """S(x) and R(x) of a silo of LENGTH that rises at 0.1, between the cells."""
    cells, rate = round(LENGTH / d), 0.1 * LENGTH
    start = Pile(np.zeros(cells), np.zeros(cells))
    source = Source(rate, 0.25, 0.5)
    rule = replace(rule, d=d)
    (pile,) = frames(start, rule, [240.0], "wall", sources=[source])
    x = (np.arange(cells) + 0.5) * d
    return (
        lambda at: np.interp(at, x[:-1] + d / 2, -np.diff(pile.h) / d),
        lambda at: np.interp(at, x, pile.R),
    )


def test_silo_fills_at_the_closed_form_of_a_slope_driven_layer():
    """S = Sc (L - x)/(L - x + beta/gamma) to a hundredth at 0.95 L."""
    rule, at = replace(DRIVEN, D=0.0), np.array([0.5, 0.95]) * LENGTH
    left = LENGTH - at
    S = rule.Sc * left / (left + rule.beta / rule.gamma)
    R = 0.1 * (left + rule.beta / rule.gamma) / (rule.beta * rule.Sc)
    slope, layer = silo(rule, 0.05)
    assert slope(at) == pytest.approx(S, rel=1e-2)
    assert layer(at) == pytest.approx(R, rel=1e-2)


def test_silo_of_the_papers_rule_is_steeper_than_any_wall_can_hold():
    """S = Sc - v/(gamma (L - x)), which falls below 0 before the wall."""
    rule = Rule(v=1.0, D=0.0, gamma=0.5, Sc=0.5, d=0.1, dt=0.01)
    slope, layer = silo(rule, 0.1)
    at = np.array([2.0, 5.0])
    assert slope(at) == pytest.approx(0.5 - 2 / (LENGTH - at), rel=2e-2, abs=2e-3)
    assert layer(at) == pytest.approx(0.1 * (LENGTH - at), rel=2e-2)


def test_heap_in_the_middle_is_the_same_on_both_sides():
    start = Pile(np.zeros(40), np.zeros(40))
    source = Source(0.5, LENGTH / 2, 0.5)
    rule = replace(DRIVEN, d=0.25)
    (pile,) = frames(start, rule, [30.0], "wall", sources=[source])
    assert pile.h == pytest.approx(pile.h[::-1], rel=1e-9)
    assert pytest.approx(pile.R[::-1], rel=1e-9) == pile.R
    assert pile.h[18] > pile.h[5] + 0.5


@given(
    part=st.one_of(st.floats(0, 1), st.floats(0, 0.05)),
    Sc=st.floats(0.05, 1),
    beta=st.floats(0.1, 3),
    gamma=st.floats(0.05, 3),
    D=st.floats(0, 1),
    layer=st.floats(0.01, 20),
)
def test_bound_of_a_slope_driven_step_keeps_small_waves_small_and_layers_positive(
    part, Sc, beta, gamma, D, layer
):
    """Von Neumann: on an even slope S of no more than Sc no wave grows."""
    d, cells, S = 0.5, 12, part * Sc
    rule = Rule(v=0.0, D=D, gamma=gamma, Sc=Sc, d=d, dt=1.0, beta=beta)
    h = -S * d * np.arange(cells)
    dt = largest_stable_step(Pile(h, np.full(cells, layer)), rule, "open")
    theta = np.linspace(0, math.pi, 200)[:, None, None]
    down, up = 1 - np.exp(-1j * theta), 1 - np.exp(1j * theta)
    spread = D / d**2 * down * up
    of_R = [
        -beta * S / d * down - spread + gamma * (S - Sc),
        -beta * layer / d**2 * down * up + gamma * layer / d * up,
    ]
    of_h = [-gamma * (S - Sc) + 0 * theta, -gamma * layer / d * up]
    rates = np.concatenate([np.concatenate(of_R, axis=2), np.concatenate(of_h, axis=2)], axis=1)
    growth = np.abs(1 + dt * np.linalg.eigvals(rates)).max()
    assert growth <= 1 + 1e-7
    assert dt * (beta * S / d + 2 * D / d**2 + gamma * Sc) <= 1 + 1e-12


def test_step_that_cannot_be_stable_is_refused_with_the_largest_that_is():
    h, R = rough(5, DRIVEN)
    largest = largest_stable_step(Pile(h, R), DRIVEN, "wall")
    evolve(h, R, replace(DRIVEN, dt=largest), 1, "wall")
    with pytest.raises(
        UnstableStep, match=r"\(beta max\(S, 2\.5 Sc\) \+ gamma R\) dt/d"
    ) as refusal:
        evolve(h, R, replace(DRIVEN, dt=1.01 * largest), 1, "wall")
    assert refusal.value.largest == largest
    with pytest.raises(ValueError, match="depends on all slopes"):
        DRIVEN.max_stable_step(1.0)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"beta": -1.0}, "beta = -1.0"),
        ({"v": 0.1}, "v = 0.1: must be 0.0 where beta = 0.9"),
        ({"scheme": "limited"}, "scheme = 'limited': must be 'upwind' where beta"),
        ({"kappa": 0.1}, "kappa = 0.1: must be 0.0 where beta"),
        ({"order": "left"}, "order = 'left': must be 'synchronous' where beta"),
    ],
)
def test_slope_driven_rule_refuses_what_it_does_not_have(changes, message):
    with pytest.raises(ValueError, match=message):
        replace(DRIVEN, **changes)


def test_container_refuses_what_does_not_go_with_it():
    pile = Pile(np.zeros(20), np.zeros(20))
    limited = replace(UPWIND, Gamma=0.0, scheme="limited")
    with pytest.raises(ValueError, match="scheme = 'limited': must be 'synchronous' and 'upwind'"):
        next(frames(pile, limited, [1.0], "wall"))
    with pytest.raises(ValueError, match=r"source place = 0.1, width = 1.0: must lie on"):
        next(frames(pile, UPWIND, [1.0], sources=[Source(1.0, 0.1, 1.0)]))
    for name in ("rate", "width"):
        with pytest.raises(ValueError, match=f"source {name} = -1.0"):
            Source(**({"rate": 1.0, "place": 5.0, "width": 1.0} | {name: -1.0}))
    with pytest.raises(ValueError, match=r"beta = 0\.9: a frozen slope is defined for 0 only"):
        evolve(*rough(1, DRIVEN), DRIVEN, 1, frozen=np.zeros(20))
