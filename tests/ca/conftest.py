import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import strategies as st

from bcre_ca import Pile, Rule, largest_stable_step, step

ORDERS = ("synchronous", "right", "left")


@st.composite
def _layers(draw, cells):
    surface = st.floats(-50, 50, allow_subnormal=False)
    rolling = st.one_of(st.just(0.0), st.floats(1e-200, 20))
    h = draw(st.lists(surface, min_size=cells, max_size=cells))
    R = draw(st.lists(rolling, min_size=cells, max_size=cells))
    return np.array(h), np.array(R)


@st.composite
def _cases(draw, orders=ORDERS, signs=("consistent", "printed"), part_of_bound=0.99, most=40):
    """Layers, ends, and a rule whose dt is a part of the largest stable one."""
    h, R = draw(_layers(draw(st.integers(1, most))))
    ends = draw(st.sampled_from(["open", "periodic"]))
    coefficient = st.one_of(st.just(0.0), st.floats(1e-3, 3))
    rule = Rule(
        v=draw(coefficient),
        D=draw(coefficient),
        gamma=draw(st.one_of(st.just(0.0), st.floats(1e-3, 1))),
        Sc=draw(st.floats(0, 2)),
        d=draw(st.floats(0.1, 3)),
        dt=1.0,
        sign=draw(st.sampled_from(signs)),
        order=draw(st.sampled_from(orders)),
    )
    largest = min(largest_stable_step(Pile(h, R), rule, ends), 10.0)
    return h, R, replace(rule, dt=part_of_bound * largest), ends


@pytest.fixture(scope="session")
def cases():
    """Strategy for (h, R, rule, ends), see :func:`_cases`."""
    return _cases


class Form(NamedTuple):
    """What decides which kernel is compiled: scheme or order, the terms present, the ends."""

    scheme: str
    terms: tuple[str, ...]
    ends: str

    def __str__(self):
        return "-".join([self.scheme, *self.terms, self.ends])

    @property
    def in_place(self):
        return self.scheme in ("right", "left")

    def options(self, kappa, v_up, dry):
        """The parameters of a rule of this form that decide on its kernel, D only where it is 0."""
        values = {"kappa": kappa, "v_up": v_up, "dry": dry, "no D": 0.0}
        chosen = {{"no D": "D"}.get(term, term): values[term] for term in self.terms}
        return chosen | ({"order": self.scheme} if self.in_place else {"scheme": self.scheme})


# Each term meets each scheme and each kind of ends; a form takes a second or two to compile.
FORMS = (
    Form("upwind", (), "open"),
    Form("upwind", (), "periodic"),
    Form("upwind", ("no D", "kappa", "dry"), "open"),
    Form("upwind", ("v_up", "dry"), "periodic"),
    Form("calibrated", (), "open"),
    Form("calibrated", ("no D", "kappa", "v_up", "dry"), "periodic"),
    Form("limited", ("no D", "kappa", "v_up", "dry"), "open"),
    Form("limited", ("kappa",), "periodic"),
    Form("right", ("dry",), "periodic"),
    Form("left", ("no D", "dry"), "open"),
)


def pytest_generate_tests(metafunc):
    """A test that takes ``form`` runs for all forms, one that takes ``synchronous`` for its own."""
    if "form" in metafunc.fixturenames:
        metafunc.parametrize("form", FORMS, ids=str)
    if "synchronous" in metafunc.fixturenames:
        chosen = [form for form in FORMS if not form.in_place]
        metafunc.parametrize("synchronous", chosen, ids=str)


@pytest.fixture(scope="session")
def forms():
    """All of them: printed ones, then those of the calibrated, the limited, the in-place rules."""
    return FORMS


@st.composite
def _rules(draw, form):
    coefficient = st.one_of(st.just(0.0), st.floats(1e-3, 3))
    options = form.options(
        kappa=draw(st.floats(1e-3, 1)),
        v_up=draw(st.floats(1e-2, 10)),
        dry=10 ** draw(st.floats(-12, -1)),
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


@pytest.fixture(scope="session")
def rules():
    """Strategy for the rules of a form; their dt is 1 and still to be chosen."""
    return _rules


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


@pytest.fixture(scope="session")
def piles():
    """Strategy for the layers of so many cells under a rule."""
    return _piles


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


@pytest.fixture(scope="session")
def bound():
    """The largest stable step of (h, R, rule, ends), found without any compiled code."""
    return _bound


def _plain_march(h, R, rule, steps, ends):
    lost = []
    for _ in range(steps):
        h, R, outflow = step(h, R, rule, ends)
        lost.append(outflow)
    return h, R, math.fsum(lost)


@pytest.fixture(scope="session")
def plain_march():
    """(h, R, rule, steps, ends) -> h, R and the sum of what left, by the plain step."""
    return _plain_march
