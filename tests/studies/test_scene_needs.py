"""What a scene needs: each ingredient alone, together, and the smallest model that holds."""

import math

import numpy as np
import pandas as pd
import pytest

from bcre_studies.comparison.verdict import Verdict
from bcre_studies.models.automaton import rule_of
from bcre_studies.models.registry import AUTOMATON
from bcre_studies.observables import named as observables
from bcre_studies.performance.scene_needs import ablation, claims, smallest
from bcre_studies.performance.scene_needs import study as scene_needs
from bcre_studies.performance.scene_needs.ablation import Model, Refused
from bcre_studies.scenes.scene import load


@pytest.fixture(scope="module")
def trials():
    """A thin pulse that hardly moves the surface: figure 3, a short while."""
    return smallest.Trials(load("figure3").with_changes(until=4.0))


def change(scene, name, *without):
    full = ablation.run(scene, Model()).record
    return observables.change(name, full, ablation.run(scene, Model(frozenset(without))).record)


@pytest.mark.parametrize("name", ["figure3", "rough_slope", "climbing_wave"])
def test_full_model_is_the_automaton_as_the_scene_stands(name):
    scene = load(name)
    trial = ablation.run(scene, Model())
    run = AUTOMATON.run(scene, ablation.recorded_times(scene))
    assert np.array_equal(trial.record.R, run.R)
    assert np.array_equal(trial.record.h, run.h)
    assert trial.cell_steps == run.steps * scene.domain.cells
    assert trial.cost == trial.cell_steps


def test_without_D_v_or_gamma_the_coefficient_is_zero():
    scene = load("figure2")
    for name in ("D", "v", "gamma"):
        changed = ablation.changed_scene(scene, Model(frozenset([name])))
        assert getattr(changed.material, name) == 0
        assert changed.automaton.scheme == "upwind"


@pytest.mark.parametrize("name", ["figure2", "figure1", "climbing_wave"])
def test_without_kappa_only_the_curvature_of_the_rule_goes(name):
    scene = load(name)
    full = rule_of(scene)
    rule = rule_of(ablation.changed_scene(scene, Model(frozenset(["kappa"]))))
    assert full.effective_curvature() > 0
    assert rule.effective_curvature() == 0
    assert rule.effective_diffusion() == pytest.approx(full.effective_diffusion(), rel=1e-12)


def test_other_schemes_on_coarser_cells_solve_what_the_full_model_solves():
    scene = load("rough_slope").with_changes(**{"surface.1.amplitude": 0.0})  # held by 25 cells
    full, R0 = rule_of(scene), 5.0
    for scheme in ("calibrated", "limited"):
        rule = rule_of(ablation.changed_scene(scene, Model(scheme=scheme, coarser=4)))
        assert rule.d == 4 * full.d
        expected = full.effective_diffusion(), full.effective_curvature(R0)
        assert (rule.D, rule.kappa) == pytest.approx(expected)


def test_nonlinearity_left_out_of_a_trace_changes_nothing():
    scene = load("figure1").with_changes(until=30.0, step=0.5, **{"rolling.0.amplitude": 1e-9})
    assert change(scene, "R", "nonlinearity") < 1e-7
    thick = scene.with_changes(**{"rolling.0.amplitude": 5.0})
    assert change(thick, "R", "nonlinearity") > 0.01


def test_steps_twice_as_long_are_refused():
    for name in ("figure1", "figure2"):
        with pytest.raises(Refused, match="cannot be stable"):
            ablation.run(load(name), Model(frozenset(["half of the steps"])))


def test_single_precision_takes_the_same_steps_and_differs_by_its_rounding():
    for name in ("figure1", "figure3"):
        scene = load(name)
        full = ablation.run(scene, Model())
        single = ablation.run(scene, Model(frozenset(["double precision"])))
        assert single.cell_steps == pytest.approx(full.cell_steps, rel=0.01)
        changed = observables.change("R", full.record, single.record)
        assert 1e-9 < changed < 1e-4


def test_a_cut_off_stops_the_run_once_all_is_dry():
    scene = load("figure2").with_changes(until=120.0)
    full = ablation.run(scene, Model())
    dry = ablation.run(scene, Model(frozenset(["dry cells"])))
    assert dry.record.R[-1].max() == 0 < full.record.R[-1].max()
    assert dry.cell_steps < 0.8 * full.cell_steps


def test_height_alone_ends_at_repose_without_a_layer():
    trial = ablation.run(load("figure1"), Model(frozenset(["second layer"])))
    assert not trial.record.R.any()
    assert observables.slope(trial.record) == pytest.approx(0.5, abs=1e-6)
    assert trial.cell_steps > 0


def test_smallest_models_hold_and_cost_less(trials):
    for name in observables.posed(trials.scene):
        for tolerance in (0.01, 0.05):
            model = smallest.smallest(trials, name, tolerance)
            again = ablation.run(trials.scene, model)
            assert observables.change(name, trials.full.record, again.record) <= tolerance
            assert again.cost < trials.full.cost


def test_a_tolerance_of_nothing_leaves_no_term_out(trials):
    model = smallest.smallest(trials, "R", 0.0)
    assert model.without <= {"nonlinearity"}
    assert (model.scheme, model.coarser) == ("upwind", 1)


def test_what_matters_only_together_is_put_back(trials, monkeypatch):
    """D and gamma change nothing alone, and everything together."""

    def tried(self, model):
        both = {"D", "gamma"} <= model.without
        alone = 0.002 if "D" in model.without else 0.001
        changed = 0.0 if not model.without else 1.0 if both else alone
        others = model.without - {"D", "gamma"} or model.scheme != "upwind" or model.coarser > 1
        changes = dict.fromkeys(observables.NAMES, 9.0 if others else changed)
        return 1 - 0.1 * len(model.without), changes

    monkeypatch.setattr(smallest.Trials, "_tried", tried)
    fake = smallest.Trials(trials.scene)
    assert smallest.together(fake, "slope", 0.01).without == {"D", "gamma"}
    assert smallest.smallest(fake, "slope", 0.01) == Model(frozenset(["gamma"]))


def test_change_is_shown_with_two_digits_and_rounding_as_zero():
    assert scene_needs.shown(0.012345) == 0.012
    assert scene_needs.shown(4e-8) == 0
    assert scene_needs.shown(math.inf) == math.inf


def tables():
    """Made-up tables of one scene in which all is as it should be."""
    rows = [
        {"without": name, "runs": "yes", "slope": 0.5, "R": 0.5, "cost": 0.9}
        for name in claims.PHYSICAL
    ]
    rows += [
        {"without": name, "runs": "yes", "slope": 0.0, "R": 0.001, "cost": 0.5}
        for name in ("half of the cells", "dry cells", "double precision")
    ]
    rows.append({"without": "half of the steps", "runs": "refused"})
    row = {"scene": "a", "observable": "slope"}
    for percent in ("1", "5"):
        row |= {f"together_{percent}": 0.001, f"smallest_{percent}": "x"}
        row |= {f"change_{percent}": 0.001, f"cost_{percent}": 0.5}
    return {"comparison": pd.DataFrame([row]), "a": pd.DataFrame(rows)}


def verdicts(changes):
    made = tables()
    for (name, column), value in changes.items():
        if name == "comparison":
            made["comparison"].loc[0, column] = value
        else:
            made["a"].loc[made["a"]["without"] == name, column] = value
    return {claim.name: claim.verdict for claim in scene_needs.judge(made)}


@pytest.mark.parametrize(
    ("claim", "changes"),
    [
        ("D is needed", {("D", "slope"): 0.04, ("D", "R"): 0.04}),
        ("second layer is needed", {("second layer", c): 0.0 for c in ("slope", "R")}),
        ("the step is needed for stability", {("half of the steps", "runs"): "yes"}),
        ("double precision left out", {("double precision", "R"): 0.02}),
        ("dry cells left out", {("dry cells", "R"): 0.02}),
        ("left out together", {("comparison", "together_5"): 0.06}),
        ("smallest models within 1 %", {("comparison", "change_1"): 0.02}),
        ("smallest models within 5 %", {("comparison", "cost_5"): 1.0}),
    ],
)
def test_every_claim_can_fail(claim, changes):
    good, bad = verdicts({}), verdicts(changes)
    assert good[claim] == Verdict.AGREE
    assert bad[claim] == Verdict.DISAGREE
    assert {name for name in good if good[name] != bad[name]} == {claim}
