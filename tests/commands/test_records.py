"""Installed as a wheel and run elsewhere, or without reports/: what is needed is there, or said."""

import fnmatch
import zipfile
from pathlib import Path

import pandas as pd
import pytest
from hatchling.builders.wheel import WheelBuilder

import bcre_studies
from bcre_studies import catalog
from bcre_studies.advisor import advice_text
from bcre_studies.performance import scaling
from bcre_studies.performance.record import specialisation
from bcre_studies.performance.record.record import recorded as recorded_tables
from bcre_studies.performance.scene_needs import claims as claims_of_needs
from bcre_studies.publishing import write
from bcre_studies.system import files, records, sources
from bcre_studies.timing import costs

PROJECT = Path(__file__).parents[2]
PACKAGE = Path(bcre_studies.__file__).parent


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """The folder of ``bcre_studies`` as a wheel of this project installs it."""
    folder = tmp_path_factory.mktemp("wheel")
    (built,) = WheelBuilder(str(PROJECT)).build(directory=str(folder))
    with zipfile.ZipFile(built) as archive:
        archive.extractall(folder)
    return folder / "bcre_studies"


@pytest.fixture
def elsewhere(bcre, monkeypatch, tmp_path, wheel):
    """The command as a wheel has it, started where there is no repository."""
    monkeypatch.setattr(files, "REPORTS", tmp_path / "reports")
    monkeypatch.setattr(records, "SHIPPED", wheel / "recorded")
    return bcre


@pytest.fixture
def without(bcre, monkeypatch, tmp_path):
    """The command in a checkout whose ``reports/`` is gone."""
    monkeypatch.setattr(files, "REPORTS", tmp_path / "reports")
    monkeypatch.setattr(write, "REPORTS", tmp_path / "reports")
    return bcre


def test_wheel_holds_every_file_of_the_package_that_is_no_cache(wheel):
    own = {path.relative_to(PACKAGE) for path in PACKAGE.rglob("*") if path.is_file()}
    own = {path for path in own if "__pycache__" not in path.parts}
    assert own <= {path.relative_to(wheel) for path in wheel.rglob("*") if path.is_file()}


@pytest.mark.parametrize("name", catalog.STUDIES)
def test_wheel_holds_every_record_that_a_study_reads(wheel, name):
    _, patterns = sources._modules(f"bcre_studies.{catalog.STUDIES[name].module}")
    for path in (PROJECT / "reports").rglob("*.csv"):
        below = path.relative_to(PROJECT / "reports")
        if any(fnmatch.fnmatch(below.as_posix(), pattern) for pattern in patterns):
            assert (wheel / "recorded" / below).read_bytes() == path.read_bytes()


def test_installed_elsewhere_the_same_is_recorded(elsewhere):
    here = PROJECT / "reports"
    for read, name in ((costs.recorded().table, "costs"), (specialisation.recorded(), None)):
        name = name or "specialisation"
        assert read.equals(pd.read_csv(here / f"speed/{name}.csv"))
    assert scaling.run()["comparison"].equals(pd.read_csv(here / "speed/ratios.csv"))
    expected = pd.concat([pd.read_csv(here / name) for name in write.VERDICTS])
    assert write.recorded_verdicts().to_csv() == expected.reset_index(drop=True).to_csv()
    for entry in catalog.STUDIES.values():
        sources.require_records(f"bcre_studies.{entry.module}")


def test_no_verdict_changes_for_want_of_a_record(without):
    assert records.recorded("speed/*.csv") == []
    with pytest.raises(FileNotFoundError, match=r"speed/specialisation\.csv: missing"):
        claims_of_needs._specialised_claim()
    with pytest.raises(FileNotFoundError, match=r"speed/costs\.csv: missing"):
        costs.recorded()


@pytest.mark.parametrize("name", ["advice", "scaling", "scene_needs", "speed_error"])
def test_study_that_lacks_its_record_says_so_before_anything_is_measured(
    without, monkeypatch, name
):
    monkeypatch.setattr(write, "find", lambda _: pytest.fail("measured"))
    told = without("study", "printed_rule", name).refusal
    assert "reports/speed/" in told
    assert "missing; `bcre speed --record` writes it" in told
    assert [*Path().iterdir()] == []


def test_check_that_lacks_the_verdicts_says_so_before_anything_is_measured(without):
    told = without("check").refusal
    assert "reports/verdicts.csv: missing; `bcre report` writes it" in told


def test_advice_without_a_record_measures_what_runs_cost(without, monkeypatch):
    measured = pd.read_csv(PROJECT / "reports/speed/costs.csv")
    monkeypatch.setattr(advice_text, "measure", lambda: measured)
    monkeypatch.setattr(
        advice_text, "advise_with_reference", lambda _, effort: used.append(effort.costs)
    )
    monkeypatch.setattr(advice_text, "write_advised", lambda *_: None)
    monkeypatch.setattr(advice_text, "text", lambda *_: "advised")
    used = []
    ended = without("advise", "figure2")
    assert (ended.code, ended.out) == (0, "advised\n")
    assert used[0].table is measured
    assert "reports/speed/costs.csv: missing" in ended.err
    assert "measured now" in ended.err


def test_record_of_the_place_goes_before_the_shipped_one(elsewhere, tmp_path):
    (tmp_path / "reports/speed").mkdir(parents=True)
    (tmp_path / "reports/speed/costs.csv").write_text("mine")
    shipped = {path.name for path in records.SHIPPED.glob("speed/*.csv")}
    found = records.recorded("speed/*.csv")
    assert {path.name for path in found} == shipped
    assert [path.read_text() for path in found if path.name == "costs.csv"] == ["mine"]
    assert recorded_tables("advice")
