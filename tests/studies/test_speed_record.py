"""The record of speed: what is read from a race, and how it is kept."""

import math

import numpy as np
import pandas as pd
import pytest

from bcre_studies.performance.record import contest, record
from bcre_studies.performance.rivals.rivals import EndState

OURS = "automaton, upwind"


def raced(**contenders):
    """A race on one scene; each contender gives (cells, error, seconds) from grid to grid."""
    return pd.DataFrame(
        [
            {"scene": "s", "contender": name, "cells": cells, "error_R": error, "median_s": seconds}
            for name, grids in contenders.items()
            for cells, error, seconds in grids
        ]
    )


def reached(target, **contenders):
    rows = record.reach(raced(**contenders))
    if rows.empty:
        return rows
    return rows[rows["error"] == target].set_index("contender")


def test_cheapest_grid_that_meets_the_error_is_picked_even_if_it_is_not_the_coarsest():
    found = reached(0.1, **{OURS: [(50, 0.2, 1.0), (100, 0.1, 5.0), (200, 0.05, 3.0)]}).loc[OURS]
    assert (found["cells"], found["seconds"]) == (200, 3.0)
    assert not found["at_least"]
    assert found["winner"]


def test_contender_that_reaches_an_error_on_no_grid_has_no_row_for_it():
    race = {OURS: [(50, 0.2, 1.0), (100, 0.02, 4.0)], "PDE": [(50, 0.5, 1.0), (100, 0.05, 2.0)]}
    assert set(reached(0.1, **race).index) == {OURS, "PDE"}
    assert set(reached(0.03, **race).index) == {OURS}
    assert reached(0.001, **race).empty


def test_times_are_told_against_the_papers_rule_and_the_shortest_wins():
    race = {OURS: [(50, 0.2, 1.0), (100, 0.09, 6.0)], "PDE": [(50, 0.01, 2.0)]}
    found = reached(0.1, **race)
    assert found["to_automaton"].to_dict() == {OURS: 1.0, "PDE": pytest.approx(1 / 3)}
    assert found["winner"].to_dict() == {OURS: False, "PDE": True}
    assert (found["automaton_s"] == 6.0).all()


def test_papers_rule_that_is_too_coarse_is_given_the_least_time_that_first_order_allows():
    """From an error of 0.2 to one of 0.03: 0.2/0.03 as many cells, and as many more steps."""
    race = {OURS: [(50, 0.4, 1.0), (100, 0.2, 4.0)], "PDE": [(50, 0.02, 2.0)]}
    found = reached(0.03, **race).loc["PDE"]
    assert found["at_least"]
    assert found["automaton_s"] == pytest.approx(4.0 * (0.2 / 0.03) ** 2, rel=1e-12)
    assert found["to_automaton"] == pytest.approx(2.0 / found["automaton_s"], rel=1e-12)


def test_papers_rule_that_gets_worse_never_reaches_it():
    race = {OURS: [(50, 0.2, 1.0), (100, 0.3, 4.0)], "PDE": [(50, 0.02, 2.0)]}
    found = reached(0.03, **race).loc["PDE"]
    assert pd.isna(found["automaton_s"])
    assert pd.isna(found["to_automaton"])
    assert found["at_least"]


def test_scenes_are_judged_apart():
    one = raced(**{OURS: [(50, 0.05, 1.0), (100, 0.02, 4.0)]})
    other = raced(**{OURS: [(50, 0.5, 1.0), (100, 0.09, 7.0)]}).assign(scene="t")
    found = record.reach(pd.concat([one, other]))
    at = found[found["error"] == 0.1].set_index("scene")
    assert at["seconds"].to_dict() == {"s": 1.0, "t": 7.0}
    assert at["automaton_s"].to_dict() == {"s": 1.0, "t": 7.0}


def test_record_written_and_read_is_the_same_to_three_digits(tmp_path):
    tables = {
        "machine": pd.DataFrame({"what": ["cores", "processor"], "which": ["2", "a, b"]}),
        "reach": pd.DataFrame(
            {"scene": ["s", "t"], "seconds": [0.00123456, math.inf], "cells": [100, 1234567]}
        ),
        "contest": pd.DataFrame({"error_R": [1.0, 0.0999999], "winner": [True, False]}),
    }
    record.write(tables, tmp_path)
    found = record.read(tmp_path)
    assert list(found) == ["contest", "machine", "reach"]
    assert found["reach"]["seconds"].tolist() == [0.00123, math.inf]
    assert found["reach"]["cells"].tolist() == [100, 1234567]
    assert found["contest"]["error_R"].tolist() == [1.0, 0.1]
    assert found["contest"]["winner"].tolist() == [True, False]
    assert found["machine"]["which"].tolist() == ["2", "a, b"]
    assert tables["reach"]["seconds"][0] == 0.00123456
    first = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    record.write(found, tmp_path)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == first


def test_where_no_record_was_written_there_is_none(tmp_path):
    assert record.read(tmp_path / "nowhere") == {}


def test_race_times_every_grid_of_every_contender_that_enters():
    def prepare(scene, cells):
        x = scene.centres(cells)
        h, R = scene.initial(x)
        return lambda: EndState(x, h, R, 3, cells)

    contenders = (
        contest.Contender("everywhere", prepare, 25, 2500.0),
        contest.Contender("elsewhere", prepare, 25, 2500.0, only=("figure 2",)),
    )
    found = record.race(contenders, (contest.WAVE,))
    assert found["contender"].tolist() == ["everywhere", "everywhere"]
    assert found["cells"].tolist() == [25, 50]
    assert found["cell_steps"].tolist() == [625, 2500]
    assert (found["scene"] == contest.WAVE).all()
    assert (found["error_R"] > 0).all()
    assert np.isfinite(found["median_s"]).all()
    assert found.notna().all().all()
