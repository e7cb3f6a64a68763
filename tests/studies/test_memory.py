"""A run that will not fit into memory is refused before it takes any, by key and size."""

import json
import os
import subprocess
import sys

import psutil
import pytest

from bcre_studies.models.registry import MODELS, Model
from bcre_studies.running.run import require_runnable, run_scene
from bcre_studies.scenes import tables
from bcre_studies.scenes.scene import SceneError, load
from bcre_studies.system import memory

CASES = [
    ("ca", 101, ["cells=8000", "until=0.001", "step=auto"]),
    ("pde", 101, ["solver.cells=6000", "until=0.001"]),
    ("pde", 2, ["solver.cells=4000", "until=0.0001", "method=BDF"]),
]

MEASURE = """
import gc, json, sys
from pathlib import Path
from bcre_studies.running.place import Origin
from bcre_studies.running.run import run_scene, write_run
from bcre_studies.scenes.scene import load

def run(model, frames, changes):
    write_run(run_scene(load("figure2", changes), model, frames), Path("out"), Origin("figure2"))

def peak():
    status = Path("/proc/self/status").read_text().splitlines()
    (line,) = [line for line in status if line.startswith("VmHWM")]
    return int(line.split()[1]) * 1024

def growth(case):
    gc.collect()
    Path("/proc/self/clear_refs").write_text("5")  # the peak begins again from what is held now
    before = peak()
    run(*case)
    return peak() - before

for method in ("runge-kutta", "BDF"):  # the compiler takes more memory than a run
    run("both", 2, ["until=0.001", "cells=25", "solver.cells=32", f"method={method}"])
print(json.dumps([growth(case) for case in json.loads(sys.argv[1])]))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux can begin a peak anew")
def test_estimates_are_within_a_factor_of_two_of_the_measured_peaks(tmp_path):
    # Arrays of more than 64 kB go back to the system when they are freed.
    environment = os.environ | {"MALLOC_MMAP_THRESHOLD_": "65536"}
    command = [sys.executable, "-c", MEASURE, json.dumps(CASES)]
    ended = subprocess.run(
        command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=True
    )
    for (model, frames, changes), measured in zip(CASES, json.loads(ended.stdout), strict=True):
        scene = load("figure2", changes)
        needed = MODELS[model].adapter().memory(scene, frames)
        assert measured > 1e7
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


@pytest.fixture
def groups(tmp_path):
    """Control groups of both versions, each with a limit above the process's own group."""
    own, root = tmp_path / "own", tmp_path / "groups"
    own.write_text("4:memory:/a/b\n1:cpu:/\n0::/c\n")
    version_1 = {"limit_in_bytes": "9000\n", "usage_in_bytes": "4000\n"}
    version_1["stat"] = "inactive_file 1\ntotal_inactive_file 500\n"
    version_2 = {"max": "8000\n", "current": "1000\n", "stat": "inactive_file 200\n"}
    nothing = {"limit_in_bytes": "no number\n"}
    for folder, files in (("memory/a", version_1), ("memory/a/b", nothing), ("c", version_2)):
        (root / folder).mkdir(parents=True)
        for name, text in files.items():
            (root / folder / f"memory.{name}").write_text(text)
    return root, own


def test_control_groups_leave_their_limits_less_what_is_used_and_not_idle(groups, tmp_path):
    root, own = groups
    assert list(memory._of_groups(root, own)) == [5500, 7200]
    (root / "c/memory.max").write_text("max\n")
    assert list(memory._of_groups(root, own)) == [5500]
    assert list(memory._of_groups(root, tmp_path / "none")) == []


def test_what_is_available_is_the_least_that_a_limit_leaves(monkeypatch):
    machine = psutil.virtual_memory().available
    assert 0 < memory.available() <= machine * 1.5
    monkeypatch.setattr(memory, "_of_groups", lambda: [7000, 5000])
    assert memory.available() == 5000
    monkeypatch.setattr(memory, "_of_process", lambda: [-1])
    assert memory.available() == 0


@pytest.mark.skipif(not hasattr(psutil, "RLIMIT_AS"), reason="psutil knows limits on Linux only")
@pytest.mark.parametrize(("limit", "held"), [("AS", "vms"), ("DATA", "data")])
def test_limit_of_the_address_space_counts(limit, held):
    script = f"""
import psutil, resource
from bcre_studies.system import memory
held = psutil.Process().memory_info().{held}
resource.setrlimit(resource.RLIMIT_{limit}, (held + 10**8, resource.RLIM_INFINITY))
print(memory.available())
"""
    printed = subprocess.run([sys.executable, "-c", script], capture_output=True, check=True).stdout
    assert 0.8e8 < int(printed) <= 1e8
