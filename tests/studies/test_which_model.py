"""Which model has which property: the measures, the words, and the claims."""

import math

import pytest

from bcre_studies.validation.which_model import closures, study, thresholds
from bcre_studies.validation.which_model import properties as measured

NAMED = {subject.name: subject for subject in measured.SUBJECTS}


@pytest.mark.parametrize(
    ("name", "excess", "pulse", "expected"),
    [
        ("automaton", 2.3, 1e-6, True),
        ("automaton", 1.6, 1e-6, False),
        ("automaton", 1.0, 10.0, True),
        ("automaton of Aradian et al.", 1.0, 10.0, False),
        ("automaton of Aradian et al.", 1.6, 1.0, True),
        ("automaton of Hadeler-Kuttler", 4.0, 10.0, False),
        ("automaton, D = 0", 4.0, 10.0, False),
        ("Prigozhin-Zaltzman", 0.1, 1e-6, True),
    ],
)
def test_pulse_brings_the_top_down_or_not(name, excess, pulse, expected):
    assert measured.climbs(NAMED[name], excess, pulse) is expected


def test_least_excess_is_found_by_halving(monkeypatch):
    asked = []

    def climbs(subject, excess, pulse):
        asked.append(excess)
        return excess >= {1e-6: 2.2, 1.0: 1.5, 10.0: 9.0}[pulse]

    monkeypatch.setattr(measured, "climbs", climbs)
    assert measured.least_excesses(NAMED["BCRE"]) == [2.2, 1.5, math.inf]
    assert len(asked) < 20


@pytest.mark.parametrize("name", ["automaton", "Prigozhin-Zaltzman", "automaton, D = 0"])
def test_steep_slope_returns_to_repose_where_the_model_lets_it(name):
    final = measured.final_slope(NAMED[name], measured.STEEP, 1.0)
    assert final == pytest.approx(3.2 if name == "automaton, D = 0" else 0.0, abs=1e-3)


ROW = {
    "undisturbed": 3.2,
    "after a pulse": 0.0,
    "gentle": 0.5,
    "least, pulse 1e-06": 2.2,
    "roughness left": 0.4,
}


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({}, (measured.AFTER, "yes", measured.FRONT, "yes")),
        ({"after a pulse": 3.2}, (measured.NEVER, "yes", measured.FRONT, "yes")),
        ({"least, pulse 1e-06": math.inf}, (measured.AFTER, "yes", measured.WET, "no")),
        ({"roughness left": 0.99}, (measured.AFTER, "no", measured.FRONT, "yes")),
        (
            {"undisturbed": 0.0, "gentle": 0.0},
            (measured.ALWAYS, "yes", measured.WHOLE, "no"),
        ),
    ],
)
def test_words_follow_from_the_numbers(changes, said):
    assert tuple(measured.words(ROW | changes).values()) == said


def test_every_closure_has_a_model_and_an_automaton():
    for closure in closures.CLOSURES:
        model, rule = closures.pair(closure)
        assert rule.is_rule
        assert not model.is_rule
        assert model.changes.get("D") == rule.changes.get("D")
    assert len(study.CONTINUOUS) == len(closures.CLOSURES) == 4


def test_automaton_of_a_slope_driven_layer_differs_from_its_model_by_the_diffusion_of_its_cells():
    row = closures.profile(("Hadeler-Kuttler", "figure3"))
    assert row["difference_effective"] < 0.2 * row["difference"]


@pytest.mark.parametrize(
    ("cells", "pulse", "stands", "falls"),
    [(100, 1e-6, 1.96, 2.0), (100, 1.0, 1.25, 1.3), (400, 1.0, 1.4, 1.45), (400, 10.0, 0.98, 1.02)],
)
def test_slope_that_a_pulse_brings_down_is_steeper_on_finer_cells(cells, pulse, stands, falls):
    assert not measured.climbs(NAMED["automaton"], stands, pulse, cells)
    assert measured.climbs(NAMED["automaton"], falls, pulse, cells)


@pytest.mark.parametrize("near", [1.37, 2.9])
def test_threshold_is_found_wherever_the_coarser_grid_had_it(near):
    tried = []

    def falls(excess):
        tried.append(excess)
        return excess >= 1.377

    assert thresholds._between(falls, near) == pytest.approx(1.377, abs=thresholds.KNOWN / 2)
    assert len(tried) < (6 if near == 1.37 else 13)
