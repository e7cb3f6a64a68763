"""What cannot end well is refused before it costs anything."""

from pathlib import Path
from types import SimpleNamespace

import matplotlib as mpl
import pandas as pd
import pytest

from bcre_studies.performance.record import record
from bcre_studies.publishing import store, write
from bcre_studies.reporting import style


@pytest.fixture
def closed(tmp_path):
    """A place below which nothing can be written, not even by root."""
    (tmp_path / "file").write_text("")
    return tmp_path / "file/below"


@pytest.mark.parametrize(("option", "place"), [((), "LOCAL"), (("--record",), "RECORD")])
def test_speed_that_could_not_be_written_is_not_measured(bcre, monkeypatch, closed, option, place):
    for measure in ("measure_local", "measure_record"):
        monkeypatch.setattr(record, measure, lambda: pytest.fail("measured"))
    monkeypatch.setattr(record, place, closed)
    ended = bcre("speed", *option)
    assert ended.code == 2
    told = ended.err.splitlines()[-1]
    assert told.startswith(f"bcre: reports/{closed.name} = ")
    assert "must be a folder that can be written" in told


def test_study_that_could_not_be_written_is_not_measured(bcre, monkeypatch, tmp_path):
    (tmp_path / "reports").mkdir()
    (tmp_path / "reports/printed_rule").write_text("a file")
    monkeypatch.setattr(write, "REPORTS", tmp_path / "reports")
    monkeypatch.setattr(write, "find", lambda _: pytest.fail("measured"))
    told = bcre("study", "stability", "printed_rule").refusal
    assert told.startswith("reports = ")
    assert "printed_rule must be a folder that can be written" in told


def test_tables_are_measured_where_they_cannot_be_kept(monkeypatch, closed):
    tables = {"comparison": pd.DataFrame({"value": [1 / 3]})}
    monkeypatch.setattr(store, "CACHE", closed)
    monkeypatch.setattr(store, "study", lambda _: SimpleNamespace(run=lambda: tables))
    assert store.tables_of("printed_rule")["comparison"]["value"].tolist() == [0.33333]
    assert Path(closed.parent).read_text() == ""


def test_look_of_a_figure_is_not_the_users():
    def drawn():
        figure, (axis,) = style.panels(1, 1)
        axis.plot([0, 1], [1, 0], label="a")
        axis.legend()
        return style.svg_of(figure)

    expected = drawn()
    with mpl.rc_context():
        mpl.rcParams.update(
            {
                "axes.facecolor": "black",
                "lines.dashed_pattern": [1, 1],
                "font.family": "monospace",
                "axes.formatter.use_locale": True,
                "savefig.facecolor": "red",
                "savefig.bbox": "tight",
                "svg.image_inline": False,
                "xtick.direction": "in",
            }
        )
        assert drawn() == expected
