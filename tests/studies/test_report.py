"""The reports: the same bytes every time, nothing half-written, text as text, ``bcre check``."""

import hashlib
import os
import shutil
import subprocess
import sys
from importlib.machinery import ModuleSpec
from pathlib import Path
from types import ModuleType

import numpy as np
import pandas as pd
import pytest

from bcre_studies import catalog
from bcre_studies.comparison.claim import Claim, quality_check
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.models.registry import AUTOMATON
from bcre_studies.publishing import finding, store, write
from bcre_studies.reporting import pages, style
from bcre_studies.system import files
from bcre_studies.system.files import replace_bytes, replace_file, replace_text


@pytest.fixture
def places(tmp_path, monkeypatch):
    """Reports and store in a temporary folder."""
    monkeypatch.setattr(files, "REPORTS", tmp_path / "reports")
    monkeypatch.setattr(write, "REPORTS", tmp_path / "reports")
    monkeypatch.setattr(store, "CACHE", tmp_path / "cache")
    return tmp_path


TITLE = "A study <of> [no] substance"


class Fake(ModuleType):
    """A study of no substance that counts how often it is run."""

    def __init__(self):
        super().__init__("bcre_studies.fake", "Measures nothing, <i>by</i> R -> 0 & no equation.")
        self.__spec__ = ModuleSpec(self.__name__, None)
        self.runs = 0
        self.claims = [claim("first", Verdict.AGREE), claim("second", Verdict.DISAGREE)]

    def run(self):
        self.runs += 1
        rows = {"case": ["a", "b|c"], "count": [1, 2], "value": [1 / 3, np.nan], "note": ["", None]}
        return {"comparison": pd.DataFrame(rows), "curve": pd.DataFrame({"x": [0.123456789]})}

    def judge(self, tables):
        assert set(tables) == {"comparison", "curve"}
        return self.claims

    def draw(self, tables):
        figure, (axis,) = style.panels(1, 1)
        axis.plot([0, 1], tables["curve"]["x"].tolist() * 2, **AUTOMATON.line)
        style.legend(figure, [AUTOMATON])
        return figure


def claim(name, verdict, evidence="1 < 2", statement="It holds."):
    return Claim(name, statement, verdict, evidence, "a tenth: made up")


def pages_of_titles(findings, decided, folder):
    """In place of the report's pages, which tell of the real studies (``tests/page``)."""
    for name in ("README.md", "index.html"):
        replace_text(folder / name, "".join(finding.title for finding in findings))


@pytest.fixture
def fake(places, monkeypatch):
    """The only study there is."""
    module = Fake()
    studies = {"fake": catalog.Entry("fake", TITLE)}
    monkeypatch.setitem(sys.modules, "bcre_studies.fake", module)
    for place in (catalog, finding, store, write):
        monkeypatch.setattr(place, "STUDIES", studies)
    monkeypatch.setattr(write, "PAPER_CLAIMS", ())
    monkeypatch.setattr(write, "write_pages", pages_of_titles)
    return module


@pytest.fixture
def bcre(run_bcre):
    return run_bcre


def contents(folder):
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(Path(folder).rglob("*"))
        if path.is_file()
    }


# The same bytes


def test_study_written_twice_fresh_or_from_the_store_gives_the_same_bytes(places, monkeypatch):
    monkeypatch.setenv("LOKY_MAX_CPU_COUNT", "1")
    seen = []
    for fresh in (True, False, True):
        if fresh:
            shutil.rmtree(places / "cache", ignore_errors=True)
        write.write_study(finding.find("printed_rule"))
        seen.append(contents(places / "reports"))
        shutil.rmtree(places / "reports")
    assert seen[0] == seen[1] == seen[2]
    assert set(seen[0]) == {
        "printed_rule/README.md",
        "printed_rule/comparison.csv",
        "printed_rule/figure.svg",
    }


def test_another_process_with_another_hash_seed_writes_the_same_bytes(places):
    write.write_study(finding.find("printed_rule"))
    here = contents(places / "reports")
    script = (
        "from pathlib import Path; from bcre_studies.publishing import finding, store, write\n"
        "write.REPORTS, store.CACHE = Path('other'), Path('store')\n"
        "write.write_study(finding.find('printed_rule'))"
    )
    environment = os.environ | {"PYTHONHASHSEED": "77", "TZ": "Asia/Tokyo"}
    environment["LOKY_MAX_CPU_COUNT"] = "1"
    subprocess.run([sys.executable, "-c", script], cwd=places, env=environment, check=True)
    assert contents(places / "other") == here


def test_index_written_twice_gives_the_same_bytes(fake, places):
    write.write_all()
    first = contents(places / "reports")
    shutil.rmtree(places / "reports")
    write.write_all()
    assert contents(places / "reports") == first
    assert {"README.md", "index.html", "verdicts.csv", "fake/curve.csv"} <= set(first)
    assert fake.runs == 1


def test_no_file_of_a_report_bears_a_time(fake, places):
    write.write_all()
    svg = (places / "reports/fake/figure.svg").read_text(encoding="utf-8")
    assert "<dc:date>" not in svg


# The store


def test_stored_tables_are_those_that_were_measured_to_five_digits(fake):
    first, second = store.tables_of("fake"), store.tables_of("fake")
    assert fake.runs == 1
    for key in ("comparison", "curve"):
        pd.testing.assert_frame_equal(first[key], second[key])
    assert first["comparison"]["value"][0] == 0.33333
    assert first["comparison"]["count"].tolist() == [1, 2]
    assert first["curve"]["x"][0] == 0.12346


@pytest.mark.parametrize(
    "damage",
    [
        lambda content: b"",
        lambda content: content[:20],
        lambda content: content[: len(content) // 2],
        lambda content: content[:-1],
        lambda content: content + b"\x00",
        lambda content: bytes([content[0] ^ 1]) + content[1:],
        lambda content: content[:40] + bytes([content[40] ^ 128]) + content[41:],
        lambda content: content[:-1] + bytes([content[-1] ^ 4]),
    ],
)
def test_stored_result_that_is_damaged_is_noticed_and_redone(fake, places, damage):
    expected = store.tables_of("fake")
    (path,) = (places / "cache").glob("*.pickle")
    whole = path.read_bytes()
    path.write_bytes(damage(whole))
    again = store.tables_of("fake")
    assert fake.runs == 2
    pd.testing.assert_frame_equal(again["comparison"], expected["comparison"])
    assert path.read_bytes() == whole
    store.tables_of("fake")
    assert fake.runs == 2


def test_study_that_fails_leaves_nothing_in_the_store(fake, places, monkeypatch):
    def fail():
        raise RuntimeError("no")

    monkeypatch.setattr(fake, "run", fail)
    with pytest.raises(RuntimeError, match="no"):
        store.tables_of("fake")
    assert [path.name for path in (places / "cache").iterdir()] == ["fake.lock"]


# Whole or not at all


def test_file_is_left_as_it_was_when_writing_fails_half_way(tmp_path):
    path = tmp_path / "a.txt"
    replace_text(path, "old")

    def half(temporary):
        temporary.write_text("ne", encoding="utf-8")
        raise OSError("disk full")

    with pytest.raises(OSError, match="disk full"):
        replace_file(path, half)
    assert path.read_text(encoding="utf-8") == "old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.txt"]


def test_file_that_is_interrupted_before_it_was_there_does_not_come_to_be(tmp_path):
    def interrupt(temporary):
        temporary.write_bytes(b"half")
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        replace_file(tmp_path / "new/a.txt", interrupt)
    assert list((tmp_path / "new").iterdir()) == []


def test_old_file_is_there_until_the_new_one_is_whole(tmp_path):
    path = tmp_path / "a.txt"
    replace_bytes(path, b"old")

    def write_new(temporary):
        temporary.write_bytes(b"new")
        assert path.read_bytes() == b"old"
        assert temporary.parent == path.parent

    replace_file(path, write_new)
    assert path.read_bytes() == b"new"
    assert path.stat().st_mode & 0o777 == 0o644


def test_text_is_written_as_utf_8_with_its_line_ends(tmp_path):
    replace_text(tmp_path / "deep/er/a.txt", "κ = γ d/2\n")
    assert (tmp_path / "deep/er/a.txt").read_bytes() == "κ = γ d/2\n".encode()


# Texts and tables


def test_cell_with_a_bar_stays_one_cell_of_its_markdown_table(fake):
    rows = finding.find("fake").comparison.splitlines()
    bars = {row.replace(r"\|", "").count("|") for row in rows}
    assert bars == {5}


def test_numbers_are_shown_short_and_gaps_empty():
    table = pd.DataFrame({"a_b": [1 / 3, np.nan], "n": [3, 4], "t": [None, True]})
    shown = pages.readable(table)
    assert list(shown.columns) == ["a b", "n", "t"]
    assert shown["a b"].tolist() == ["0.333333", ""]
    assert shown["n"].tolist() == ["3", "4"]
    assert shown["t"].tolist() == ["", "True"]


def test_page_of_a_study_has_its_claims_tolerances_text_numbers_and_command(fake, places):
    write.write_study(finding.find("fake"))
    page = (places / "reports/fake/README.md").read_text(encoding="utf-8")
    for word in (TITLE, "It holds.", "a tenth: made up", "figure.svg", "`bcre study fake`"):
        assert word in page
    assert "0.33333" in page
    assert "[`curve.csv`](curve.csv)" in page
    table = pd.read_csv(places / "reports/fake/comparison.csv")
    assert table["value"].tolist()[0] == 0.33333


# Verdicts and bcre check


def test_verdict_table_has_one_row_a_claim(fake):
    table = write.verdict_table([finding.find("fake")])
    assert table.to_dict("list") == {
        "study": ["fake", "fake"],
        "claim": ["first", "second"],
        "verdict": ["agree", "disagree"],
    }


def test_quality_checks_leave_the_verdict_matrix_but_are_still_checked(fake, bcre, places):
    fake.claims.append(quality_check("code", "It compiles.", Verdict.AGREE, "1 of 1", "none"))
    bcre("report")
    verdicts, checks = (
        pd.read_csv(places / "reports" / name)["claim"].tolist()
        for name in ("verdicts.csv", "quality/verdicts.csv")
    )
    assert (verdicts, checks) == (["first", "second"], ["code"])
    fake.claims[-1] = quality_check("code", "It compiles.", Verdict.DISAGREE, "0 of 1", "none")
    code, out, _ = bcre("check")
    assert code == 1
    assert "code: disagree, recorded as: agree" in out


def test_check_after_report_finds_nothing_that_differs(fake, bcre):
    fake.claims.append(claim("NA", Verdict.UNRESOLVED))
    assert bcre("report")[0] == 0
    code, out, err = bcre("check")
    assert (code, err) == (0, "")
    assert "fake: first: agree\n" in out
    assert "fake: second: disagree\n" in out
    assert "fake: NA: unresolved\n" in out
    assert "3 claims, 0 differ" in out


@pytest.mark.parametrize(
    ("now", "line"),
    [
        ([("first", "AGREE"), ("second", "AGREE")], "second: agree, recorded as: disagree"),
        ([("first", "UNRESOLVED"), ("second", "DISAGREE")], "unresolved, recorded as: agree"),
        ([("first", "AGREE")], "second: (none), recorded as: disagree"),
        (
            [("first", "AGREE"), ("second", "DISAGREE"), ("third", "AGREE")],
            "third: agree, recorded as: (none)",
        ),
    ],
)
def test_check_ends_with_1_where_a_verdict_differs_from_the_recorded_one(fake, bcre, now, line):
    bcre("report")
    fake.claims = [claim(name, Verdict[verdict]) for name, verdict in now]
    code, out, _ = bcre("check")
    assert code == 1
    assert line in out
    assert ", 1 differ" in out


def test_check_changes_no_file(fake, bcre, places):
    bcre("report")
    before = contents(places)
    fake.claims = [claim("first", Verdict.DISAGREE)]
    bcre("check")
    assert contents(places) == before


@pytest.mark.parametrize("text", [None, "", "a,b\n1,2\n", "study,claim\nfake,first\n"])
def test_check_without_readable_verdicts_is_refused_in_one_line(fake, bcre, places, text):
    bcre("report")
    path = places / "reports/verdicts.csv"
    path.unlink()
    if text is not None:
        path.write_text(text, encoding="utf-8")
    code, out, err = bcre("check")
    assert (code, out) == (2, "")
    assert len(err.splitlines()) == 1
    assert "verdicts.csv" in err


def test_study_writes_its_report_and_prints_its_conclusions(fake, bcre, places):
    code, out, _ = bcre("study", "fake")
    assert code == 0
    assert "fake: It holds. agree: 1 < 2." in out
    assert sorted(path.name for path in (places / "reports").iterdir()) == ["fake"]


def test_recorded_verdicts_are_of_the_four_words_and_each_claim_stands_once():
    table = write.recorded_verdicts()
    assert not table.duplicated(["study", "claim"]).any()
    assert set(table["verdict"]) <= set(map(str, Verdict))
    assert set(table["study"]) <= set(catalog.STUDIES)
