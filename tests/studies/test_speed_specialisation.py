"""What is timed against each other computes the same."""

import numpy as np
import pytest

import bcre_ca
from bcre_studies.speed import specialisation as study


@pytest.mark.parametrize("term", study.IN_THE_AUTOMATON)
def test_term_that_is_present_but_tiny_changes_no_bit(term, monkeypatch):
    monkeypatch.setattr(study, "CELL_STEPS", 20_000)
    with_term, without = (call() for call in study._pair(term, 200))
    assert np.array_equal(with_term[0], without[0])
    assert np.array_equal(with_term[1], without[1])
    _, R = study._layers(200)
    assert not np.array_equal(without[1], R)


def test_sweep_without_diffusion_is_the_automaton_with_D_zero():
    h, R = study._layers(100)
    rule = bcre_ca.Rule(v=0.1, D=0.0, gamma=0.01, Sc=0.5, d=1.0, dt=0.5)
    K = rule.coefficients()
    swept = []
    for b in (0.0, None):
        layers = h.copy(), R.copy()
        study._sweep(*layers, K.c, b, K.k, K.s, 20)
        swept.append(layers)
    expected = bcre_ca.evolve(h, R, rule, 20)
    assert np.array_equal(swept[0], swept[1])
    assert np.allclose(swept[0][0][:70], expected[0][:70], rtol=0, atol=1e-13)
    assert np.allclose(swept[0][1][:70], expected[1][:70], rtol=0, atol=1e-13)


def test_every_term_is_timed_on_every_number_of_cells(monkeypatch):
    monkeypatch.setattr(study, "CELL_STEPS", 2_000)
    monkeypatch.setattr(study, "CELLS", (20, 40))
    table = study.specialisation_gains()
    assert list(table.columns) == ["term", "cells", "ratio"]
    assert len(table) == 2 * 5
    assert (table["ratio"] > 0).all()
    assert set(study.recorded().columns) == set(table.columns)
