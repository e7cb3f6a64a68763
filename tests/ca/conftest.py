import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import strategies as st

from bcre_ca import Pile, Rule, advance, step

ALL = ("no D", "kappa", "v_up", "dry")


class Form(NamedTuple):
    """What decides which machine code runs: the scheme, the terms present, the ends."""

    scheme: str
    terms: tuple[str, ...]
    ends: str

    def __str__(self):
        return "-".join([self.scheme, *self.terms, self.ends])

    @property
    def synchronous(self):
        return self.scheme != "in place"

    def options(self, kappa=0.02, v_up=1.5, dry=1e-3, order="right"):
        """The parameters that give a rule this form. Of D only that it is absent."""
        values = {"kappa": kappa, "v_up": v_up, "dry": dry, "no D": 0.0}
        chosen = {{"no D": "D"}.get(term, term): values[term] for term in self.terms}
        return chosen | ({"scheme": self.scheme} if self.synchronous else {"order": order})


# Each term meets each scheme and both kinds of ends; a form takes two seconds or more to compile.
FORMS = (
    Form("upwind", (), "open"),
    Form("upwind", (), "periodic"),
    Form("upwind", ALL, "open"),
    Form("calibrated", ("kappa", "v_up", "dry"), "open"),
    Form("calibrated", ("no D", "dry"), "periodic"),
    Form("limited", ALL, "open"),
    Form("limited", ("kappa", "v_up"), "periodic"),
    Form("in place", ("no D",), "open"),
    Form("in place", ("dry",), "periodic"),
)


def pytest_generate_tests(metafunc):
    """``form`` stands for all forms, ``synchronous``, ``open_form``, ``freezable`` for some.

    The scope lets pytest run the tests of a form after each other, so that one worker compiles it.
    """
    chosen = {
        "form": FORMS,
        "synchronous": [form for form in FORMS if form.synchronous],
        "open_form": [form for form in FORMS if form.ends == "open"],
        "freezable": [FORMS[1], FORMS[2]],
    }
    for name in chosen.keys() & set(metafunc.fixturenames):
        metafunc.parametrize(name, chosen[name], ids=str, scope="session")


@st.composite
def _rules(draw, form):
    coefficient = st.one_of(st.just(0.0), st.floats(1e-3, 3))
    options = form.options(
        kappa=draw(st.floats(1e-3, 1)),
        v_up=draw(st.floats(1e-2, 10)),
        dry=10 ** draw(st.floats(-12, -1)),
        order=draw(st.sampled_from(["right", "left"])),
    )
    return Rule(
        v=draw(coefficient),
        gamma=draw(st.one_of(st.just(0.0), st.floats(1e-3, 1))),
        Sc=draw(st.floats(0, 2)),
        d=draw(st.floats(0.1, 3)),
        dt=1.0,
        sign=draw(st.sampled_from(["consistent", "printed"])),
        **({"D": draw(st.floats(1e-3, 3))} | options),
    )


@st.composite
def _piles(draw, cells, rule):
    """Spiky layers about the repose line; wet in one stretch, which may pass the ends."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    rough = 10 ** draw(st.floats(-2, 1.5))
    h = rough * rng.normal(size=cells) - rule.Sc * rule.d * np.arange(cells)
    R = np.where(rng.random(cells) < 0.3, 0.0, 10 ** rng.uniform(-6, 1, cells))
    wet = draw(st.integers(0, cells))
    R[wet:] = 0.0
    return h, np.roll(R, draw(st.integers(0, cells - 1)))


def _bound(h, R, rule, ends):
    """:meth:`Rule.max_stable_step` of these layers, by NumPy."""
    drop = h[:-1] - h[1:]
    if ends == "periodic":
        drop = np.append(drop, h[-1] - (h[0] - rule.Sc * rule.d * h.size))
        bend = np.roll(drop, 1) - drop
    else:
        bend = np.diff(-drop, append=-rule.exchange_slope() * rule.d)[: drop.size]
    return rule.max_stable_step(
        R.max(),
        drop.min() / rule.d if drop.size else None,
        max(bend.max(initial=0.0), 0.0) / rule.d**2,
    )


def _gentle(rule, h, R, ends):
    """The rule with a dt in which no layer grows by more than a third a step."""
    d, drops = rule.d, np.abs(np.diff(h, append=h[0])) + abs(rule.Sc) * rule.d * h.size
    growth = rule.gamma * drops.max() / d + 2 * rule.kappa * drops.max() / d**2
    largest = _bound(h, R, rule, ends)
    return replace(rule, dt=min(0.5 * largest, 0.3 / growth if growth > 0 else 10.0, 10.0))


def _plain_march(h, R, rule, steps, ends, frozen=None):
    lost = []
    for _ in range(steps):
        h, R, outflow = step(h, R, rule, ends, frozen)
        lost.append(outflow)
    return h, R, math.fsum(lost)


def _moments_of_one_grain(rule, steps=60, cells=401):
    """Mean displacement and half the variance of R per unit time, R released in one inner cell."""
    h, R = np.zeros(cells), np.zeros(cells)
    R[150] = 1.0
    _, R, _ = _plain_march(h, R, rule, steps, "open")
    distance, time = rule.d * (np.arange(cells) - 150), steps * rule.dt
    mean = float(distance @ R)
    return mean / time, (float(distance**2 @ R) - mean**2) / (2 * time)


def _growth_at_a_fixed_cell(rule, excess):
    """From ln R = a + rate t - ln(t)/2 + c/t at three times; R of 1e-250 leaves the surface."""
    h = -(rule.Sc + excess) * rule.d * np.arange(900)
    R = np.zeros(900)
    R[600] = 1e-250
    pile, times, logs = Pile(h, R), [], []
    for steps in (600, 300, 300):
        pile = advance(pile, rule, steps)
        times.append(pile.t)
        logs.append(math.log(pile.R[600]) + math.log(pile.t) / 2)
    assert (pile.h == h)[:601].all()
    return np.linalg.solve(np.array([[1.0, t, 1 / t] for t in times]), logs)[1]


def _figure_1():
    x = np.arange(100) + 0.5
    return Pile(3.7 * (100 - x), np.exp(-(((x - 85) / 3) ** 2)))


@pytest.fixture(scope="session")
def forms():
    """All of them, see above."""
    return FORMS


@pytest.fixture(scope="session")
def rules():
    """Strategy for the rules of a form; their dt is 1 and still to be chosen."""
    return _rules


@pytest.fixture(scope="session")
def piles():
    """Strategy for the layers of so many cells under a rule."""
    return _piles


@pytest.fixture(scope="session")
def bound():
    """The largest stable step of (h, R, rule, ends), found without compiled code."""
    return _bound


@pytest.fixture(scope="session")
def gentle():
    """(rule, h, R, ends) -> the rule with a short step."""
    return _gentle


@pytest.fixture(scope="session")
def plain_march():
    """(h, R, rule, steps, ends) -> h, R and the sum of what left, by the plain step."""
    return _plain_march


@pytest.fixture(scope="session")
def moments_of_one_grain():
    """rule -> drift and diffusion of R on a level, frozen slope."""
    return _moments_of_one_grain


@pytest.fixture(scope="session")
def growth_at_a_fixed_cell():
    """(rule, excess) -> growth rate of R where it was released, on a frozen slope Sc + excess."""
    return _growth_at_a_fixed_cell


@pytest.fixture
def figure_1():
    """The start of the paper's figure 1: a pulse at the foot of a steep slope."""
    return _figure_1()
