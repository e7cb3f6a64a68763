"""What is timed against each other computes the same."""

import numpy as np
import pytest

from bcre_studies.performance.record import specialisation as study


@pytest.mark.parametrize("term", study.TERMS)
def test_term_that_is_present_but_tiny_changes_no_bit(term, monkeypatch):
    monkeypatch.setattr(study, "CELL_STEPS", 20_000)
    with_term, without = (call() for call in study._pair(term, 200))
    assert np.array_equal(with_term[0], without[0])
    assert np.array_equal(with_term[1], without[1])
    _, R = study._layers(200)
    assert not np.array_equal(without[1], R)


def test_every_term_is_timed_on_every_number_of_cells(monkeypatch):
    monkeypatch.setattr(study, "CELL_STEPS", 2_000)
    monkeypatch.setattr(study, "CELLS", (20, 40))
    table = study.specialisation_gains()
    assert list(table.columns) == ["term", "cells", "ratio"]
    assert len(table) == 2 * 5
    assert (table["ratio"] > 0).all()
    assert set(study.recorded().columns) == set(table.columns)
