"""Sweeps on a real Dask cluster: the same tables, whoever is killed on the way."""

import os
import signal
from concurrent.futures import ThreadPoolExecutor

from sweep_of_sleepers import POINTS, sweep_of

from bcre_studies import cli
from bcre_studies.sweeps.stream import DIED
from bcre_studies.sweeps.sweep import run
from bcre_studies.sweeps.table import TABLE, read

SPEC = """
title = "Slope against pulse"
scene = "figure1"
models = ["ca", "height alone"]
observables = ["slope", "R", "top"]
set = { until = 1000.0 }

[[axis]]
key = "rolling.0.amplitude"
values = [1e-6, 1.0, 10.0]

[[axis]]
key = "surface.0.slope"
from = 0.6
to = 4.0

[[axis]]
key = "D"
from = 0.0
to = 0.3

[sample]
method = "latin hypercube"
count = 20
seed = 7
"""


def silent(_):
    """No word of the sweep's estimate."""


def is_whole(table):
    """Whether every point of the sweep of sleepers is there once, with its result."""
    squares = [number**2 for number in range(POINTS)]
    return list(table["square"]) == squares and set(table["failure"]) == {""}


def test_the_same_sweep_here_and_on_the_cluster_writes_the_same_bytes(cluster, monkeypatch, capsys):
    monkeypatch.chdir(cluster.folder)
    (cluster.folder / "spec.toml").write_text(SPEC)
    for out, more in (("here", []), ("there", ["--scheduler", cluster.address])):
        monkeypatch.setattr("sys.argv", ["bcre", "sweep", "spec.toml", "--out", out, *more])
        cli.main()
        assert "measured 60 points" in capsys.readouterr().out
    assert (cluster.folder / "here" / TABLE).read_bytes() == (
        cluster.folder / "there" / TABLE
    ).read_bytes()
    table = read(cluster.folder / "there")
    assert list(table["failure"]) == [""] * 60
    assert set(table["top_automaton"]) == {0.0, 1.0}


def test_a_killed_worker_loses_nothing_and_costs_a_tenth_of_the_points_at_most(cluster):
    victim = cluster.worker_pids()[0]
    with ThreadPoolExecutor(1) as thread:
        sweep = thread.submit(run, sweep_of(), cluster.folder / "a", cluster.address, silent)
        cluster.wait_for_points(POINTS // 2)
        os.kill(victim, signal.SIGKILL)
        sweep.result()
    assert is_whole(read(cluster.folder / "a"))
    measured = cluster.traced()
    assert len(measured) == POINTS
    assert measured.total() - POINTS < POINTS / 10
    assert victim not in cluster.worker_pids()


def test_a_killed_client_started_again_goes_on_where_it_was(cluster):
    client = cluster.start_sleepers("b")
    cluster.wait_for_points(POINTS * 5 // 6)
    client.kill()
    client.wait()
    before = read(cluster.folder / "b")
    again = run(sweep_of(), cluster.folder / "b", cluster.address, silent)
    assert 0 < len(before) == again.found == POINTS - again.measured
    table = read(cluster.folder / "b")
    assert is_whole(table)
    assert table.loc[before["point"]].reset_index(drop=True).equals(before)


def test_a_point_that_kills_its_worker_is_one_failed_row(cluster):
    account = run(sweep_of(123), cluster.folder / "c", cluster.address, silent)
    assert (account.measured, account.failed) == (POINTS, 1)
    table = read(cluster.folder / "c")
    assert list(table["point"][table["failure"] == DIED]) == [123]
    assert set(table["failure"].drop(123)) == {""}
