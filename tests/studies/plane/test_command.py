"""``bcre run`` for a scene on a plane: its files, and that nothing is written for a bad one."""

import json
import re
import sys

import numpy as np
import pytest
import xarray as xr

from bcre_ca.plane import Sand, frames
from bcre_studies import cli
from bcre_studies.models.plane import automaton
from bcre_studies.models.plane.automaton import plane_of
from bcre_studies.on_plane import said
from bcre_studies.scenes.plane.scene import load
from bcre_studies.system.files import ROOT

SCENE = """
title = "A pulse on a layer"
[material]
v = 0.5
D = 0.1
gamma = 0.05
Sc = 0.5
[domain]
length = 12.0
cells = 24
width = 8.0
[time]
until = 20.0
[units]
length = "mm"
[base]
thickness = 0.2
[[surface]]
kind = "incline"
slope = 1.5
[[rolling]]
kind = "gaussian"
amplitude = 0.5
centre = [3.0, 4.0]
width = 1.0
"""
HEAP = """
title = "A heap beside a wall"
[material]
v = 1.0
D = 0.1
gamma = 0.5
Sc = 0.5
[domain]
length = 12.0
cells = 24
width = 8.0
ends = "closed"
[time]
until = 5.0
[automaton]
flow = "facet8"
[[source]]
rate = 1.0
place = [6.0, 4.0]
width = 2.0
until = 4.0
[[wall]]
kind = "disc"
centre = [2.0, 4.0]
width = 1.0
"""


@pytest.fixture
def bcre(tmp_path, monkeypatch, capsys):
    """``bcre run`` of a scene with options; the exit code and what it printed on standard error."""
    monkeypatch.chdir(tmp_path)

    def call(scene, *options):
        (tmp_path / "scene.toml").write_text(scene)
        monkeypatch.setattr(sys, "argv", ["bcre", "run", "scene.toml", *options, "--out", "out"])
        try:
            cli.main()
        except SystemExit as ended:
            return ended.code, capsys.readouterr().err
        return 0, capsys.readouterr().err

    return call


def test_frames_of_both_models_are_one_netcdf_with_names_and_units(bcre, tmp_path):
    assert bcre(SCENE, "--model", "both", "--frames", "3", "--animate") == (0, "")
    written = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert written == ["animation.gif", "frames.nc", "picture.png", "summary.json"]
    with xr.open_dataset(tmp_path / "out" / "frames.nc") as found:
        assert dict(found.sizes) == {"t": 3, "y": 16, "x": 24}
        for name in ("h", "R", "h_pde", "R_pde"):
            assert found[name].dims == ("t", "y", "x")
            assert found[name].units == "mm"
        assert "automaton" in found.h.long_name
        assert (found.t.units, found.x.long_name, found.y.long_name) == ("s", "downhill", "across")
        assert found.t.values.tolist() == [0, 10, 20]
        assert found.x.values == pytest.approx((np.arange(24) + 0.5) / 2)
        difference = np.abs(found.R - found.R_pde).sum("x").sum("y") / found.R.sum("x").sum("y")
        assert difference[0] == 0
        assert 0.001 < difference[1:].max() < 0.5
    for path, head in (("picture.png", b"\x89PNG"), ("animation.gif", b"GIF89a")):
        assert (tmp_path / "out" / path).read_bytes().startswith(head)


def test_frames_are_those_of_the_automaton_to_the_bit(bcre, tmp_path):
    assert bcre(HEAP, "--frames", "3") == (0, "")
    scene = load(tmp_path / "scene.toml")
    h, R = scene.initial()
    expected = list(frames(Sand(h, R), plane_of(scene, h), [0.0, 2.5, 5.0]))
    with xr.open_dataset(tmp_path / "out" / "frames.nc") as found:
        assert set(found.data_vars) == {"h", "R", "wall"}
        for index, sand in enumerate(expected):
            assert np.array_equal(found.h[index].T, sand.h)
            assert np.array_equal(found.R[index].T, sand.R)
        assert np.array_equal(found.wall.T, scene.walls())


def test_terrain_of_a_user_runs_from_the_line_of_the_readme(tmp_path, monkeypatch, capsys):
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    (line,) = re.findall(r"^\.venv/bin/(bcre .*my_terrain\.asc)", readme, flags=re.MULTILINE)
    x, y = np.meshgrid(np.arange(200.0), np.arange(300.0), indexing="ij")
    heights = 60 - 0.3 * x + 5 * np.sin(x / 9) * np.cos(y / 14)
    head = "ncols 300\nnrows 200\nxllcorner 0\nyllcorner 0\ncellsize 2\nNODATA_value -9999"
    np.savetxt(tmp_path / "my_terrain.asc", heights, "%.3f", header=head, comments="")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", line.split())
    cli.main()
    assert "volume eroded (m^3)" in capsys.readouterr().out
    with xr.open_dataset(tmp_path / "out" / "terrain" / "frames.nc") as found:
        assert dict(found.sizes) == {"t": 11, "y": 300, "x": 200}
        assert found.h[0].T.values == pytest.approx(heights, abs=1e-3)
        assert found.x[-1] == 399.0


def test_what_is_printed_accounts_for_the_sand(tmp_path):
    # Sand at the start, poured and eroded is what is left, laid down or out.
    path = tmp_path / "heap.toml"
    path.write_text(HEAP, encoding="utf-8")
    scene = load(path)
    run = automaton.run(scene, [0.0, scene.time.until])
    volume = {number["quantity"]: number["ca"] for number in said.record([run])}
    came = sum(volume[f"volume {name}"] for name in ("of R at the start", "poured", "eroded"))
    went = ("of R left at the end", "laid down", "out through the foot")
    assert came == pytest.approx(sum(volume[f"volume {name}"] for name in went), rel=1e-12)
    assert volume["volume poured"] == pytest.approx(4.0, rel=1e-12)
    assert volume["volume laid down"] > 0.1


def test_summary_accounts_for_the_mass(bcre, tmp_path):
    assert bcre(HEAP, "--frames", "3")[0] == 0
    (numbers,) = json.loads((tmp_path / "out" / "summary.json").read_text()).values()
    assert numbers["cells"] == [24, 16]
    assert numbers["inflow"] == pytest.approx(4.0, rel=1e-12)
    assert numbers["mass_final"] == pytest.approx(4.0, rel=1e-12)
    assert numbers["mass_error"] < 1e-12
    assert numbers["R_min"] >= 0
    assert numbers["R_max"] > 0.1


@pytest.mark.parametrize(
    ("scene", "options", "message"),
    [
        (HEAP, ["--model", "pde"], "automaton.flow = 'facet8': must be 'tilted' for --model pde"),
        (
            SCENE,
            ["--model", "height alone"],
            "--model = 'height alone': must be 'ca', 'pde' or 'both'",
        ),
        (SCENE, ["--set", "step=9.0"], "time.step = 9.0: "),
        (HEAP, ["--set", "source.0.place=[50.0, 4.0]"], "sources[0]: no cell that can hold sand"),
        (SCENE, ["--set", "cells_across=90000000"], "domain.width = 8.0: must be that of"),
        (SCENE, ["--set", "until=1e300"], "time.until = 1e+300: would take"),
        (SCENE, ["--set", "surface.0.slope=1e308"], "numbers of this scene are too large"),
        (SCENE, ["--set", "cells=90000"], "must be at most 1e+08 cells in all"),
        (SCENE, ["--frames", "9000", "--set", "cells=2400"], "with --frames = 9000: would take"),
    ],
)
def test_bad_scene_ends_in_one_line_with_exit_2_and_nothing_written(
    bcre, tmp_path, scene, options, message
):
    code, err = bcre(scene, *options)
    assert code == 2
    assert err.count("\n") == 1
    assert message in err
    assert not (tmp_path / "out").exists()
