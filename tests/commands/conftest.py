"""A scene with a table, for the command to run."""

from pathlib import Path

import pytest

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
