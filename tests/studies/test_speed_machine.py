import getpass
import platform
import socket
from pathlib import Path

import numpy as np
import pytest

from bcre_ca import Rule
from bcre_studies.performance.rivals import numpy_automaton
from bcre_studies.timing import machine


class Counted:
    """A number that counts how often numbers like it were added to or subtracted from."""

    additions = 0

    def __init__(self, value):
        self.value = value

    def _add(self, value):
        Counted.additions += 1
        return Counted(value)

    def __add__(self, other):
        return self._add(self.value + getattr(other, "value", other))

    def __sub__(self, other):
        return self._add(self.value - getattr(other, "value", other))

    def __rsub__(self, other):
        return self._add(other - self.value)

    def __mul__(self, other):
        return Counted(self.value * getattr(other, "value", other))

    __rmul__ = __mul__


def additions_in_a_step(cells):
    h = np.array([Counted(-0.5 * i) for i in range(cells)], dtype=object)
    R = np.array([Counted(1.0 + i) for i in range(cells)], dtype=object)
    Counted.additions = 0
    numpy_automaton.march(h, R, Rule(0.3, 0.1, 0.02, 0.5, 1.0, 0.4), 1)
    return Counted.additions


def test_step_of_the_rule_makes_seven_additions_for_every_further_cell():
    assert additions_in_a_step(25) - additions_in_a_step(15) == 10 * machine.ADDITIONS_A_CELL


def test_chain_makes_as_many_additions_as_it_is_said_to():
    start, end = np.arange(5.0), np.zeros(5)
    machine._add_up(start, end, 1.0, 1.0, 3)
    np.testing.assert_array_equal(end, start + machine.CHAIN)
    machine._add_up(start, end, 1.0, 0.0, 1)
    np.testing.assert_array_equal(end, start + machine.CHAIN / 2)


def test_additions_are_not_reordered():
    """1 + 1e-16 rounds to 1 every time; what is added, summed up beforehand, would not."""
    start, end = np.ones(8), np.zeros(8)
    machine._add_up(start, end, 1e-16, 1e-16, 1)
    assert 1 + machine.CHAIN * 1e-16 > 1
    np.testing.assert_array_equal(end, 1.0)


def test_load_counts_every_value_of_every_pass():
    load = machine.additions(passes=3)
    load.call()
    assert load.amount == machine.CHAIN * machine.VALUES * 3


def test_pass_reads_and_writes_both_layers_of_every_cell():
    h, R = np.zeros(1000), np.arange(1000.0)
    before = [hex(value.ctypes.data) for value in (h, R)]
    machine._pass_over(h, R, 0.5)
    np.testing.assert_array_equal(h, -0.5 * np.arange(1000))
    np.testing.assert_array_equal(R, 1.5 * np.arange(1000))
    assert [hex(value.ctypes.data) for value in (h, R)] == before
    assert machine.memory_pass(1000).amount == 1000 * (2 * 8 + 2 * 8)


def test_description_names_the_machine_but_not_whose_it_is():
    described = machine.description()
    assert described["Python"] == platform.python_version()
    assert described["numpy"] == np.__version__
    assert int(described["cores available"]) >= 1
    assert described["processor"]
    text = " ".join(described.values())
    assert "/" not in text.replace("/proc", "")
    for private in (socket.gethostname(), Path.home().as_posix()):
        assert private not in text
    assert getpass.getuser() not in text.split()


@pytest.mark.parametrize("lines", ["", "flags : fpu\n"])
def test_processor_without_a_model_name_still_has_one(monkeypatch, lines):
    read = Path.read_text  # of all other files as before: libraries read their versions by it

    def read_text(path, *how, **more):
        return lines if path == Path("/proc/cpuinfo") else read(path, *how, **more)

    monkeypatch.setattr(machine.Path, "read_text", read_text)
    assert machine.description()["processor"]
