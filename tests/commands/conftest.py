"""The command in this process, in a folder of its own."""

import contextlib
import io
import sys
from pathlib import Path
from typing import NamedTuple
from unittest import mock

import pytest

from bcre_studies import cli

TABLE = "x,h\n" + "".join(f"{x},{0.49 * (10 - x)}\n" for x in range(11))

SCENE = """
title = "A pulse on a table"
[material]
v = 0.5
D = 0.2
gamma = 0.05
Sc = 0.5
[domain]
length = 10.0
cells = 20
ends = "open"
[time]
until = 1.0
[[surface]]
kind = "table"
file = "ground.csv"
[[rolling]]
kind = "gaussian"
amplitude = 0.1
centre = 3.0
width = 1.0
"""


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


def run_bcre(*arguments):
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


@pytest.fixture
def bcre(monkeypatch, tmp_path):
    """The command, started in an empty folder."""
    monkeypatch.chdir(tmp_path)
    return run_bcre


@pytest.fixture
def scene():
    """Writes a scene with a table into a folder; returns the path of its file."""

    def write(folder=".", text=SCENE, table=TABLE, name="scene.toml", table_name="ground.csv"):
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        (folder / table_name).write_text(table, encoding="utf-8")
        path = folder / name
        path.write_text(text.replace("ground.csv", table_name), encoding="utf-8")
        return path

    return write
