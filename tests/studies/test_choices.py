"""Our own choices halved and doubled: what each changes, and that a verdict that turns is told."""

import pandas as pd
import pytest

from bcre_studies.comparison.verdict import Verdict
from bcre_studies.models.automaton import rule_of
from bcre_studies.scenes.scene import load
from bcre_studies.validation import choices as study


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_each_choice_changes_what_it_names_and_nothing_else(factor):
    scene = load("figure1").with_changes(step=0.4)
    found = {choice: study.changed(scene, choice, factor) for choice in study.CHOICES}
    assert found["L"].domain.length == 100 * factor
    assert found["L"].d == found["d = dt"].d / factor == 1
    assert found["N"].domain.length == 100
    assert found["N"].d == 1 / factor
    assert study._slope(found["Sc"]) - found["Sc"].material.Sc == pytest.approx(3.2)
    assert study._slope(found["S0 - Sc"]) - 0.5 == pytest.approx(3.2 * factor)
    assert found["width"].rolling[0].width == 3 * factor
    assert found["place"].rolling[0].centre == 100 - 15 * factor
    for choice in ("N", "d = dt"):
        rule = rule_of(found[choice])
        assert rule.v * rule.dt / rule.d == pytest.approx(0.04)
    assert found["scale of h"].material.gamma == 0.01 / factor


def test_a_choice_that_a_scene_does_not_have_or_cannot_hold_is_not_posed():
    assert study.changed(load("figure3"), "place", 2.0) is None
    assert study.changed(load("rough_slope"), "width", 2.0) is None
    assert study._word(("roughness of the surface", "N", 0.5)) == study.NOT_POSED


@pytest.mark.parametrize("factor", [0.5, 2.0])
@pytest.mark.parametrize("name", ["figure 2, R", "one small avalanche above repose"])
def test_the_unit_of_height_and_the_tilt_change_no_verdict(name, factor):
    stands = study._word((name, "", 1.0))
    assert study._word((name, "scale of h", factor)) == stands
    assert study._word((name, "Sc", factor)) == stands


def test_Sd_is_explained_by_cell_size_up_to_a_cell_peclet_number_of_one():
    words = [study._word(("second critical slope at figure 1", "N", f)) for f in (0.5, 1.0, 2.0)]
    assert words == ["disagree", "explained by cell size", "explained by cell size"]


def made_up(doubled):
    common = {"verdict on": "figure 9", "as it stands": "agree", "halved": "agree"}
    words = [doubled] + ["agree"] * (len(study.CHOICES) - 2) + ["-"]
    rows = [
        common | {"choice": choice, "doubled": word}
        for choice, word in zip(study.CHOICES, words, strict=True)
    ]
    return {"comparison": pd.DataFrame(rows)}


@pytest.mark.parametrize(
    ("doubled", "verdict"),
    [("agree", "agree"), ("disagree", "disagree"), ("unresolved", "unresolved")],
)
def test_a_verdict_that_turns_is_said_with_the_choice_that_turns_it(doubled, verdict):
    (claim,) = study.judge(made_up(doubled))
    assert claim.verdict is Verdict(verdict)
    assert ("it turns" in claim.evidence.lower()) == (verdict != "agree")
    assert (f"L doubled: {doubled}" in claim.evidence) == (verdict != "agree")
    assert "of 15" in claim.evidence
