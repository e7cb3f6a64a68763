"""Spoilt scene files: every one is refused in one line, or runs to finite layers."""

import random
import subprocess
import sys
import warnings

import numpy as np
import pytest

import bcre_pde
import fuzz
from bcre_studies import cli
from bcre_studies.models.automaton import rule_of
from bcre_studies.models.bcre import problem_of
from bcre_studies.running.run import require_runnable, run_scene
from bcre_studies.scenes.scene import SceneError, load
from bcre_studies.system import memory

EACH = 180
STEPS = 20


@pytest.fixture
def modest(monkeypatch):
    """A machine with 50 MB to spare, so that what is huge is refused and not tried."""
    monkeypatch.setattr(memory, "available", lambda: 50_000_000)


def tried(path):
    """The scene if it is accepted, and the refusal if not."""
    try:
        scene = load(path)
        require_runnable(scene, "both", 3)
    except SceneError as refusal:
        return None, str(refusal)
    return scene, ""


def shortened(scene):
    """The scene for the time of so many steps of the finest grid that it may be run on."""
    x = scene.centres(4 * max(scene.domain.cells, 100))
    R = float(scene.initial(x)[1].max())
    bound = bcre_pde.largest_explicit_step(problem_of(scene).material, x[1] - x[0], R)
    return scene.with_changes(until=min(scene.time.until, STEPS * min(bound, rule_of(scene).dt)))


@pytest.mark.parametrize("kind", fuzz.KINDS)
def test_spoilt_scene_is_refused_in_one_line_or_runs_to_finite_layers(kind, tmp_path, modest):
    chance, refused = random.Random(kind), 0
    for _ in range(EACH):
        path = fuzz.write(tmp_path, fuzz.spoil(kind, chance))
        with warnings.catch_warnings(action="error"):
            scene, refusal = tried(path)
        if scene is None:
            refused += 1
            assert refusal.isprintable()
            assert 10 < len(refusal) < 3000
            assert " " in refusal
        elif chance.random() < 0.2:
            runs_to_finite_layers(scene)
    assert refused > 0
    assert len(fuzz.KINDS) * EACH >= 2000


def runs_to_finite_layers(scene):
    try:
        runs = run_scene(shortened(scene), "both", 3)
    except SceneError as refusal:  # a fixed step that is not stable, a tolerance out of reach
        assert str(refusal).startswith(("time.step = ", "solver."))  # noqa: PT017
        return
    for run in runs:
        for layer in (run.h, run.R, run.outflow):
            assert np.isfinite(layer).all()
        assert run.model == "pde" or run.R.min() >= 0


@pytest.mark.parametrize("text", [fuzz.SCENE, fuzz.PERIODIC])
def test_scenes_that_are_spoilt_are_good_before(tmp_path, text):
    path = fuzz.write(tmp_path, (text.encode(), fuzz.TABLE.encode()))
    runs_to_finite_layers(tried(path)[0])


@pytest.fixture
def spoilt(tmp_path):
    """Spoils the scene until it is refused; returns its path."""
    chance = random.Random(40)

    def spoilt(kind):
        path = fuzz.write(tmp_path, fuzz.spoil(kind, chance))
        while tried(path)[0] is not None:
            path = fuzz.write(tmp_path, fuzz.spoil(kind, chance))
        return path

    return spoilt


def refuses(ended, folder):
    code, out, err = ended
    assert (code, out) == (2, "")
    assert err.startswith("bcre: ")
    assert err.count("\n") == 1
    assert {entry.name for entry in folder.iterdir()} == {"scene.toml", "start.csv"}


@pytest.mark.parametrize("kind", fuzz.KINDS)
def test_spoilt_scene_ends_the_command_with_exit_2_one_line_and_nothing_written(
    kind, spoilt, tmp_path, monkeypatch, capfd
):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["bcre", "run", spoilt(kind).name, "--out", "o"])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    refuses((ended.value.code, *capfd.readouterr()), tmp_path)


def test_spoilt_scene_ends_a_process_of_its_own_likewise(spoilt, tmp_path):
    script = "import sys; from bcre_studies.cli import main\nsys.argv[0] = 'bcre'; main()"
    command = [sys.executable, "-c", script, "run", spoilt("deep nesting").name, "--out", "o"]
    ended = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    refuses((ended.returncode, ended.stdout, ended.stderr), tmp_path)


@pytest.mark.parametrize("depth", [300, 50_000])
def test_keys_of_very_many_parts_are_refused_before_they_are_read(tmp_path, depth):
    path = tmp_path / "scene.toml"
    path.write_text(".".join("a" * depth * 4) + " = 1", encoding="utf-8")
    assert "must be a TOML file" in tried(path)[1]


def test_integer_that_cannot_be_shown_is_told_by_its_key_and_size(tmp_path, capfd):
    text = fuzz.SCENE.replace("seed = 1", "seed = 0x" + "f" * 900)
    path = fuzz.write(tmp_path, (text.encode(), fuzz.TABLE.encode()))
    assert "surface.2.seed = an integer of 3600 bits: must be one of at most 63" in tried(path)[1]
    assert capfd.readouterr().err == ""


def test_control_characters_of_a_key_reach_no_terminal(tmp_path):
    text = fuzz.SCENE.replace("v = 0.6", 'v = 0.6\n"\\u001b[2J" = 1')
    path = fuzz.write(tmp_path, (text.encode(), fuzz.TABLE.encode()))
    assert tried(path)[1].startswith(r"material.\x1b[2J = 1: no such key")
