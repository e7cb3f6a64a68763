"""Whatever is wrong with the files of compiled code costs a compilation and nothing else."""

import importlib.util
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest
from numba.core.caching import IndexDataCacheFile

import bcre_ca.kept
import bcre_pde.kept

KEEPERS = {"automaton": bcre_ca.kept.kept, "BCRE": bcre_pde.kept.kept()}


@pytest.fixture(params=KEEPERS)
def compiled(request, tmp_path):
    """A new dispatcher of the same function at every call, as in a new process."""
    source = tmp_path / "double.py"
    source.write_text("def double(x):\n    return 2 * x\n")
    spec = importlib.util.spec_from_file_location("double", source)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return lambda: KEEPERS[request.param](module.double)


def files_in(folder):
    return [path for path in (folder / "__pycache__").iterdir() if path.suffix in (".nbc", ".nbi")]


def hits(dispatcher):
    return sum(dispatcher.stats.cache_hits.values())


def test_machine_code_is_read_by_the_next_process(compiled):
    assert compiled()(3.0) == 6.0
    again = compiled()
    assert (again(3.0), hits(again)) == (6.0, 1)


@pytest.mark.parametrize("content", [b"", b"cut", None], ids=["empty", "cut", "half"])
def test_damaged_files_are_written_anew(compiled, tmp_path, content):
    compiled()(3.0)
    assert files_in(tmp_path)
    for path in files_in(tmp_path):
        whole = path.read_bytes()
        path.write_bytes(whole[: len(whole) // 2] if content is None else content)
    damaged, mended = compiled(), compiled()
    assert (damaged(3.0), hits(damaged)) == (6.0, 0)
    assert (mended(3.0), hits(mended)) == (6.0, 1)


def refuse(*_, **__):
    raise OSError(28, "No space left on device")


def test_full_disk_is_no_failure(compiled, tmp_path, monkeypatch):
    monkeypatch.setattr(IndexDataCacheFile, "_open_for_write", refuse)
    monkeypatch.setattr(tempfile, "mkstemp", refuse)
    assert compiled()(3.0) == 6.0
    assert not files_in(tmp_path)


def test_no_folder_that_can_be_written_to_is_no_failure(compiled, monkeypatch):
    monkeypatch.setattr(tempfile, "TemporaryFile", refuse)
    assert compiled()(3.0) == 6.0


def test_no_home_is_no_failure(compiled, monkeypatch):
    def homeless(path):
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(Path, "expanduser", homeless)
    assert compiled()(3.0) == 6.0


BOTH_SIDES = """
import numpy as np, bcre_ca, bcre_pde
rule = bcre_ca.Rule(v=0.1, D=0.1, gamma=0.01, Sc=0.5, d=1.0, dt=0.2)
h, R = bcre_ca.evolve(np.linspace(8, 0, 16), np.ones(16), rule, 3)
material = bcre_pde.Material(v=0.1, D=0.1, gamma=0.01, Sc=0.5)
problem = bcre_pde.Problem(lambda x: (-x, np.ones(x.size)), material, 8.0)
print(R.sum(), bcre_pde.solve(problem, [0, 0.1], 8).R[-1].sum())
"""


def test_both_models_run_without_the_compiler():
    plain, compiled = (
        subprocess.run(
            [sys.executable, "-c", BOTH_SIDES],
            env=os.environ | {"NUMBA_DISABLE_JIT": without},
            capture_output=True,
            text=True,
            check=True,
        ).stdout.split()
        for without in "10"
    )
    assert plain[0] == compiled[0]  # to the bit
    assert float(plain[1]) == pytest.approx(float(compiled[1]), rel=1e-12)
