"""When a perturbed slope returns to repose, on slopes and pulses that stand in no study."""

import pandas as pd
import pytest

from bcre_studies.comparison.verdict import Verdict
from bcre_studies.models.effective import effective as effective_scene
from bcre_studies.models.registry import AUTOMATON, BCRE
from bcre_studies.observables.outcome import slope
from bcre_studies.validation.repose_return import repeated_pulses
from bcre_studies.validation.repose_return import study as repose_return
from bcre_studies.validation.repose_return.pulses import FAST, REPEATED, SLOW, scene_of
from bcre_studies.validation.repose_return.repeated_pulses import slopes_of_automaton, slopes_of_pde
from bcre_studies.validation.repose_return.thin_pulse import (
    closed_form,
    second_critical,
    slope_after_thin_pulse,
)


def final_slopes(scene, cells=100):
    """S - Sc after the pulse, automaton and BCRE."""
    times, Sc = [scene.time.until], scene.material.Sc
    run = AUTOMATON.run(scene, times)
    solution = BCRE.run(scene.with_changes(tolerance=1e-4), times, cells)
    return slope(run.x, run.h[-1]) - Sc, slope(solution.x, solution.h[-1]) - Sc


@pytest.mark.parametrize("excess", [-0.25, 0.17, 0.4])
def test_a_thin_pulse_changes_the_slope_by_its_closed_form(excess):
    scene = scene_of(SLOW, excess, 0.01).with_changes(v=0.13, gamma=0.012)
    automaton, pde = final_slopes(scene, 200)
    for measured, d in ((automaton, scene.d), (pde, 0.0)):
        change = slope_after_thin_pulse(scene, d) - excess
        assert change > 1e-6
        assert measured - excess == pytest.approx(change, rel=0.02)


@pytest.mark.parametrize(("kind", "excess", "pulse"), [(SLOW, 1.3, 2.0), (SLOW, 2.9, 0.3)])
def test_after_a_run_to_the_top_both_models_are_at_repose_to_three_digits(kind, excess, pulse):
    automaton, pde = final_slopes(scene_of(kind, excess, pulse))
    assert automaton == pytest.approx(0, abs=1e-3)
    assert pde == pytest.approx(0, abs=1e-3)


@pytest.mark.parametrize("excess", [-0.05, 0.05, 0.4])
def test_a_fast_avalanche_leaves_the_slope_as_it_was(excess):
    automaton, pde = final_slopes(scene_of(FAST, excess, 2.0))
    assert automaton == pytest.approx(excess, abs=1e-4)
    assert pde == pytest.approx(excess, abs=1e-4)


def test_a_slope_above_repose_is_not_brought_below_the_critical_angle_by_one_pulse():
    automaton, pde = final_slopes(scene_of(SLOW, 0.2, 3.0))
    assert automaton > 0.2
    assert pde > 0.2


def test_the_cells_own_diffusion_decides_near_the_slope_from_which_the_avalanche_climbs_back():
    scene = scene_of(SLOW, 0.6, 2.0)
    automaton, pde = final_slopes(scene)
    effective = BCRE.run(effective_scene(scene).with_changes(tolerance=1e-4), [3000.0], 100)
    assert automaton == pytest.approx(0, abs=1e-3)
    assert pde > 0.6
    assert slope(effective.x, effective.h[-1]) == pytest.approx(0.5, abs=1e-3)


def test_repeated_pulses_bring_a_slope_to_repose_from_above_and_towards_it_from_below():
    above = scene_of(SLOW, 0.12, 10.0).with_changes(until=1000.0)
    below = scene_of(SLOW, -0.2, 10.0).with_changes(until=1000.0)
    from_above = [
        slopes_of_automaton(above, 14),
        slopes_of_pde(above, 50, 14),
        slopes_of_pde(effective_scene(above), 50, 14),
    ]
    for slopes in from_above:
        assert slopes[0] > 0.62
        assert slopes[-1] == pytest.approx(0.5, abs=1e-3)
    for slopes in (
        slopes_of_automaton(below, 8),
        slopes_of_pde(below, 50, 8),
    ):
        assert slopes == sorted(slopes)
        assert 0.3 < slopes[0] < slopes[-1] < 0.5


def test_the_first_of_repeated_pulses_is_a_single_one():
    scene = scene_of(SLOW, 0.15, 2.0).with_changes(until=1000.0)
    automaton, pde = final_slopes(scene)
    assert slopes_of_automaton(scene, 1) == pytest.approx([automaton + 0.5], abs=1e-12)
    assert slopes_of_pde(scene, 100, 1) == pytest.approx([pde + 0.5], abs=1e-9)


def test_the_closed_form_is_repose_above_Sd_and_silent_on_thick_pulses():
    def form(excess, pulse, d):
        return closed_form(scene_of(SLOW, excess, pulse), second_critical(SLOW, d), d)

    assert form(1.8, 1.0, 1.0) == 0
    assert form(2.6, 1.0, 0.0) == 0
    assert pd.isna(form(1.8, 1.0, 0.0))
    assert pd.isna(form(0.1, 10.0, 1.0))


@pytest.mark.parametrize(
    ("finals", "printed", "all_or_nothing"),
    [
        ([0.1, 0.31], Verdict.DISAGREE, Verdict.AGREE),
        ([0.0, 0.0], Verdict.AGREE, Verdict.AGREE),
        ([0.05, 0.31], Verdict.DISAGREE, Verdict.DISAGREE),
        ([0.1, 1.7], Verdict.DISAGREE, Verdict.AGREE),
        ([0.1, 1.72], Verdict.DISAGREE, Verdict.DISAGREE),
    ],
)
def test_the_verdicts_turn_when_slopes_return_stop_half_way_or_pass_Sd(
    finals, printed, all_or_nothing
):
    verdicts = [claim.verdict for claim in repose_return.judge(_table(finals))[:2]]
    assert verdicts == [printed, all_or_nothing]


def _table(finals):
    rows = [
        {"case": kind, "S0 - Sc": excess, "pulse": 1.0, "automaton": final, "pde": final}
        for kind, excess, final in [
            (FAST, -0.02, -0.02),
            (SLOW, 0.1, finals[0]),
            (SLOW, 0.3, finals[1]),
            (SLOW, 3.2, 0.0),
        ]
    ]
    extra = {"pde_effective": 0.0, "automaton_theory": 0.0, "pde_theory": 0.0, "verdict": "agree"}
    points = [
        {"S0 - Sc": excess, "pulse": pulse, "pulses": n, "model": model, "S - Sc": 0.0}
        for excess, pulse in repeated_pulses.SEQUENCES
        for n in range(1, repeated_pulses.RELEASES + 1)
        for model in ("ca", "pde")
    ]
    many = {**rows[0], **extra, "case": REPEATED, "pulses": 1}
    comparison = pd.DataFrame([{**row, **extra, "pulses": 1} for row in rows] + [many])
    return {"comparison": comparison, "repeated": pd.DataFrame(points)}
