"""The time to compile stands apart from the time to run."""

import time

import numba
import pytest
from numba.core import event

import bcre_ca
from bcre_studies.models.registry import AUTOMATON, Model
from bcre_studies.models.run import frame_times
from bcre_studies.running.place import Origin
from bcre_studies.running.run import run_scene, write_run
from bcre_studies.scenes.scene import load
from bcre_studies.system.compiling import compiling

AWHILE = 0.2
SCENE = load("figure2", ["until=1"])


def compile_awhile():
    """What numba makes known of a compilation of this length."""
    with event.trigger_event("numba:compiler_lock"):
        time.sleep(AWHILE)


def test_compiling_counts_and_running_does_not():
    @numba.njit
    def add(a):
        return a + 1

    with compiling() as compiled_s:
        add(1)
        first = compiled_s()
        assert first > 0
        add(1)
        time.sleep(0.01)
        assert compiled_s() == first
        add(1.0)
        assert compiled_s() > first


def test_first_run_of_the_automaton_does_not_report_compiling_as_running(monkeypatch):
    frames = bcre_ca.frames

    def compiled_on_the_way(*arguments, **options):
        compile_awhile()
        yield from frames(*arguments, **options)
        compile_awhile()

    monkeypatch.setattr(bcre_ca, "frames", compiled_on_the_way)
    began = time.perf_counter()
    run = AUTOMATON.run(SCENE, frame_times(SCENE, 3))
    elapsed = time.perf_counter() - began
    assert 0 < run.wall_s <= elapsed - 2 * AWHILE


def test_summary_gives_each_model_what_compiling_it_took(monkeypatch, tmp_path):
    answer = Model.answer

    def compiled_before(model, *arguments):
        if model.name == "pde":
            compile_awhile()
        return answer(model, *arguments)

    run_scene(SCENE, "both", 2)  # whatever there is to compile
    monkeypatch.setattr(Model, "answer", compiled_before)
    summary = write_run(run_scene(SCENE, "both", 2), tmp_path, Origin("figure2"))
    assert summary["pde"]["compile_s"] >= AWHILE
    assert summary["ca"]["compile_s"] == pytest.approx(0, abs=0)
