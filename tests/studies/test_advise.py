"""What is advised: that it meets what was asked, costs little, can be run, and is honest."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

from bcre_studies.advisor import advise as advise_module
from bcre_studies.advisor.advice_text import answer, text, write_advised
from bcre_studies.advisor.advise import Effort, advise
from bcre_studies.advisor.candidate import SAFETY, Candidate, Pilot
from bcre_studies.advisor.closed_forms import closed_form
from bcre_studies.advisor.deviation import OBSERVABLES, deviation, posed, uncertainty
from bcre_studies.advisor.pilot import Allowance, PilotError, coarsest, reference, run_model
from bcre_studies.advisor.question import Question, seconds_of
from bcre_studies.advisor.scene_text import scene_text
from bcre_studies.advisor.widened import advise_with_reference
from bcre_studies.cli import app
from bcre_studies.models.run import frame_times
from bcre_studies.performance.advice.drawn import random_rows
from bcre_studies.performance.advice.truth import TOLERANCE, TRUTH
from bcre_studies.performance.random_scenes import random_scene
from bcre_studies.running.place import Origin
from bcre_studies.running.run import run_scene
from bcre_studies.scenes.scene import load
from bcre_studies.timing.costs import recorded


def counted(**options):
    return Effort(recorded(), clocked=False, seconds=3.0, **options)


def falling(model, order, error, cells=(25, 50, 100), **options):
    """A model whose error falls as a power of d, and whose steps grow with the cells."""
    pilots = tuple(Pilot(n, 2 * n, 1e-3, error * (n / cells[0]) ** -order) for n in cells)
    return Candidate(model, pilots, **options)


@pytest.mark.parametrize("order", [0.5, 1.0, 2.0])
def test_a_power_law_is_predicted_as_it_goes_on(order):
    model = falling("limited", order, 0.4)
    for cells in (30, 70, 400, 1600):
        assert model.error(cells) == pytest.approx(0.4 * (cells / 25) ** -order)
    cells = model.cells_for(0.1)
    assert SAFETY * model.error(cells) <= 0.1
    assert SAFETY * model.error(int(0.9 * cells)) > 0.1


def test_an_order_above_the_schemes_own_is_not_believed():
    assert falling("upwind", 3.0, 0.4).order == 1.0


def test_pilots_of_two_orders_ask_for_more_safety():
    pilots = tuple(Pilot(n, n, 1e-3, e) for n, e in ((25, 0.45), (50, 0.4), (100, 0.1)))
    one, two = falling("limited", 2.0, 0.4), Candidate("limited", pilots)
    assert two.safety(200) > one.safety(200)
    assert two.safety(80) == one.safety(80)


@pytest.mark.parametrize(
    "model",
    [
        falling("limited", 2.0, 60.0),
        falling("limited", 0.1, 0.4),
        falling("upwind", 1.0, 0.4, converges=False),
        falling("upwind", 0.5, 0.5),
    ],
    ids=["more than half wrong", "does not fall", "goes elsewhere", "too far"],
)
def test_nothing_is_predicted_where_the_pilots_do_not_carry_it(model):
    assert model.cells_for(0.01) is None


def test_an_error_that_rises_again_does_not_count_as_small_before():
    errors = {25: 0.2, 50: 0.01, 100: 0.3, 200: 0.02, 400: 0.01}
    model = Candidate("calibrated", tuple(Pilot(n, n, 1e-3, e) for n, e in errors.items()))
    assert 100 < model.cells_for(0.05) <= 200


def test_steps_are_predicted_by_their_linear_and_quadratic_part():
    pilots = tuple(Pilot(n, 3 * n + round(0.1 * n**2), 1e-3, 0.1) for n in (20, 50, 100))
    assert Candidate("upwind", pilots).steps(1000) == pytest.approx(103_000, rel=1e-3)


def test_figure_2_gets_a_model_that_meets_the_tolerance_at_less_cost_than_the_others():
    question = Question(load("figure2"), 0.05)
    advice = advise(question, counted())
    best = advice.options[0]
    assert [option.seconds for option in advice.options] == sorted(
        option.seconds for option in advice.options
    )
    fine = run_model(question.scene, "pde", question.times, 800)
    for option in advice.options:
        run = run_model(question.scene, option.model, question.times, option.cells)
        assert deviation(run, fine) <= 0.05
        assert option.error == pytest.approx(deviation(run, fine), rel=0.3)
        assert option.steps == pytest.approx(run.steps, rel=0.3)
    assert best.model in ("calibrated", "limited")
    assert {option.model for option in advice.options} >= {"upwind", "pde"}
    upwind = next(option for option in advice.options if option.model == "upwind")
    assert upwind.cells > 10 * best.cells


def test_a_smaller_tolerance_asks_for_more_cells():
    scene = load("figure2")
    for model in ("limited", "pde"):
        cells = [
            next(
                o.cells for o in advise(Question(scene, tol), counted()).options if o.model == model
            )
            for tol in (0.1, 0.02)
        ]
        assert cells[1] > 1.3 * cells[0]


def test_the_same_is_advised_again_where_no_clock_enters():
    question = Question(random_scene(3), 0.05, "h")
    first, second = (advise(question, counted()) for _ in range(2))
    assert first.options == second.options
    assert first.pilots_s == second.pilots_s


def test_a_longer_frame_allows_no_less_accuracy_and_every_option_holds_it():
    scene = load("figure2")
    errors = []
    for budget in (5e-5, 2e-4, 2e-3):
        advice = advise(Question(scene, budget=budget), counted())
        assert all(option.seconds <= 10 * budget for option in advice.options)
        errors.append(advice.options[0].error)
    assert errors[0] >= errors[1] >= errors[2]
    assert errors[0] > 2 * errors[2]


def test_a_frame_too_short_for_anything_is_answered_by_nothing():
    advice = advise(Question(load("figure2"), budget=1e-7), counted())
    assert not advice.options
    assert "already take longer" in advice.left_out["limited"]


def test_past_a_scarp_without_kappa_nothing_is_advised():
    advice = advise(Question(load("figure1").with_changes(until=250.0), 0.05), counted())
    assert not advice.options
    assert "past a scarp with kappa = 0" in advice.why


def test_past_a_scarp_advice_is_against_a_named_kappa_that_the_advised_scene_has(tmp_path):
    scene = load("figure1").with_changes(until=220.0, cells=50)
    asked = Question(scene, 0.05, frames=3)
    advice = advise_with_reference(asked, counted())
    assert advice.instead_of.needs_width
    assert not advice.instead_of.options
    assert advice.question.scene == scene.with_changes(kappa=0.01)  # gamma d/2, d = 2
    assert advice.pilots_s > advice.instead_of.pilots_s
    best, path = advice.options[0], tmp_path / "advised.toml"
    fine = run_model(advice.question.scene, "pde", advice.question.times, 400)
    run = run_model(advice.question.scene, best.model, advice.question.times, best.cells)
    assert deviation(run, fine) <= 0.05
    told = text(advice, "figure1", path)
    assert "unresolved:     R of BCRE is known to" in told
    assert "instead:        kappa = 0.01 = gamma d/2" in told
    assert "reference:      BCRE with kappa = 0.01 on" in told
    write_advised(advice, Origin("figure1"), path)
    assert load(path).material.kappa == 0.01


@pytest.mark.parametrize("change", [{"ends": "wall"}, {"Gamma": 0.5}])
def test_what_no_closed_form_holds_has_none(change):
    assert closed_form(load("figure2")) is not None
    assert closed_form(load("figure2").with_changes(**change)) is None


def test_advice_that_is_resolved_keeps_the_scene_as_it_is():
    assert advise_with_reference(Question(load("figure2")), counted()).instead_of is None
    gone = advise_with_reference(Question(load("pulse_at_repose")), counted())
    assert gone.instead_of is None


def test_with_kappa_the_scarp_is_resolved_and_upwind_is_not_predicted():
    scene = load("figure1").with_changes(kappa=0.05, until=250.0)
    advice = advise(Question(scene, 0.05), counted())
    assert advice.options
    assert "no kappa" in advice.left_out["upwind"]


def test_a_pulse_between_the_cells_of_every_pilot_is_not_taken_for_nothing():
    thin = load("figure2").with_changes(cells=10_000, **{"rolling.0.width": 0.01})
    assert [coarsest(load(name)) for name in ("figure2", "figure1", "rough_slope")] == [25, 50, 100]
    with pytest.raises(PilotError, match="wider than parts of the start"):
        coarsest(load("rough_slope"), finest=200)
    advice = advise(Question(thin), counted())
    assert not advice.options
    assert "wider than parts of the start" in advice.why


def test_a_layer_that_has_left_is_said_to_have():
    advice = advise(Question(load("pulse_at_repose")), counted())
    assert not advice.options
    assert "of the layer is left" in advice.why


def test_pilots_stay_within_what_they_may_take():
    with pytest.raises(PilotError, match="would take about"):
        reference(
            load("figure2"), [0.0, 20.0], "R", 1e-3, Allowance(1e-6, recorded(), clocked=False)
        )
    advice = advise(Question(load("figure1")), Effort(recorded(), clocked=False, seconds=0.5))
    assert advice.pilots_s <= 0.5
    assert not advice.options


@pytest.mark.parametrize(
    "changes",
    [{"gamma": 0.0}, {"slope": 0.5}, {}, {"slope": 0.55, "rolling.0.amplitude": 1e-3}],
    ids=["no exchange", "at repose", "figure 2", "thin"],
)
def test_a_thin_layer_on_an_even_slope_has_a_closed_form(changes):
    changes = {("surface.0.slope" if k == "slope" else k): v for k, v in changes.items()}
    scene = load("figure2").with_changes(**changes)
    form, times = closed_form(scene), frame_times(scene, 3)
    fine = run_model(scene, "pde", times, 400)
    run = form.run(scene, times, 400)
    assert deviation(run, fine) < 3e-4
    if scene.material.gamma and scene.surface[0].slope != 0.5:
        assert deviation(run, fine, "h") < 0.01
    advice = advise(Question(scene), counted())
    assert advice.closed[0].name == "frozen slope"
    assert advice.closed[1] < 1e-3


def test_the_closed_form_of_a_thick_layer_is_not_given_out_for_it():
    thick = load("figure2").with_changes(
        **{"surface.0.slope": 1.0, "gamma": 0.1, "rolling.0.amplitude": 10.0}
    )
    assert closed_form(thick) is not None
    assert advise(Question(thick), counted()).closed is None


def test_the_climbing_wave_has_its_exact_solution_until_it_breaks():
    scene = load("climbing_wave")
    times = frame_times(scene, 3)
    run = closed_form(scene).run(scene, times, 400)
    fine = run_model(scene, "pde", times, 400)
    assert deviation(run, fine) < 1e-6
    assert deviation(run, fine, "h") < 1e-4
    assert closed_form(scene.with_changes(until=20.0)) is None
    assert closed_form(scene.with_changes(D=0.1)) is None


@pytest.mark.parametrize("name", ["figure1", "rough_slope"])
def test_other_scenes_have_no_closed_form_or_one_that_is_far_off(name):
    scene = load(name)
    form = closed_form(scene)
    if form is not None:
        times = frame_times(scene, 3)
        fine = run_model(scene, "pde", times, 200)
        assert deviation(form.run(scene, times, 200), fine) > 0.5


def test_a_run_deviates_from_itself_by_nothing_and_from_another_by_what_is_put_in():
    scene = load("figure2")
    run = run_model(scene, "pde", frame_times(scene, 3), 200)
    for observable in OBSERVABLES:
        assert deviation(run, run, observable) == 0
        assert uncertainty([run] * 3, observable) == 0
    thicker = replace(run, R=1.03 * run.R)
    assert deviation(thicker, run, "R") == pytest.approx(0.03, rel=1e-9)
    lower = replace(run, h=run.h[0] + 1.07 * (run.h - run.h[0]))
    assert deviation(lower, run, "h") == pytest.approx(0.07, rel=1e-6)
    assert "front" not in posed(load("rough_slope"))


@pytest.mark.parametrize("grids", [(50, 100, 200), (50, 100, 200, 400)])
def test_the_uncertainty_of_doubled_grids_covers_the_error_of_the_finest(grids):
    scene = load("figure2")
    times = frame_times(scene, 3)
    runs = [run_model(scene, "pde", times, n) for n in grids]
    error = deviation(runs[-1], run_model(scene, "pde", times, 800))
    assert error < uncertainty(runs) < 150 * error


def test_a_scene_written_elsewhere_is_the_same_scene(tmp_path):
    scene = load("climbing_wave").with_changes(title='a "quoted" \x7f title', kappa=1e-5)
    path = tmp_path / "far" / "scene.toml"
    path.parent.mkdir()
    path.write_text(scene_text(scene, path.parent, "# a comment"), encoding="utf-8")
    again = load(path)
    x = scene.centres(77)
    assert (np.array(again.initial(x)) == np.array(scene.initial(x))).all()
    assert (again.title, again.material, again.time) == (scene.title, scene.material, scene.time)


@pytest.fixture
def unhurried(monkeypatch):
    """Pilots have the time that they need, however busy the machine is."""
    monkeypatch.setattr(advise_module, "LEAST_S", 1000.0)
    monkeypatch.setattr(advise_module, "MOST_S", 1000.0)


def test_what_is_written_runs_as_predicted(tmp_path, unhurried):
    path = tmp_path / "advised.toml"
    told = answer(Question(load("climbing_wave"), 0.01, frames=3), Origin("climbing_wave"), path)
    assert "recommended:" in told
    assert f"bcre run {path} --model" in told
    advised = load(path)
    cells = int(re.search(r"recommended:.* (\d+) cells", told)[1])
    model = "pde" if "recommended:    BCRE" in told else "ca"
    (run,) = run_scene(advised, model, 3)
    assert run.x.size == cells
    exact = closed_form(load("climbing_wave")).run(load("climbing_wave"), run.t, 400)
    assert deviation(run, exact) <= 0.01


@pytest.mark.parametrize(
    ("text", "seconds"), [("16ms", 0.016), ("0.016s", 0.016), ("0.016", 0.016), ("2", 2.0)]
)
def test_a_time_is_read_with_its_unit(text, seconds):
    assert seconds_of(text) == pytest.approx(seconds)


@pytest.mark.parametrize("text", ["", "soon", "-1", "0", "nan", "inf", "1 h", "ms", "5us", "1e400"])
def test_what_is_no_time_is_refused(text):
    with pytest.raises(ValueError, match=r"--budget = .*: must be a time > 0"):
        seconds_of(text)


@pytest.mark.parametrize("tolerance", [0.0, 1.0, -0.1, math.nan, math.inf])
def test_a_tolerance_outside_0_and_1_is_refused(tolerance):
    with pytest.raises(ValueError, match=r"--tolerance = .*: must lie between 0 and 1"):
        Question(load("figure2"), tolerance)


def test_an_observable_that_the_scene_does_not_pose_is_refused():
    for scene, name in (("figure2", "colour"), ("rough_slope", "front")):
        with pytest.raises(ValueError, match=f"--observable = '{name}': must be one of R, h"):
            Question(load(scene), observable=name)


def test_the_command_says_and_writes_what_is_advised(tmp_path, unhurried):
    path = tmp_path / "x.toml"
    done = CliRunner().invoke(app, ["advise", "figure2", "--tolerance", "0.1", "--out", str(path)])
    assert done.exit_code == 0
    assert "figure2: R at t = 20 within 10 % of BCRE" in done.output
    assert path.is_file()


def test_the_command_says_that_nothing_can_be_advised_and_writes_nothing(tmp_path):
    path = tmp_path / "x.toml"
    thin = ["--set", "rolling.0.width=0.01", "--set", "cells=10000"]
    done = CliRunner().invoke(app, ["advise", "figure2", *thin, "--out", str(path)])
    assert done.exit_code == 0
    assert "unresolved:" in done.output
    assert not path.exists()


@pytest.mark.parametrize("index", [1, 4])
def test_random_scenes_are_judged_by_a_finer_solution(index):
    rows, _ = random_rows(index)
    assert [row["observable"] for row in rows] == ["R", "h"]
    for row in rows:
        assert row["truth_error"] <= TRUTH * TOLERANCE
        assert (row["result"] == "met") == (row["true_error"] <= TOLERANCE)
