from dataclasses import replace

import numpy as np
import pytest
from hypothesis import strategies as st

from bcre_ca import Pile, Rule, largest_stable_step

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
