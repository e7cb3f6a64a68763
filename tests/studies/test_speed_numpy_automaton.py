import tracemalloc

import numpy as np
import pytest

from bcre_ca import Rule, step
from bcre_pde import Material, Problem
from bcre_studies.performance.rivals import numpy_automaton


@pytest.mark.parametrize("sign", ["consistent", "printed"])
@pytest.mark.parametrize("ends", ["open", "periodic"])
@pytest.mark.parametrize("cells", [1, 2, 3, 8, 17, 257])
def test_preallocated_automaton_equals_the_step_to_the_bit(cells, ends, sign):
    rng = np.random.default_rng(cells)
    rule = Rule(0.3, 0.1, 0.02, 0.6, 0.7, 0.4, sign=sign)
    h = rng.uniform(-3, 3, cells) - 0.6 * 0.7 * np.arange(cells)
    R = rng.uniform(0, 5, cells) * (rng.random(cells) > 0.3)
    plain_h, plain_R = h.copy(), R.copy()
    for _ in range(25):
        plain_h, plain_R, _ = step(plain_h, plain_R, rule, ends)
    numpy_automaton.march(h, R, rule, 25, ends)
    assert h.tobytes() == plain_h.tobytes()
    assert R.tobytes() == plain_R.tobytes()


def test_no_array_is_made_in_a_step(monkeypatch):
    """As many buffers for a thousand steps as for one."""
    made = []
    zeros_like = np.zeros_like
    monkeypatch.setattr(np, "zeros_like", lambda a: made.append(a) or zeros_like(a))
    rule = Rule(0.3, 0.1, 0.02, 0.6, 0.7, 0.4)
    h, R = -0.6 * 0.7 * np.arange(50_000), np.ones(50_000)
    tracemalloc.start()
    numpy_automaton.march(h, R, rule, 1, "periodic")
    one = tracemalloc.get_traced_memory()[1]
    tracemalloc.reset_peak()
    numpy_automaton.march(h, R, rule, 20, "periodic")
    twenty = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len(made) == 2 * 3
    assert 3 * h.nbytes <= one < 3.5 * h.nbytes
    assert twenty < 3.5 * h.nbytes


def test_prepared_automaton_starts_afresh_at_every_call():
    problem = Problem(
        lambda x: (0.4 * (20 - x), np.exp(-(((x - 5) / 2) ** 2))), Material(1, 0.1, 0.05, 0.5), 20
    )
    solve = numpy_automaton.prepare(problem, until=4.0, cells=40, dt=0.2)
    first, second = solve(), solve()
    assert first.steps == 20
    assert first.R.tobytes() == second.R.tobytes()
    assert np.argmax(first.R) > np.argmax(problem.initial(first.x)[1])


@pytest.mark.parametrize(
    ("material", "dt", "message"),
    [
        (Material(1, 0.1, 0.05, 0.5, kappa=0.1), 0.2, r"kappa = 0.1: must be 0"),
        (Material(1, 0.1, 0.05, 0.5), 0.3, r"dt = 0.3: must divide until = 4.0"),
    ],
)
def test_what_the_rule_cannot_do_is_refused(material, dt, message):
    problem = Problem(lambda x: (0 * x, 0 * x), material, 20)
    with pytest.raises(ValueError, match=message):
        numpy_automaton.prepare(problem, until=4.0, cells=40, dt=dt)


def test_saturated_law_is_refused():
    problem = Problem(lambda x: (0 * x, 0 * x), Material(1, 0.1, 0.05, 0.5, v_up=1.0), 20)
    with pytest.raises(ValueError, match=r"v_up = 1.0: must be infinite"):
        numpy_automaton.prepare(problem, until=4.0, cells=40, dt=0.2)()


def test_in_place_orders_are_refused():
    with pytest.raises(ValueError, match=r"order='left'.*: must be the paper's synchronous rule"):
        numpy_automaton.march(np.ones(3), np.ones(3), Rule(1, 0, 0, 0, 1, 1, order="left"), 1)
