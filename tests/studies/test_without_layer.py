"""The isotonic step is offered where it meets the request, at the stated error, and not else."""

import math

import numpy as np
import pytest

from bcre_studies.advisor.advice_text import text
from bcre_studies.advisor.advise import Effort, advise
from bcre_studies.advisor.deviation import deviation
from bcre_studies.advisor.pilot import Reference, run_model
from bcre_studies.advisor.question import Question
from bcre_studies.advisor.without_layer import without_layer
from bcre_studies.models.registry import AUTOMATON, QUASI_STATIC
from bcre_studies.models.run import frame_times
from bcre_studies.observables.rolling_share import surface_error
from bcre_studies.scenes.scene import Scene, load
from bcre_studies.timing.costs import recorded

SLOW_HEAP = {
    "title": "A heap that is poured slowly against a wall",
    "material": {"v": 2.0, "D": 0.0, "gamma": 4.0, "Sc": 0.5},
    "domain": {"length": 200.0, "cells": 80, "ends": "wall"},
    "time": {"until": 2500.0},
    "surface": [{"kind": "incline", "slope": 0.0}],
    "source": [{"rate": 1.0, "place": 1.25, "width": 2.5}],
}
"""eps = tau = 0.01 at the end."""


def heap(**changes):
    return Scene.model_validate(SLOW_HEAP).with_changes(**changes)


def advised(scene, observable="h", tolerance=0.05):
    return advise(
        Question(scene, tolerance, observable), Effort(recorded(), clocked=False, seconds=3.0)
    )


def against(scene, error=0.0):
    """A reference that is the automaton's own run."""
    run = AUTOMATON.run(scene, frame_times(scene, 11))
    return Reference((run,), error)


@pytest.mark.parametrize("observable", ["h", "slope"])
def test_slow_heap_is_offered_the_isotonic_step_at_an_error_that_a_finer_bcre_confirms(observable):
    scene = heap()
    advice = advised(scene, observable)
    found = advice.without_layer
    assert (found.eps, found.tau) == pytest.approx((0.01, 0.01), rel=0.1)
    question = advice.question
    fine = run_model(scene, "pde", question.times, 200)
    run = QUASI_STATIC.run(scene, question.times)
    true = max(deviation(run, fine, observable), surface_error(run, fine))
    assert found.error == pytest.approx(true, rel=0.05)
    assert true <= 0.05
    assert found.seconds > 0
    told = text(advice, "heap", __file__)
    assert "no layer:       Prigozhin-Zaltzman, isotonic steps on 80 cells: error 1.9 %" in told
    assert "automaton, calibrated: automaton.scheme = 'calibrated': must be 'upwind'" in told


@pytest.mark.parametrize(
    ("changes", "observable"),
    [
        ({"gamma": 0.1}, "h"),  # eps = 0.4
        ({"v": 0.1, "gamma": 0.2}, "h"),  # tau = 0.2
        ({}, "R"),
        ({}, "front"),
    ],
    ids=["slow exchange", "thick layer", "of the layer", "of its front"],
)
def test_heap_that_needs_its_layer_is_not(changes, observable):
    scene = heap(**changes)
    reference = against(scene)
    assert without_layer(Question(heap(), 0.05, "h"), against(heap())) is not None
    assert without_layer(Question(scene, 0.05, observable), reference) is None


def test_tolerance_below_the_error_and_its_own_uncertainty_is_not_met():
    scene = heap()
    error = without_layer(Question(scene, 0.05, "h"), against(scene)).error
    for own, tolerance, offered in ((0.0, 1.01, True), (0.0, 0.99, False), (0.02, 1.01, False)):
        question = Question(scene, tolerance * error, "h")
        assert (without_layer(question, against(scene, own * error)) is not None) is offered


def test_joined_ends_and_figures_of_the_paper_are_not_offered_it():
    assert (
        without_layer(Question(load("rough_slope"), 0.9, "h"), against(load("rough_slope"))) is None
    )
    assert advised(load("figure2")).without_layer is None


def test_same_rest_in_the_end_is_not_enough():
    scene = load("figure1").with_changes(until=2000.0)
    reference = against(scene)
    run = QUASI_STATIC.run(scene, frame_times(scene, 11))
    assert deviation(run, reference.run, "h") < 0.05
    assert math.isfinite(surface_error(run, reference.run))
    assert without_layer(Question(scene, 0.05, "h"), reference) is None
    assert np.all(run.R == 0)
