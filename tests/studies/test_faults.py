"""The faults that are tried on purpose: all come to what is expected, told the same every time."""

import pytest

from bcre_studies.robustness import faults, fuzz, kills
from bcre_studies.system import pickles


def test_no_spoilt_scene_crashes_and_the_count_is_the_same_every_time():
    for kind in fuzz.KINDS:
        row = faults._spoilt_scenes(kind)
        assert row["verdict"] == "as expected", row
        assert "refused" in row["came"]
    assert faults._spoilt_scenes(kind) == row


def test_crash_on_a_spoilt_scene_is_told(monkeypatch):
    def crash(*_):
        raise ZeroDivisionError

    monkeypatch.setattr(faults, "load", crash)
    row = faults._spoilt_scenes("deep nesting")
    assert (row["came"], row["verdict"]) == (f"{faults.EACH} crashed", "not")


@pytest.mark.parametrize("name", faults.DAMAGES)
def test_every_damage_to_a_stored_result_is_noticed(name):
    assert faults._damaged(name)["verdict"] == "as expected"


def test_damage_that_goes_unnoticed_is_told(monkeypatch):
    monkeypatch.setattr(pickles, "load", lambda _: {})
    assert faults._damaged("empty")["verdict"] == "not"


@pytest.mark.parametrize("fault", ["full", "forbidden"])
def test_disk_that_is_full_and_folder_that_is_closed_leave_the_old_file(fault):
    assert faults._unwritable(fault)["verdict"] == "as expected"


@pytest.mark.parametrize("bad", ["half", "lost", "workers_alive", "damaged", "redone"])
def test_what_a_killed_run_spoils_is_told(bad):
    counts = dict.fromkeys(("half", "lost", "leftovers", "workers_alive", "damaged", "redone"), 0)
    for number, verdict in ((0, "as expected"), (1, "not")):
        found = kills.Aftermath(**counts | {bad: number})
        series = kills.Series([(kills.SIGNALS[0], True, found)], equal=True, leftovers=0)
        assert faults._killed(series)[0]["verdict"] == verdict
    assert faults._killed(kills.Series([], equal=False, leftovers=0))[0]["verdict"] == "not"
    assert faults._killed(kills.Series([], equal=True, leftovers=1))[0]["verdict"] == "not"
