"""Faults made on purpose: the committed table holds what the tests find."""

import pandas as pd
import pytest

import faults
import fuzz
import kills
from bcre_studies.system import pickles

TABLE = pd.read_csv(faults.TABLE).to_dict("records")


@pytest.mark.parametrize("name", faults.ALONE)
def test_fault_comes_to_what_the_committed_table_says(name):
    row = faults.ALONE[name]()
    assert row == TABLE[[*faults.ALONE].index(name)]
    assert row["verdict"] == "as expected"


def test_disturbed_runs_come_to_what_the_committed_table_says():
    rows = faults.disturbed_runs()
    assert rows == TABLE[len(faults.ALONE) :]
    assert {row["verdict"] for row in rows} == {"as expected"}
    assert sum(row["fault"].startswith("run killed by") for row in rows) == faults.KILLS


@pytest.mark.parametrize("kind", fuzz.KINDS)
def test_scenes_of_every_kind_are_refused_and_none_crashes(kind):
    came = TABLE[[*fuzz.KINDS].index(kind)]["came"]
    assert "refused" in came
    assert "crashed" not in came


def test_crash_on_a_spoilt_scene_is_reported(monkeypatch):
    def crash(*_):
        raise ZeroDivisionError

    monkeypatch.setattr(faults, "load", crash)
    row = faults.spoilt_scenes("deep nesting")
    assert (row["came"], row["verdict"]) == (f"{faults.EACH} crashed", "not")


def test_damage_that_goes_unnoticed_is_reported(monkeypatch):
    monkeypatch.setattr(pickles, "load", lambda _: {})
    assert faults.damaged("empty")["verdict"] == "not"


@pytest.mark.parametrize("bad", ["half", "lost", "workers_alive", "damaged", "redone"])
def test_what_a_killed_run_spoils_is_reported(bad):
    counts = dict.fromkeys(("half", "lost", "leftovers", "workers_alive", "damaged", "redone"), 0)
    for number, verdict in ((0, "as expected"), (1, "not")):
        found = kills.Aftermath(**counts | {bad: number})
        series = kills.Series([(kills.SIGNALS[0], True, found)], equal=True, leftovers=0)
        assert faults.killed(series)[0]["verdict"] == verdict
    assert faults.killed(kills.Series([], equal=False, leftovers=0))[0]["verdict"] == "not"
    assert faults.killed(kills.Series([], equal=True, leftovers=1))[0]["verdict"] == "not"
