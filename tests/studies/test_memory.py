"""Memory is told before it is taken: how much, of how much, and by which key."""

import subprocess
import sys

import pytest

from bcre_studies.models.registry import MODELS, Model
from bcre_studies.running.run import require_runnable, run_scene
from bcre_studies.scenes import tables
from bcre_studies.scenes.scene import SceneError, load
from bcre_studies.system import memory

MEASURE = """
import resource, sys
from pathlib import Path
from bcre_studies.running.run import run_scene, write_run
from bcre_studies.scenes.scene import load

def peak():
    # What getrusage tells begins with the memory of the process that started this one.
    status = Path("/proc/self/status")
    if status.exists():
        (line,) = [line for line in status.read_text().splitlines() if line.startswith("VmHWM")]
        return int(line.split()[1]) * 1024
    unit = 1 if sys.platform == "darwin" else 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit

small = load("figure2", ["until=0.001", "cells=10", "solver.cells=32"])
write_run(run_scene(small, "both", 2), Path("small"))
before = peak()
model, frames, *changes = sys.argv[1:]
write_run(run_scene(load("figure2", changes), model, int(frames)), Path("large"))
print(peak() - before)
"""


@pytest.mark.parametrize(
    ("model", "frames", "changes"),
    [
        ("ca", 101, ["cells=20000", "until=0.001", "step=auto"]),
        ("pde", 101, ["solver.cells=6000", "until=0.01"]),
        ("pde", 2, ["solver.cells=20000", "until=0.001", "method=BDF"]),
    ],
)
def test_estimate_is_within_a_factor_of_two_of_the_measured_peak(tmp_path, model, frames, changes):
    command = [sys.executable, "-c", MEASURE, model, str(frames), *changes]
    for _ in ("the compiler takes more memory than the run: once so that all is compiled", "so"):
        ended = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    needed = MODELS[model].adapter().memory(load("figure2", changes), frames)
    measured = int(ended.stdout)
    assert measured > 3e7
    assert 0.5 < needed / measured < 2


@pytest.mark.parametrize("model", ["ca", "pde", "both"])
def test_run_beyond_what_is_available_is_refused_before_anything_is_sampled(monkeypatch, model):
    scene = load("figure2", ["cells=10000000"])
    monkeypatch.setattr(memory, "available", lambda: 3_000_000_000)
    monkeypatch.setattr(type(scene), "initial", lambda *_: pytest.fail("sampled"))
    with pytest.raises(SceneError) as refusal:
        run_scene(scene, model, 1000)
    for word in ("domain.cells = 10000000", "--frames = 1000", "would take", "3 GB"):
        assert word in str(refusal.value)


def test_frames_count_as_cells_do(monkeypatch):
    scene = load("figure2", ["cells=1000", "step=auto"])
    monkeypatch.setattr(memory, "available", lambda: 100_000_000)
    require_runnable(scene, "ca", 11)
    with pytest.raises(SceneError, match="--frames = 10000"):
        require_runnable(scene, "ca", 10_000)


def test_full_jacobian_of_lsoda_counts(monkeypatch):
    monkeypatch.setattr(memory, "available", lambda: 1_000_000_000)
    grid = ["solver.cells=10000"]
    require_runnable(load("figure2", [*grid, "method=DOP853"]), "pde", 2)
    with pytest.raises(SceneError, match=r"solver\.cells = 10000"):
        require_runnable(load("figure2", [*grid, "method=LSODA"]), "pde", 2)


def test_table_too_large_for_the_memory_is_refused_before_it_is_read(tmp_path, monkeypatch):
    monkeypatch.setattr(memory, "available", lambda: 49_000)
    monkeypatch.setattr(tables.csv, "reader", lambda *_: pytest.fail("read"))
    (tmp_path / "t.csv").write_text("x,h\n" * 250)
    with pytest.raises(SceneError, match=r"surface\.0\.file = 't\.csv'.*would take 0\.05 MB"):
        scene_with_table(tmp_path)


def scene_with_table(folder):
    path = folder / "s.toml"
    path.write_text(
        'title = "t"\n[material]\nv = 1\nD = 1\ngamma = 1\nSc = 1\n'
        '[domain]\nlength = 20\ncells = 9\nends = "open"\n[time]\nuntil = 1\n'
        '[[surface]]\nkind = "table"\nfile = "t.csv"\n'
    )
    return load(path)


def test_memory_that_runs_out_after_all_is_told_by_key(monkeypatch):
    def fail(*_):
        raise MemoryError

    monkeypatch.setattr(Model, "answer", fail)
    with pytest.raises(SceneError, match=r"domain\.cells = 100"):
        run_scene(load("figure2"), "ca", 2)


def test_what_is_available_is_the_least_of_machine_and_control_groups(tmp_path, monkeypatch):
    machine = memory._of_machine()
    assert 0 < memory.available() <= machine * 1.5
    own, root = tmp_path / "own", tmp_path / "groups"
    own.write_text("4:memory:/a/b\n1:cpu:/\n0::/c\n")
    v1, v2 = root / "memory/a", root / "c"
    for folder in (v1 / "b", v2):
        folder.mkdir(parents=True)
    (v1 / "memory.limit_in_bytes").write_text("9000\n")
    (v1 / "memory.usage_in_bytes").write_text("4000\n")
    (v1 / "memory.stat").write_text("inactive_file 1\ntotal_inactive_file 500\n")
    (v1 / "b/memory.limit_in_bytes").write_text("no number\n")
    (v2 / "memory.max").write_text("max\n")
    assert list(memory._of_groups(root, own)) == [5500]
    (v2 / "memory.max").write_text("8000\n")
    (v2 / "memory.current").write_text("1000\n")
    (v2 / "memory.stat").write_text("inactive_file 200\n")
    assert sorted(memory._of_groups(root, own)) == [5500, 7200]
    assert list(memory._of_groups(root, tmp_path / "none")) == []
