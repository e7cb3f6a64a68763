import gc

import pytest

from bcre_studies.timing import clock


class FakeTime:
    """A clock that only the calls themselves move."""

    def __init__(self):
        self.now = 0.0
        self.order = []

    def perf_counter(self):
        return self.now

    def call(self, name, *durations):
        """A call that takes the given durations one after the other, then always the last one."""
        left = list(durations)

        def run():
            self.order.append(name)
            self.now += left.pop(0) if len(left) > 1 else left[0]

        return run


@pytest.fixture
def fake(monkeypatch):
    fake = FakeTime()
    monkeypatch.setattr(clock, "time", fake)
    return fake


def test_all_calls_take_turns_within_every_round(fake):
    calls = {name: fake.call(name, 1.0) for name in ("a", "b", "c")}
    table = clock.interleaved(calls, rounds=6)
    assert fake.order == ["a", "b", "c"] * (1 + 1 + 6)
    assert list(table["name"]) == ["a", "b", "c"]
    assert list(table["rounds"]) == [6, 6, 6]


def test_first_use_is_kept_apart_from_the_warm_median_smallest_and_largest(fake):
    calls = {"a": fake.call("a", 60.0, 5.0, 2.0, 9.0, 1.0, 3.0, 4.0), "b": fake.call("b", 0.5)}
    a, b = clock.interleaved(calls).to_dict("records")
    assert a["first_s"] == 60
    assert (a["smallest_s"], a["median_s"], a["largest_s"]) == (1, 3, 9)
    assert (b["first_s"], b["smallest_s"], b["median_s"], b["largest_s"]) == (0.5,) * 4


def test_short_calls_are_repeated_for_the_least_duration_within_a_round(fake):
    tick = 2.0**-17
    table = clock.interleaved({"short": fake.call("short", tick), "long": fake.call("long", 1.0)})
    short, long = table.to_dict("records")
    assert clock.LEAST_S <= short["repeats"] * tick < 2 * clock.LEAST_S
    assert long["repeats"] == 1
    assert short["median_s"] == tick


def test_call_slow_once_while_its_repeats_are_sought_is_still_repeated_enough(fake):
    tick = 2.0**-17
    call = fake.call("a", 0.01, tick)
    assert clock.repeats_needed(call) * tick >= clock.LEAST_S


def test_ratio_is_taken_within_rounds_so_that_a_slow_round_leaves_it_alone(fake):
    """Rounds 2 to 4 are ten, twenty and thirty times slower, and round 5 disturbs one call only."""
    a = fake.call("a", 1.0, 1.0, 4.0, 40.0, 80.0, 120.0, 12.0)
    b = fake.call("b", 1.0, 1.0, 2.0, 20.0, 40.0, 60.0, 2.0)
    timed = clock.take_turns({"a": a, "b": b})
    assert timed.ratio("a", "b") == (2.0, 2.0, 6.0)


def test_further_rounds_are_taken_until_the_budget_is_spent(fake):
    table = clock.interleaved({"a": fake.call("a", 1.0), "b": fake.call("b", 2.0)}, budget_s=30)
    assert list(table["rounds"]) == [10, 10]


def test_garbage_collector_is_off_during_the_calls_and_back_on_afterwards(fake):
    seen = []
    call = fake.call("a", 1.0)
    clock.interleaved({"a": lambda: (seen.append(gc.isenabled()), call())})
    assert seen
    assert not any(seen)
    assert gc.isenabled()


def test_garbage_collector_is_back_on_after_a_call_that_fails():
    def fail():
        raise ArithmeticError

    with pytest.raises(ArithmeticError):
        clock.interleaved({"a": fail})
    assert gc.isenabled()


def test_fewer_than_five_rounds_are_refused():
    with pytest.raises(ValueError, match=r"rounds = 4: must be at least 5"):
        clock.interleaved({"a": int}, rounds=4)
