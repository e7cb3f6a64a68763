"""The paper's figures: how far the automaton is from BCRE, and from BCRE with its own diffusion."""

import numpy as np
import pandas as pd
import pytest

from bcre_studies.comparison.compare import refine
from bcre_studies.comparison.difference import relative_difference
from bcre_studies.comparison.error import SHARE, relative_error
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.models.automaton import rule_of
from bcre_studies.models.effective import effective
from bcre_studies.models.registry import AUTOMATON
from bcre_studies.models.run import Run
from bcre_studies.scenes.scene import load
from bcre_studies.validation import paper_figures
from bcre_studies.validation.paper_figures import TOLERANCE, figure_scene

DIFFERENCES = {
    ("figure2", 1): (0.53, 0.007),
    ("figure2", 2): (0.34, 0.006),
    ("figure2", 4): (0.20, 0.005),
    ("figure3", 1): (0.39, 0.007),
    ("figure3", 2): (0.23, 0.006),
    ("figure3", 4): (0.13, 0.004),
}
"""Relative L1 difference of R at the end: from BCRE as it stands, and with D_eff."""

FIGURE_1 = {1: 0.10, 2: 0.04, 4: 0.02}
"""With D_eff and kappa_eff, in mid-climb."""


def near(found, printed, relative):
    """Within so much of a number of which two decimals, or three below 0.01, are printed."""
    digit = 0.001 if printed < 0.01 else 0.01
    return abs(found - printed) <= relative * printed + digit / 2


@pytest.mark.parametrize("case", DIFFERENCES)
def test_difference_of_figures_2_and_3_is_the_automatons_own_diffusion(case):
    row = paper_figures._compare_case(case)
    nominal, spread = DIFFERENCES[case]
    assert near(row["difference"], nominal, 0.10)
    assert near(row["difference_with_D_eff"], spread, 0.10)
    assert near(row["difference_effective"], spread, 0.10)
    assert row["verdict"] == Verdict.EXPLAINED
    for kind in ("difference", "difference_effective", "difference_with_D_eff"):
        assert row[f"{kind}_error"] <= SHARE * max(row[kind], TOLERANCE)
    assert row["d"] == 1 / case[1]
    for scheme in paper_figures.SCHEMES:
        assert row[f"difference_{scheme}"] < 0.2 * row["difference"]


@pytest.mark.parametrize("refinement", FIGURE_1)
def test_difference_of_figure_1_in_mid_climb_is_both_effective_coefficients(refinement):
    scene = figure_scene("figure1", refinement)
    x, times = scene.centres(), [250.0]
    automaton = AUTOMATON.run(scene, times).R[-1]
    refined = refine(
        effective(scene),
        times,
        lambda run: run.sample(x),
        automaton,
        TOLERANCE,
        coarsest=200 if refinement == 4 else 100,
        finest=800,
    )
    difference = relative_difference(automaton, refined.value)
    assert refined.resolved
    assert relative_error(refined) <= SHARE * max(difference, TOLERANCE)
    assert near(difference, FIGURE_1[refinement], 0.20)


@pytest.mark.parametrize("refinement", [1, 2, 4])
def test_figures_are_refined_at_a_fixed_courant_number(refinement):
    for name, courant in (("figure1", 0.04), ("figure2", 0.5), ("figure3", 0.5)):
        scene = figure_scene(name, refinement)
        rule = rule_of(scene)
        assert rule.v * rule.dt / rule.d == pytest.approx(courant, rel=1e-12)
        assert scene.d == pytest.approx(1 / refinement)
        assert (scene.material, scene.rolling) == (load(name).material, load(name).rolling)
    assert figure_scene("figure1", refinement).time.until == 250
    assert figure_scene("figure2", refinement).time.until == load("figure2").time.until


def table(verdicts, calibrated=0.01):
    """Made-up rows, coarse and fine, with the given verdicts."""
    rows = [
        {
            "quantity": paper_figures.PROFILE,
            "case": name,
            "difference": 0.5,
            "difference_effective": 0.01,
            "difference_calibrated": calibrated,
            "difference_limited": 0.02,
            "d": 1.0,
            "verdict": verdict,
        }
        for name, pair in zip(paper_figures.FIGURES, verdicts, strict=True)
        for verdict in pair
    ]
    rows += [
        {"quantity": paper_figures.CLIMB, "case": name, "verdict": "unresolved"}
        | dict.fromkeys(("automaton", "pde", "pde_error"), 1.0)
        | dict.fromkeys(("pde_effective", "pde_effective_error"), 1.0)
        for name in paper_figures.CLIMBS
    ]
    return {"comparison": pd.DataFrame(rows)}


def test_claim_of_a_figure_is_judged_on_the_papers_own_cells():
    pairs = [("unresolved", "agree"), ("disagree", "agree"), ("agree", "disagree")]
    claims = paper_figures.judge(table(pairs))
    assert [claim.name for claim in claims] == [
        "figure1 profile",
        "figure2 profile",
        "figure3 profile",
        "figure1 climb",
        "figure1_between climb",
        "other schemes",
    ]
    assert [claim.verdict for claim in claims] == [
        Verdict.UNRESOLVED,
        Verdict.DISAGREE,
        Verdict.AGREE,
        Verdict.UNRESOLVED,
        Verdict.UNRESOLVED,
        Verdict.AGREE,
    ]


def test_a_scheme_that_is_not_nearer_to_bcre_turns_its_claim():
    pairs = [("agree", "agree")] * 3
    assert paper_figures.judge(table(pairs))[-1].verdict is Verdict.AGREE
    assert paper_figures.judge(table(pairs, calibrated=0.6))[-1].verdict is Verdict.DISAGREE
    unresolved = paper_figures.judge(table([("unresolved",) * 2] * 3))[-1]
    assert unresolved.verdict is Verdict.UNRESOLVED


def test_climb_time_is_that_of_a_scarp_of_constant_speed():
    x, t = np.arange(100) + 0.5, np.linspace(0, 200, 201)
    place = 85.5 - 0.5 * t[:, None]
    depth = 50 * np.clip((x - place) / 4 + 0.5, 0, 1) * np.minimum(t[:, None] / 5, 1)
    R = np.tile(np.exp(-(((x - 85.5) / 3) ** 2)), (t.size, 1))
    scene = paper_figures.load("figure1")
    h = scene.initial(x)[0] - depth
    run = Run(scene, x, t, h, R, 0 * t, 1, 1)
    assert paper_figures.climb_time(run) == pytest.approx(0.8 * 85.5 / 0.5, rel=0.02)
