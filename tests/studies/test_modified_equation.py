"""What the automaton's modified equation explains of its difference from BCRE, and what is left."""

import numpy as np
import pandas as pd
import pytest

from bcre_studies.comparison.compare import compare
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.scenes.scene import load
from bcre_studies.verification import modified_equation as study


def left(*case):
    return study._compare(case)


def test_effective_diffusion_explains_more_than_95_percent_of_figure_2():
    row = left("figure2", "space", 1, 1)
    assert row["explained"] > 0.95
    assert row["D_eff"] == pytest.approx(row["both"], abs=1e-4)
    assert row["kappa_eff"] == pytest.approx(row["nominal"], rel=0.01)
    assert row["verdict"] == Verdict.EXPLAINED


@pytest.mark.parametrize(("v", "D", "gamma", "courant"), [(1.7, 0.3, 0.02, 0.3), (3, 0.05, 0, 0.8)])
def test_it_does_so_on_parameters_that_stand_in_no_scene(v, D, gamma, courant):
    scene = load("figure2").with_changes(v=v, D=D, gamma=gamma, until=15.0, step=courant / v)
    x = scene.centres()
    found = compare(scene, [15.0], lambda run: run.sample(x), 0.05, coarsest=100, finest=400)
    assert found.pde.resolved
    assert found.effective.resolved
    assert found.difference > 0.1
    assert found.difference_effective < 0.1 * found.difference


def test_under_a_thick_layer_on_a_rough_slope_it_is_the_curvature_that_explains():
    row = left("rough_slope", "space", 1, 1)
    assert row["kappa_eff"] < 0.15 * row["nominal"]
    assert row["D_eff"] > 0.5 * row["nominal"]
    assert row["explained"] > 0.9


def test_what_is_left_of_the_climbing_wave_halves_with_the_step():
    rows = [left("climbing_wave", "time", 1, factor) for factor in (1, 2, 4)]
    remains = np.array([row["both"] for row in rows])
    assert remains[:-1] / remains[1:] == pytest.approx([2, 2], abs=study.HALVING)
    nominal = np.array([row["nominal"] for row in rows])
    assert (nominal[1:] / nominal[:-1] > 0.95).all()
    explained = [row["explained"] for row in rows]
    assert explained == pytest.approx(1 - remains / nominal, abs=0.01)
    assert explained[0] < 0.8


def test_what_is_left_of_figure_2_falls_with_the_cell_faster_than_the_difference_itself():
    coarse, fine = (left("figure2", "space", n, n) for n in (1, 4))
    assert coarse["nominal"] / fine["nominal"] == pytest.approx(2.6, abs=0.3)
    assert fine["both"] < coarse["both"]
    assert fine["explained"] > 0.95


@pytest.mark.parametrize("name", ["figure2", "rough_slope", "climbing_wave"])
def test_problems_carry_the_coefficients_of_the_modified_equation(name):
    scene = study.refined_scene(name, 2, 4)
    problems, m = study._variants(scene), scene.material
    dt, d, R0 = scene.time.step, scene.d, scene.initial(scene.centres())[1].min()
    D = m.D + m.v * d / 2 * (1 - m.v * dt / d)
    kappa = m.kappa + m.gamma * d / 2 * (1 - m.gamma * R0 * dt / d)
    expected = {
        "nominal": (m.D, m.kappa),
        "D_eff": (D, m.kappa),
        "kappa_eff": (m.D, kappa),
        "both": (D, kappa),
    }
    assert list(problems) == list(study.VARIANTS)
    for variant, coefficients in expected.items():
        material = problems[variant].material
        assert (material.D, material.kappa) == pytest.approx(coefficients, rel=1e-12)
        assert (material.v, material.gamma, material.Sc) == (m.v, m.gamma, m.Sc)


def test_refinement_in_space_keeps_the_courant_number_and_in_time_the_cell():
    whole = study.refined_scene("figure2", 1, 1)
    in_space, in_time = study.refined_scene("figure2", 4, 4), study.refined_scene("figure2", 1, 4)
    assert (in_space.d, in_space.time.step) == (whole.d / 4, whole.time.step / 4)
    assert (in_time.d, in_time.time.step) == (whole.d, whole.time.step / 4)
    assert study.refined_scene("rough_slope", 2, 2).time.step == pytest.approx(0.4 / 2)


def made_up(**changes):
    """Rows in which everything is explained, but for the changes to those of figure2."""
    rows = []
    for scene in ("figure2", "figure3", "pulse_at_repose", "rough_slope", "climbing_wave"):
        for split, cells, steps in study.SPLITS:
            row = {"scene": scene, "split": split, "d": 1 / cells, "dt": 0.4 / steps}
            alone = (0.4, 0.01) if scene == "rough_slope" else (0.01, 0.5)
            row |= dict(zip(("D_eff", "kappa_eff"), alone, strict=True))
            row |= {"nominal": 0.5, "both": 0.01 / steps}
            row |= {"explained": 0.98, "verdict": str(Verdict.EXPLAINED)}
            rows.append(row | (changes if scene == changes.get("scene", "figure2") else {}))
    return {"comparison": pd.DataFrame(rows)}


def verdicts(**changes):
    return [claim.verdict is Verdict.AGREE for claim in study.judge(made_up(**changes))]


def test_every_claim_can_fail():
    assert verdicts() == [True, True, True, True]
    assert verdicts(explained=0.89) == [False, False, True, True]
    assert verdicts(D_eff=0.2) == [True, True, False, True]
    assert verdicts(scene="rough_slope", kappa_eff=0.3) == [True, True, False, True]
    assert verdicts(scene="climbing_wave", both=0.01) == [True, True, True, False]


def test_what_is_unresolved_is_neither_dropped_nor_held_against_the_coefficients():
    tables = made_up(explained=0.1, verdict=str(Verdict.UNRESOLVED))
    in_space, in_time = study.judge(tables)[:2]
    assert in_space.verdict is in_time.verdict is Verdict.UNRESOLVED
    assert "3 of 15 rows are unresolved (figure2)" in in_space.evidence
    assert "unresolved" not in study.judge(made_up())[0].evidence
    worse = study.judge(made_up(scene="figure3", explained=0.1))[0]
    assert worse.verdict is Verdict.DISAGREE
    assert "less than 90% in 3 of 15 rows (figure3)" in worse.evidence
