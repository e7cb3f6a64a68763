"""What all tests share: the command in this process, and examples that repeat."""

import contextlib
import io
import sys
from typing import NamedTuple
from unittest import mock

import pytest
from hypothesis import HealthCheck, settings

from bcre_studies import cli

settings.register_profile(
    "repeatable",
    derandomize=True,
    deadline=None,
    max_examples=60,
    suppress_health_check=[HealthCheck.too_slow],  # as examples are on a busy machine
)
settings.load_profile("repeatable")


class Ended(NamedTuple):
    """How a command ended: its exit code and what it printed."""

    code: int
    out: str
    err: str

    @property
    def refusal(self):
        """The one line of a command that refuses its input."""
        assert self.code == 2, self
        assert self.out == ""
        (line,) = self.err.splitlines()
        return line.removeprefix("bcre: ")


def _run(*arguments):
    """``bcre`` with these arguments."""
    out, err = io.StringIO(), io.StringIO()
    argv = mock.patch.object(sys, "argv", ["bcre", *map(str, arguments)])
    with argv, contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            cli.main()
            code = 0
        except SystemExit as ended:
            code = ended.code
    return Ended(code, out.getvalue(), err.getvalue())


@pytest.fixture(scope="session")
def run_bcre():
    """The command, in this process and its folder."""
    return _run


@pytest.fixture
def bcre(monkeypatch, tmp_path):
    """The command, started in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return _run
