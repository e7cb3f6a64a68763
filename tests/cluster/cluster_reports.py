"""Studies on a real Dask cluster find what they find on one machine."""

import pytest
from sweep_of_sleepers import sleep

from bcre_studies import cli
from bcre_studies.sweeps import parallel, workers
from bcre_studies.validation import one_variable

CASES = [("reach", 0.0, 0.0), ("roughness", 0.0, 0.0)]


def test_cases_of_a_study_are_the_same_to_the_last_bit(cluster):
    here = [one_variable._case(case) for case in CASES]
    with parallel.on(cluster.address):
        there = parallel.each(one_variable._case, CASES, "one_variable")
    assert there == here


def test_cases_are_measured_by_the_cluster_and_kept_by_the_run(cluster, tmp_path):
    cases = [{"number": number, "poison": False} for number in range(20)]
    with parallel.kept(tmp_path), parallel.on(cluster.address):
        first = parallel.each(sleep, cases, "sleepers")
        assert parallel.each(sleep, cases, "sleepers") == first
    assert first == [{"square": number**2} for number in range(20)]
    assert set(cluster.traced().values()) == {1}
    assert len(list(tmp_path.iterdir())) == 20


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "nowhere"])
@pytest.mark.parametrize("command", [["report"], ["study", "one_variable"], ["sweep", "spec.toml"]])
def test_a_scheduler_that_does_not_answer_is_one_line_that_names_it(
    command, address, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "spec.toml").write_text(SPEC)
    monkeypatch.setattr(workers, "ANSWER_S", 0.2)
    monkeypatch.setattr("sys.argv", ["bcre", *command, "--scheduler", address])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert ended.value.code == 2
    told = capsys.readouterr().err
    assert told.startswith(f"bcre: --scheduler = {address!r}: no scheduler answers there")
    assert told.count("\n") == 1
    assert not list(tmp_path.rglob("*.parquet"))


SPEC = """
title = "Slopes"
scene = "figure1"
models = ["ca"]
observables = ["slope"]
[[axis]]
key = "surface.0.slope"
values = [0.6, 1.0]
"""
