import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bcre_ca import Rule, step
from bcre_ca.kernels import march

ORDERS = ("synchronous", "right", "left")


def plain_march(h, R, rule, steps, ends):
    lost = []
    for _ in range(steps):
        h, R, outflow = step(h, R, rule, ends)
        lost.append(outflow)
    return h, R, lost


@settings(max_examples=300)
@given(data=st.data(), steps=st.integers(0, 40))
def test_compiled_step_equals_plain_step_to_the_bit(cases, data, steps):
    h, R, rule, ends = data.draw(cases(part_of_bound=0.5))
    plain_h, plain_R, lost = plain_march(h, R, rule, steps, ends)
    outflow = march(h, R, rule, steps, ends)
    assert h.tobytes() == plain_h.tobytes()
    assert R.tobytes() == plain_R.tobytes()
    assert outflow == pytest.approx(math.fsum(lost), rel=1e-14)


@pytest.mark.parametrize("sign", ["consistent", "printed"])
@pytest.mark.parametrize("ends", ["open", "periodic"])
@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("cells", [1, 2, 3, 4, 5, 8, 17, 64, 1001])
def test_compiled_step_equals_plain_step_to_the_bit_at_every_size(cells, order, ends, sign):
    """Sizes round the width of a vector register, where a compiler's peeled loop would show."""
    rng = np.random.default_rng(cells)
    rule = Rule(0.3, 0.1, 0.02, 0.6, 0.7, 0.4, sign=sign, order=order)
    h = rng.uniform(-3, 3, cells) - 0.6 * 0.7 * np.arange(cells)
    R = rng.uniform(0, 5, cells)
    plain_h, plain_R, lost = plain_march(h, R, rule, 25, ends)
    outflow = march(h, R, rule, 25, ends)
    assert h.tobytes() == plain_h.tobytes()
    assert R.tobytes() == plain_R.tobytes()
    assert outflow == pytest.approx(math.fsum(lost), rel=1e-14)


@pytest.mark.parametrize("order", ORDERS)
def test_steps_in_one_call_equal_steps_one_by_one_to_the_bit(order):
    rng = np.random.default_rng(7)
    rule = Rule(0.3, 0.1, 0.02, 0.6, 0.7, 0.4, order=order)
    h, R = rng.uniform(-3, 3, 30), rng.uniform(0, 5, 30)
    other_h, other_R = h.copy(), R.copy()
    march(h, R, rule, 57, "open")
    for _ in range(57):
        march(other_h, other_R, rule, 1, "open")
    assert h.tobytes() == other_h.tobytes()
    assert R.tobytes() == other_R.tobytes()


@pytest.mark.parametrize("order", ORDERS)
def test_mass_is_conserved_to_rounding_over_many_steps_with_outflow(order):
    rng = np.random.default_rng(3)
    rule = Rule(0.5, 0.1, 0.02, 0.4, 1.0, 0.5, order=order)
    h, R = 0.6 * np.arange(200.0)[::-1], rng.uniform(0, 5, 200)
    before = math.fsum(h) + math.fsum(R)
    outflow = march(h, R, rule, 20_000, "open")
    assert outflow > 100
    assert abs(math.fsum(h) + math.fsum(R) + outflow - before) <= 1e-12 * before


def test_infinite_values_are_passed_on_rather_than_raised():
    h, R = np.array([1e308, -1e308, 0.0]), np.array([1e10, 1.0, 1.0])
    march(h, R, Rule(0.1, 0.1, 1.0, 0.5, 1.0, 1.0), 3, "open")
    assert not (np.isfinite(h).all() and np.isfinite(R).all())
