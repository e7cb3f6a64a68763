"""The command ``bcre`` as others script against it: files, keys, exit codes, refusals."""

import json
import re
import subprocess
import sys
import tempfile
from importlib.metadata import entry_points
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bcre_studies import catalog
from bcre_studies.models.automaton import rule_of
from bcre_studies.running import run as run_module
from bcre_studies.scenes.listing import built_in_names, built_in_title, line_and_plane_names
from bcre_studies.scenes.scene import SECTIONS, load

SCENE = """
title = "A pulse"
[material]
v = 0.6
D = 0.2
gamma = 0.05
Sc = 0.4
[domain]
length = 20.0
cells = 40
ends = "open"
[time]
until = 3.0
[[surface]]
kind = "table"
file = "start.csv"
[[rolling]]
kind = "table"
file = "start.csv"
"""
BOTH = {
    "cells",
    "steps",
    "wall_s",
    "compile_s",
    "mass_initial",
    "mass_final",
    "outflow",
    "mass_error",
    "R_min",
    "R_max",
    "scene",
    "title",
    "changes",
    "version",
    "seed",
}
PDE_ERRORS = {
    "error_estimate",
    "error_estimate_h",
    "error_estimate_time",
    "observed_order",
    "observed_order_h",
}
SHORT = ("--set", "until=2", "--frames", "3")


NAMES = {"ca": "automaton", "pde": "PDE"}


def files(folder="."):
    return sorted(str(path) for path in Path(folder).rglob("*"))


def results(folder="o"):
    summary = json.loads(
        (Path(folder) / "summary.json").read_text(encoding="utf-8"),
        parse_constant=lambda word: pytest.fail(f"{word} is no JSON"),
    )
    return pd.read_csv(Path(folder) / "profiles.csv"), summary


def write_scene(text=SCENE, **columns):
    x = (np.arange(40) + 0.5) / 2
    table = {"x": x, "h": 0.7 * (20 - x), "R": np.exp(-(((x - 8) / 2) ** 2))} | columns
    pd.DataFrame(table).to_csv("start.csv", index=False)
    Path("scene.toml").write_text(text, encoding="utf-8")
    return "scene.toml"


def refused(ended, *words):
    assert ended.code == 2
    assert ended.out == ""
    assert ended.err.startswith("bcre: ")
    assert ended.err.endswith("\n")
    assert len(ended.err.splitlines()) == 1
    for word in words:
        assert word in ended.err
    return ended.err


# What a run writes


@pytest.mark.parametrize("frames", [2, 5, 11])
def test_profiles_have_the_five_columns_and_so_many_frames_from_zero_to_the_end(bcre, frames):
    assert bcre("run", "figure2", "--set", "until=3", "--frames", frames, "--out", "o").code == 0
    table, summary = results()
    header = Path("o/profiles.csv").read_text(encoding="utf-8").splitlines()[0]
    assert header == "model,t,x,h,R"
    assert list(dict.fromkeys(table["model"])) == ["ca", "pde"]
    for model, rows in table.groupby("model"):
        cells = summary[model]["cells"]
        assert rows["t"].unique() == pytest.approx(np.linspace(0, 3, frames), abs=1e-12)
        assert rows["t"].min() == 0.0
        assert rows["t"].max() == 3.0
        assert len(rows) == frames * cells
        for _, frame in rows.groupby("t"):
            centres = (np.arange(cells) + 0.5) * 100 / cells
            assert frame["x"].to_numpy() == pytest.approx(centres, abs=1e-10)
    assert np.isfinite(table[["t", "x", "h", "R"]].to_numpy()).all()


def test_eleven_frames_in_a_folder_named_after_the_scene_are_the_default(bcre):
    assert bcre("run", "figure3", "--model", "ca").code == 0
    table, _ = results("out/figure3")
    assert table["t"].nunique() == 11
    scene = write_scene()
    assert bcre("run", scene, "--model", "ca").code == 0
    assert results("out/scene")[1]["ca"]["cells"] == 40


def test_summary_has_the_named_keys_and_the_pde_an_error_estimate(bcre):
    ended = bcre("run", "figure2", *SHORT, "--out", "o")
    _, summary = results()
    assert list(summary) == ["ca", "pde"]
    assert set(summary["ca"]) == BOTH | {"step_lowered", "step_raised", "blocks_redone"}
    assert set(summary["pde"]) == BOTH | PDE_ERRORS
    for word in ("profiles.csv, summary.json, figure.svg in o", "automaton", "BCRE (PDE)"):
        assert word in ended.out
    assert ended.err == ""


def test_summary_is_that_of_the_profiles(bcre):
    bcre("run", "figure2", "--set", "rolling.0.centre=90", *SHORT, "--out", "o")
    table, summary = results()
    for model, rows in table.groupby("model"):
        told = summary[model]
        d = 100 / told["cells"]
        mass = rows.groupby("t")[["h", "R"]].sum().sum(axis=1) * d
        assert told["mass_initial"] == pytest.approx(mass.iloc[0], rel=1e-12)
        assert told["mass_final"] == pytest.approx(mass.iloc[-1], rel=1e-12)
        assert told["outflow"] > 1e-3
        assert mass.iloc[0] - mass.iloc[-1] == pytest.approx(told["outflow"], abs=1e-8)
        assert (told["R_min"], told["R_max"]) == (rows["R"].min(), rows["R"].max())
    assert summary["ca"]["steps"] == 10
    assert summary["ca"]["R_min"] >= 0


@pytest.mark.parametrize("name", built_in_names())
def test_mass_error_of_every_scene_is_at_most_1e_12_in_both_models(bcre, name):
    until = load(name).time.until
    options = ["--set", f"until={until / 4}", "--set", "solver.cells=200"]
    options = options if name.startswith("figure1") else []
    assert bcre("run", name, *options, "--frames", 3, "--out", "o").code == 0
    _, summary = results()
    for model in ("ca", "pde"):
        assert 0 <= summary[model]["mass_error"] <= 1e-12
    assert summary["ca"]["R_min"] >= 0


@pytest.mark.parametrize("model", ["ca", "pde"])
def test_one_model_can_be_run_alone(bcre, model):
    assert bcre("run", "figure2", "--model", model, *SHORT, "--out", "o").code == 0
    table, summary = results()
    assert list(summary) == [model]
    assert set(table["model"]) == {model}


def test_pde_alone_is_refined_to_a_thousandth_and_beside_the_automaton_to_a_tenth_of_the_gap(bcre):
    bcre("run", "figure2", "--model", "pde", *SHORT, "--out", "alone")
    assert 0 < results("alone")[1]["pde"]["error_estimate"] <= 1e-3
    bcre("run", "figure2", *SHORT, "--out", "both")
    assert 0 < results("both")[1]["pde"]["error_estimate"] <= 0.1 * 0.6


def test_pde_alone_refines_a_narrow_pulse_further_than_three_grids(bcre):
    narrow = ["--set", "rolling.0.width=1", "--set", "D=0.01", "--model", "pde"]
    bcre("run", "figure2", *narrow, *SHORT, "--out", "o")
    summary = results()[1]["pde"]
    assert summary["cells"] > 400
    assert summary["error_estimate"] <= 1e-3


def test_error_estimate_covers_the_distance_from_a_much_finer_grid(bcre):
    bcre("run", "figure2", "--model", "pde", *SHORT, "--out", "o", "--set", "solver.cells=100")
    bcre("run", "figure2", "--model", "pde", *SHORT, "--out", "fine", "--set", "solver.cells=900")
    (coarse, summary), (fine, _) = results(), results("fine")
    at_centres = fine["R"].to_numpy().reshape(3, 100, 9)[:, :, 4]
    gap = np.abs(coarse["R"].to_numpy().reshape(3, 100) - at_centres).mean() / coarse["R"].mean()
    assert gap <= summary["pde"]["error_estimate"] <= 100 * gap


def test_pde_on_a_grid_too_small_to_coarsen_says_that_its_error_is_unknown(bcre):
    bcre("run", "figure2", "--model", "pde", *SHORT, "--out", "o", "--set", "solver.cells=25")
    _, summary = results()
    assert summary["pde"]["cells"] == 25
    assert summary["pde"]["error_estimate"] is None


@pytest.mark.parametrize("method", ["RK45", "DOP853", "LSODA", "BDF"])
def test_every_solver_gives_the_same_layers(bcre, method):
    grid = ["--set", "solver.cells=64", "--set", "tolerance=1e-7"]
    options = [*grid, "--model", "pde", *SHORT]
    bcre("run", "figure2", *options, "--out", "o")
    assert bcre("run", "figure2", *options, "--set", f"method={method}", "--out", "p").code == 0
    gap = results()[0]["R"] - results("p")[0]["R"]
    assert np.abs(gap).max() <= 1e-5


def test_set_takes_bare_and_dotted_keys(bcre):
    changes = ["cells=50", "v=1.5", "material.D=0.3", "rolling.0.amplitude=2", "step=0.05"]
    options = [word for change in changes for word in ("--set", change)]
    bcre("run", "figure2", "--model", "ca", *options, *SHORT, "--out", "o")
    table, summary = results()
    start = table[table["t"] == 0]
    x = start["x"].to_numpy()
    assert x == pytest.approx(np.arange(1, 100, 2))
    expected = 2 * np.exp(-(((x - 20) / 4) ** 2))
    assert start["R"].to_numpy() == pytest.approx(expected, rel=1e-12)
    assert summary["ca"]["steps"] == 40
    end = table[table["t"] == 2]
    drift = (end["R"] @ end["x"]) / end["R"].sum() - (start["R"] @ x) / start["R"].sum()
    assert drift == pytest.approx(1.5 * 2, rel=0.01)


def test_scene_of_tables_starts_both_models_from_the_tables(bcre):
    scene = write_scene()
    assert bcre("run", scene, "--frames", 2, "--out", "o").code == 0
    table, _ = results()
    start = table[(table["model"] == "ca") & (table["t"] == 0)]
    for column in ("x", "h", "R"):
        found = pd.read_csv("start.csv")[column].to_numpy()
        assert start[column].to_numpy() == pytest.approx(found, rel=1e-12, abs=1e-12)
    start = table[(table["model"] == "pde") & (table["t"] == 0)]
    expected = np.exp(-(((start["x"] - 8) / 2) ** 2))
    assert start["R"].to_numpy() == pytest.approx(expected.to_numpy(), abs=5e-4)


def test_tables_are_found_beside_the_scene_wherever_the_command_is_started(bcre, monkeypatch):
    scene = Path(write_scene()).resolve()
    Path("elsewhere").mkdir()
    monkeypatch.chdir("elsewhere")
    assert bcre("run", scene, "--model", "ca").code == 0
    written = ("figure.svg", "profiles.csv", "summary.json")
    assert files() == ["out", "out/scene", *(f"out/scene/{name}" for name in written)]


def test_same_run_writes_the_same_profiles(bcre):
    for folder in ("a", "b"):
        bcre("run", "figure3", *SHORT, "--out", folder)
    one, other = (Path(folder, "profiles.csv").read_bytes() for folder in ("a", "b"))
    assert one == other


@pytest.mark.parametrize("title", ["[bold]no[/bold]", "<b>&amp;", "{{ 7 * 7 }}", "[/]", "%s {0}"])
def test_title_with_markup_is_text(bcre, title):
    scene = write_scene(SCENE.replace("A pulse", title))
    assert bcre("run", scene, "--out", "o", *SHORT).code == 0
    assert bcre("run", "figure2", "--model", "ca", "--set", f"title={title}", *SHORT).code == 0
    refused(bcre("run", "figure2", "--set", f"v={title}"), "material.v", title)


# What it refuses

NUMBERS = {
    "v": "material.v",
    "D": "material.D",
    "gamma": "material.gamma",
    "Sc": "material.Sc",
    "kappa": "material.kappa",
    "length": "domain.length",
    "until": "time.until",
    "step": "time.step",
    "solver.tolerance": "solver.tolerance",
    "rolling.0.amplitude": "rolling.0.amplitude",
    "rolling.0.width": "rolling.0.width",
}


@pytest.mark.parametrize("key", NUMBERS)
def test_what_is_no_finite_number_or_negative_is_refused(bcre, key):
    for text, value in {
        "nan": "nan",
        "inf": "inf",
        "-inf": "-inf",
        "-1": "-1",
        "-1e-9": "-1e-9",
        "fast": "'fast'",
        '""': "''",
        "true": "True",
        "[1.0]": "[1.0]",
        "2020-01-01": "2020",
    }.items():
        refused(bcre("run", "figure2", "--set", f"{key}={text}"), f"{NUMBERS[key]} = ", value)
    assert files() == []


@pytest.mark.parametrize("key", ["rolling.0.centre", "surface.0.slope"])
def test_place_or_slope_that_is_no_finite_number_is_refused(bcre, key):
    for text in ("nan", "inf", "-inf", "high"):
        refused(bcre("run", "figure2", "--set", f"{key}={text}"), f"{key} = ", text)
    assert files() == []


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["figure9"], ["figure9", "figure1", "rough_slope"]),
        (["nowhere.toml"], ["nowhere.toml", "no such scene"]),
        (["."], ["no such scene"]),
        ([""], ["no such scene"]),
        (["figure2", "--model", "ode"], ["--model", "'ode'", "'both'"]),
        (["figure2", "--frames", "1"], ["--frames", "1", "2<=x"]),
        (["figure2", "--frames", "-3"], ["--frames", "-3", "2<=x"]),
        (["figure2", "--frames", "2.5"], ["--frames", "2.5"]),
        (["figure2", "--frames", "many"], ["--frames", "'many'"]),
        (["figure2", "--set", "v"], ["--set", "'v'", "key=value"]),
        (["figure2", "--set", "speed=3"], ["speed = 3", "v, D, gamma"]),
        (["figure2", "--set", "material.speed=3"], ["material.speed = 3", "no such key"]),
        (["figure2", "--set", "sand.v=3"], ["sand", "no such key"]),
        (["figure2", "--set", "rolling.0.height=3"], ["rolling.0.height = 3"]),
        (["figure2", "--set", "rolling.7.width=3"], ["rolling.7.width = 3", "0..0"]),
        (["figure2", "--set", "cells=10.5"], ["domain.cells = 10.5", "integer"]),
        (["figure2", "--set", "cells=0"], ["domain.cells = 0", "greater"]),
        (["figure2", "--set", "cells=99999999999"], ["domain.cells = 99999999999", "less"]),
        (["figure2", "--set", "solver.cells=7"], ["solver.cells = 7", "8"]),
        (["figure2", "--set", "method=euler"], ["solver.method = 'euler'", "'DOP853'"]),
        (["figure2", "--set", "ends=closed"], ["domain.ends = 'closed'", "'periodic'"]),
        (["figure2", "--set", "step=slow"], ["time.step = 'slow'", "'auto'"]),
        (["figure2", "--set", "title=3"], ["title = 3", "string"]),
        (["figure2", "--set", "rolling.0.kind=box"], ["rolling.0.kind = 'box'", "'gaussian'"]),
        (["figure2", "--set", "v=1\nfast"], ["material.v", "number"]),
        (["figure2", "--speed", "3"], ["--speed"]),
        (["figure2", "figure3"], ["figure3"]),
        ([], ["SCENE"]),
    ],
)
def test_bad_input_ends_in_one_line_exit_2_and_nothing_on_disk(bcre, arguments, words):
    refused(bcre("run", *arguments), *words)
    assert files() == []


@settings(max_examples=30, deadline=None)
@given(key=st.text(max_size=12), value=st.text(max_size=12))
def test_unknown_key_is_refused_whatever_its_name_and_value(run_bcre, key, value):
    fields = {field for model in SECTIONS.values() for field in model.model_fields}
    name = key.split("=")[0].strip()
    if name in fields | {"title", "material", "domain", "time", "solver"}:
        return
    with tempfile.TemporaryDirectory() as folder:
        refused(run_bcre("run", "figure2", f"--set={key}={value}", "--out", f"{folder}/o"))
        assert files(folder) == []


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["step=1e-320"], ["time.step = 1e-320"]),
        (["step=1e-300"], ["time.step = 1e-300"]),
        (["until=1e300"], ["time.until = 1e+300"]),
        (["length=1e-200"], ["domain.length = 1e-200"]),
        (["length=1e-320"], ["domain.length = 1e-320"]),
        (["surface.0.slope=1e308"], ["surface.0.slope = 1e+308"]),
        (["rolling.0.width=1e-200"], ["rolling.0.width = 1e-200"]),
        (["rolling.0.amplitude=1e308"], ["time.step = 0.2", "9.84496e+307"]),
    ],
)
def test_number_that_cannot_be_computed_with_is_named(bcre, options, words):
    for model in ("ca", "both"):
        changes = [word for option in options for word in ("--set", option)]
        refused(bcre("run", "figure2", "--model", model, *changes), *words)
    assert files() == []


@pytest.mark.parametrize(
    "changes",
    [["tolerance=1e-300"], ["method=LSODA", "tolerance=1e-300"]],
)
def test_solver_that_gives_up_is_named_with_its_tolerance(bcre, changes):
    options = [word for change in changes for word in ("--set", change)]
    ended = bcre("run", "figure2", "--model", "pde", "--set", "until=0.1", *options)
    refused(ended, "solver.method = ", "solver.tolerance = ")
    assert files() == []


@pytest.mark.parametrize(
    ("model", "change"),
    [("pde", "v=1e300"), ("pde", "gamma=1e300"), ("pde", "until=1e12"), ("ca", "step=1e-12")],
)
def test_run_that_would_not_end_is_refused_with_its_steps(bcre, model, change):
    ended = bcre("run", "figure2", "--model", model, "--set", change)
    refused(ended, "time.", f"steps of the {NAMES[model]}", "must take at most")
    assert files() == []


@pytest.mark.parametrize("target", ["taken", "taken/below", "folder"])
def test_folder_that_cannot_be_written_is_refused_before_anything_is_run(bcre, target):
    Path("taken").write_text("a file")
    Path("folder/profiles.csv").mkdir(parents=True)
    refused(bcre("run", "figure2", "--model", "ca", "--out", target), "out", target)
    assert files() == ["folder", "folder/profiles.csv", "taken"]


@pytest.mark.parametrize("cells", [100, 170])
def test_step_that_cannot_be_stable_is_refused_with_the_largest_that_would_be(bcre, cells):
    grid = ["--set", f"cells={cells}"]
    message = refused(
        bcre("run", "figure2", *grid, "--set", "step=1.5"), "time.step = 1.5", "'auto'"
    )
    largest = float(re.search(r"largest stable step is ([\d.e-]+)", message)[1])
    scene = load("figure2").with_changes(cells=cells, step=1.5)
    x = scene.centres()
    assert largest == pytest.approx(
        rule_of(scene).max_stable_step(scene.initial(x)[1].max(), 0.48), rel=1e-5
    )
    assert files() == []
    run = ["run", "figure2", "--model", "ca", *grid, "--set"]
    assert bcre(*run, f"step={largest * (1 - 1e-5)}").code == 0
    refused(bcre(*run, f"step={largest * (1 + 1e-5)}"), "largest stable step")


def test_step_that_the_avalanche_outgrows_is_refused_though_stable_at_the_start(bcre):
    arguments = ["run", "figure1", "--model", "ca", "--set", "step=1.5"]
    assert bcre(*arguments, "--set", "until=20", "--out", "start").code == 0
    before = files()
    message = refused(bcre(*arguments, "--out", "o"), "time.step = 1.5", "'auto'")
    assert "outgrew" in message or "lost stability" in message
    assert files() == before


@pytest.mark.parametrize(
    ("break_it", "words"),
    [
        (lambda: Path("start.csv").unlink(), ["surface.0.file = 'start.csv'", "no such file"]),
        (
            lambda: Path("start.csv").write_text('x,h,R\n"1,2\n', encoding="utf-8"),
            ["surface.0.file = 'start.csv'"],
        ),
        (lambda: Path("start.csv").write_text("", encoding="utf-8"), ["start.csv", "CSV"]),
        (
            lambda: write_scene(x=np.arange(40)[::-1]),
            ["start.csv", "line 3: x = 38", "must ascend"],
        ),
        (
            lambda: write_scene(h=np.full(40, np.nan)),
            ["start.csv", "line 2: h = ''", "must be a number"],
        ),
        (lambda: write_scene(h=np.full(40, np.inf)), ["start.csv", "finite"]),
        (lambda: write_scene(R=np.full(40, -0.5)), ["rolling.0.file", "-0.5", ">= 0"]),
        (lambda: write_scene(x=np.linspace(3, 9, 40)), ["start.csv", "must span"]),
        (lambda: write_scene(SCENE.replace("v = 0.6", "")), ["material.v", "missing"]),
        (lambda: write_scene(SCENE.replace("v = 0.6", "v == 0.6")), ["scene.toml", "TOML"]),
        (lambda: write_scene("\x00"), ["scene.toml", "TOML"]),
        (lambda: write_scene(""), ["title", "missing"]),
        (lambda: Path("scene.toml").write_bytes(b"title = '\xff'"), ["scene.toml", "UTF-8"]),
    ],
)
def test_bad_scene_file_ends_in_one_line_exit_2_and_nothing_more_on_disk(bcre, break_it, words):
    write_scene()
    break_it()
    before = files()
    refused(bcre("run", "scene.toml"), *words)
    assert files() == before


def test_folder_that_is_a_file_is_refused_and_left_alone(bcre):
    Path("o").write_text("mine", encoding="utf-8")
    refused(bcre("run", "figure2", "--model", "ca", "--out", "o"), "--out", "'o'")
    refused(bcre("run", "figure2", "--model", "ca", "--out", "o/inside"), "o/inside")
    assert Path("o").read_text(encoding="utf-8") == "mine"
    assert files() == ["o"]


def test_unknown_study_is_refused_before_any_is_run(bcre):
    message = refused(bcre("study", "one_variable", "alchemy"), "'alchemy'", *catalog.STUDIES)
    assert "NAME" in message
    refused(bcre("study"), "NAME")
    refused(bcre("dig"), "'dig'")
    assert files() == []


def test_interrupted_run_leaves_no_file(bcre, monkeypatch):
    def interrupt(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(run_module, "run_scene", interrupt)
    ended = bcre("run", "figure2")
    assert (ended.code, ended.out) == (130, "")
    assert len(ended.err.splitlines()) <= 2
    assert files() == []


# What it says


def test_list_names_all_scenes_and_studies_with_their_titles(bcre):
    ended = bcre("list")
    assert (ended.code, ended.err) == (0, "")
    lines = [line.split(maxsplit=1) for line in ended.out.splitlines()]
    told = {name: rest.strip() for name, rest in lines}
    for name in line_and_plane_names():
        assert told[name] == built_in_title(name)
    for name in catalog.STUDIES:
        assert told[name] == catalog.STUDIES[name].title
    assert len(told) == 2 + len(line_and_plane_names()) + len(catalog.STUDIES)
    assert files() == []


def test_bcre_is_the_command_of_the_package():
    (script,) = entry_points(group="console_scripts", name="bcre")
    assert script.value == "bcre_studies.cli:main"


def test_help_names_the_five_commands_and_starts_without_the_numerical_libraries():
    script = (
        "import sys; from bcre_studies.cli import main\n"
        "for argv in (['bcre', '--help'], ['bcre'], ['bcre', 'run', '--help']):\n"
        "    sys.argv = argv; main()\n"
        "heavy = {'numpy', 'scipy', 'pandas', 'numba', 'matplotlib', 'pde', 'rich', 'pydantic'}\n"
        "print('loaded:', *sorted(heavy & set(sys.modules)))"
    )
    ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert (ended.returncode, ended.stderr) == (0, "")
    assert ended.stdout.splitlines()[-1].strip() == "loaded:"
    for name in ("run", "list", "study", "report", "check"):
        assert f"\n  {name} " in ended.stdout
    for option in ("--model", "--set", "--frames", "--out"):
        assert option in ended.stdout


def test_command_ends_with_exit_2_and_one_line_in_a_process_of_its_own(tmp_path):
    command = [Path(sys.executable).with_name("bcre"), "run", b"\xff", "--set", b"v=\xfe"]
    ended = subprocess.run(command, capture_output=True, cwd=tmp_path)
    assert (ended.returncode, ended.stdout) == (2, b"")
    assert ended.stderr.startswith(b"bcre: ")
    assert ended.stderr.count(b"\n") == 1
    assert files(tmp_path) == []
