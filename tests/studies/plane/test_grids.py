"""Terrains from files: ESRI ASCII grids and NumPy arrays."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bcre_studies.scenes.plane.scene import load
from bcre_studies.scenes.refusal import SceneError

SCENE = """
title = "A terrain"
[material]
v = 0.5
D = 0.1
gamma = 0.05
Sc = 0.5
[domain]
{domain}
[time]
until = 2.0
[[surface]]
kind = "table"
file = "{file}"
"""
SIX = "cells = 6\ncells_across = 5\nlength = 15.0\nwidth = 12.5"
HEIGHTS = np.round(np.random.default_rng(0).uniform(0, 9, (5, 4)), 3)


def ascii_grid(rows=HEIGHTS, head="", **changes):
    values = {"ncols": 4, "nrows": 5, "xllcorner": 1.5, "yllcorner": -2, "cellsize": 2.5}
    lines = [f"{name} {value}" for name, value in (values | changes).items()]
    return "\n".join([*lines, head] + [" ".join(map(str, row)) for row in rows]) + "\n"


def scene(folder, file, content=None, domain=""):
    if isinstance(content, str):
        (folder / file).write_text(content)
    elif content is not None:
        np.save(folder / file, content)
    (folder / "scene.toml").write_text(SCENE.format(file=file, domain=domain))
    return load(folder / "scene.toml")


@given(rows=st.integers(2, 9), columns=st.integers(2, 9), seed=st.integers(0, 99))
def test_grid_gives_the_plane_its_heights_and_its_size(tmp_path_factory, rows, columns, seed):
    heights = np.random.default_rng(seed).uniform(-9, 9, (rows, columns))
    text = ascii_grid(heights, nrows=rows, ncols=columns)
    read = scene(tmp_path_factory.mktemp("grid"), "a.asc", text)
    assert read.domain.shape == (rows, columns)
    assert (read.domain.length, read.domain.width) == (2.5 * rows, 2.5 * columns)
    assert np.array_equal(read.initial()[0], heights)


def test_array_gives_its_cells_and_the_file_the_length(tmp_path):
    read = scene(tmp_path, "a.npy", HEIGHTS.astype("f4"), "length = 10.0")
    assert (read.domain.d, read.domain.width) == (2.0, 8.0)
    assert read.initial()[0] == pytest.approx(HEIGHTS, rel=1e-6)


def test_head_may_be_in_capitals_with_blank_lines_and_a_centre(tmp_path):
    text = ascii_grid().replace("xllcorner", "XLLCENTER").replace("ncols", "\n\nNCOLS")
    assert np.array_equal(scene(tmp_path, "a.ASC", text).initial()[0], HEIGHTS)


def test_path_starts_at_the_scene_or_else_in_the_current_folder(tmp_path, monkeypatch):
    here = tmp_path / "here"
    here.mkdir()
    (here / "mine.asc").write_text(ascii_grid())
    monkeypatch.chdir(here)
    assert load("terrain", ["surface.0.file=mine.asc"]).domain.shape == (5, 4)


def with_cell(value):
    """The heights with this one in row 3, column 2."""
    changed = HEIGHTS.copy()
    changed[2, 1] = value
    return changed


def without_last(rows):
    return [*rows[:-1], rows[-1][:-1]]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (ascii_grid(without_last(HEIGHTS.tolist())), "row 5 has 3 numbers: must have ncols = 4"),
        (ascii_grid(HEIGHTS[:4]), "has 4 rows: must have nrows = 5"),
        (ascii_grid([*HEIGHTS, HEIGHTS[0]]), "has more rows than nrows = 5"),
        (
            ascii_grid(with_cell(-9999), "NODATA_value -9999"),
            "NODATA, -9999, in row 3, column 2: every cell must have a height",
        ),
        (ascii_grid(HEIGHTS[:1], nrows=1), "is a grid of 1 x 4: must have at least 2 x 2 cells"),
        (ascii_grid(HEIGHTS[:, :1], ncols=1), "is a grid of 5 x 1: must have at least 2 x 2 cells"),
        (
            ascii_grid(nrows=100_000, ncols=10_000),
            r"is a grid of 100000 x 10000: must have at most 1e\+08 cells in all",
        ),
        (ascii_grid(nrows=5.5), "nrows = 5.5, ncols = 4: must be whole"),
        (ascii_grid(cellsize=0), "cellsize = 0: must be > 0"),
        (ascii_grid(cellsize="wide"), "'cellsize wide': must be a name and a number"),
        (ascii_grid(with_cell(np.nan)), "nan in row 3, column 2"),
        (ascii_grid(with_cell(1e300)), "1e.300 in row 3, colum"),
        (ascii_grid([["a", 1, 2, 3]] * 5), "row 1: must be numbers"),
        ("1 2 3\n4 5 6\n", "has no ncols in its head"),
        ("", "has no ncols in its head"),
        (ascii_grid() + " " * 20_000, "bytes: must have at most 40 a cell"),
    ],
)
def test_bad_grid_is_refused_with_what_is_wrong_with_it(tmp_path, content, message):
    with pytest.raises(SceneError, match=rf"^surface.0.file = 'a.asc': .*{message}") as refused:
        scene(tmp_path, "a.asc", content)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (HEIGHTS[0], r"has the shape \(4,\): must be rows x columns"),
        (HEIGHTS[:1], "is a grid of 1 x 4: must have at least 2 x 2 cells"),
        (HEIGHTS.astype(complex), "must be an array of numbers"),
        (HEIGHTS.astype(object), "must be an array of numbers"),
        (with_cell(np.inf), "inf in row 3, column 2"),
        ("no array", "must be an array of numbers"),
    ],
)
def test_bad_array_is_refused_with_what_is_wrong_with_it(tmp_path, content, message):
    with pytest.raises(SceneError, match=rf"^surface.0.file = 'a.npy': .*{message}"):
        scene(tmp_path, "a.npy", content, "length = 10.0")


def test_array_of_a_thousand_million_cells_is_refused_by_its_head_alone(tmp_path):
    with (tmp_path / "a.npy").open("wb") as file:
        head = {"descr": "<f8", "fortran_order": False, "shape": (100_000, 10_000)}
        np.lib.format.write_array_header_1_0(file, head)
        file.truncate(file.tell() + 8 * 10**9)
    with pytest.raises(SceneError, match=r"is a grid of 100000 x 10000: must have at most 1e\+08"):
        scene(tmp_path, "a.npy", None, "length = 10.0")


@pytest.mark.parametrize(
    ("file", "domain", "message"),
    [
        ("a.tif", "", r"must be an ESRI ASCII grid \(.asc\) or a NumPy array \(.npy\)"),
        ("b.asc", "", "no such file, beside the scene file or in the current folder"),
        ("a.asc", SIX, "must be of domain.cells x domain.cells_across = 6 x 5"),
        ("a.asc", "length = 10.0\nwidth = 8.0", "cellsize = 2.5: must be domain.length"),
    ],
)
def test_file_that_does_not_fit_the_scene_is_refused(tmp_path, file, domain, message):
    (tmp_path / "a.asc").write_text(ascii_grid())
    with pytest.raises(SceneError, match=f"^surface.0.file = '{file}': .*{message}"):
        scene(tmp_path, file, None, domain)
