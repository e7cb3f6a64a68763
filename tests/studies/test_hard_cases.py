"""What comes of hard scenes: survival, refusal, failure that says where; mass; the verdicts."""

import numpy as np
import pandas as pd
import pytest

import bcre_ca
import bcre_pde
from bcre_studies.comparison.verdict import Verdict
from bcre_studies.verification.hard_cases import (
    adaptive_step,
    attempts,
    claims,
    hard_scenes,
    scarp_grids,
    study,
)
from bcre_studies.verification.hard_cases.attempts import FAILS, REFUSED, SURVIVES, Attempt

SCENES = hard_scenes.scenes()


@pytest.mark.parametrize(
    ("scene", "message"),
    [
        ("v = 2.5, d = 1, dt = 1", "dt = 1 cannot be stable: v dt/d"),
        ("figure 1, dt = 1", "the avalanche outgrew the step at t = "),
    ],
)
def test_fixed_steps_are_refused_where_known_and_fail_by_name_where_outgrown(scene, message):
    row = attempts.tried(Attempt(scene, "ca", "upwind", 1.0))
    assert row["verdict"] == (REFUSED if "2.5" in scene else FAILS)
    assert row["message"].startswith(message)
    assert attempts.tried(Attempt(scene, "ca"))["verdict"].startswith(SURVIVES)


def test_an_avalanche_outgrows_its_step_after_t_200_where_R_passes_100():
    message = attempts.tried(Attempt("figure 1, dt = 1", "ca", "upwind", 1.0))["message"]
    assert 200 < float(message.split("t = ")[1].split(",")[0]) < 400
    assert 100 < float(message.split("R = ")[1].split(";")[0]) < 120
    assert "in cell 63" in message


@pytest.mark.parametrize("scene", ["1 cell", "2 cells"])
def test_grids_too_small_for_bcre_are_refused_and_no_trouble_to_the_automaton(scene):
    row = attempts.tried(Attempt(scene, "pde"))
    assert (row["verdict"], row["mass_error_at_most"]) == (REFUSED, "")
    assert "must be a whole number, at least 8" in row["message"]
    for scheme in attempts.SCHEMES:
        assert attempts.tried(Attempt(scene, "ca", scheme))["verdict"] == SURVIVES


@pytest.mark.parametrize("scheme", attempts.SCHEMES)
@pytest.mark.parametrize("scene", [name for name in SCENES if name != "kappa = 10"])
def test_step_that_follows_its_bounds_survives_everything_with_R_not_negative(scene, scheme):
    row = attempts.tried(Attempt(scene, "ca", scheme))
    assert row["verdict"].startswith(SURVIVES)
    assert row["smallest_R"] >= 0
    assert row["mass_error_at_most"] <= 1e-12
    assert np.isfinite(row["largest_R"])


def end_of(name, model):
    """h at the start and the end, and R, of the automaton or of BCRE."""
    scene = SCENES[name]
    if model == "pde":
        end = bcre_pde.solve(scene.problem, [0.0, scene.until], scene.cells)
        return end.h[0], end.h[-1], end.R
    h, R = scene.problem.initial(scene.centres())
    (end,) = bcre_ca.frames(bcre_ca.Pile(h, R), attempts.rule_for(scene, "upwind"), [scene.until])
    return h, end.h, np.array([R, end.R])


@pytest.mark.parametrize("model", ["ca", "pde"])
def test_layer_carried_up_a_surface_that_rises_in_x_is_laid_down_there(model):
    before, after, R = end_of("valley, S = 0.8 and -0.8", model)
    assert (after - before)[:45].max() < 0.01
    assert (after - before)[50:].max() > 0.05
    assert (after - before)[90:].max() < 1e-3
    before, after, R = end_of("hill, S = -0.8 and 0.8", model)
    assert (after - before)[:50].sum() > 0.8 * R[0].sum()
    assert (after - before)[50:].max() < 0.01


def test_long_run_keeps_its_mass(monkeypatch):
    row = attempts.tried(attempts.attempts(hard_scenes.long_run())[0])
    assert row["verdict"] == SURVIVES
    assert row["mass_error_at_most"] <= claims.MASS
    assert hard_scenes.long_run().until / hard_scenes.long_run().steps[0] == 1e7


def test_failure_at_the_start_of_the_solver_is_a_refusal_and_later_one_is_not():
    at_start = attempts._refusal(bcre_pde.SolveError("too many", 0.0, 3))
    later = attempts._refusal(bcre_pde.SolveError("gave up", 2.0, 3))
    assert (at_start["verdict"], later["verdict"]) == (REFUSED, FAILS)
    assert attempts._refusal(FloatingPointError("outgrew"))["verdict"] == FAILS


def scarp_rows(drift):
    return [
        {"model": model, "kappa": kappa, "cells": cells, "max_R": value, "place": 50.0}
        for model, kappa in (("pde", 0.0), ("pde", 0.005), ("ca", 0.0))
        for cells, value in ((400, 10.0 + drift), (200, 10.0))
    ]


def test_scarp_is_resolved_where_the_last_grid_changes_it_by_less_than_a_percent():
    table = scarp_grids.with_changes(scarp_rows(0.09))
    assert list(table["cells"]) == [200, 400] * 3
    assert set(table["verdict"]) == {"resolved"}
    assert list(table["change_max_R"]) == ["", 0.009] * 3
    assert set(scarp_grids.with_changes(scarp_rows(0.11))["verdict"]) == {"unresolved"}


def test_scarp_of_the_automaton_climbs_on_as_the_cell_shrinks():
    rows = [scarp_grids.on_grid(("ca", 0.0, cells)) for cells in (100, 200)]
    assert rows[1]["max_R"] > 1.2 * rows[0]["max_R"]
    assert rows[1]["place"] < 0.95 * rows[0]["place"]


def test_adapted_step_of_figure_2_gives_the_fixed_steps_R():
    row = adaptive_step.compared("figure2")
    assert row["verdict"] == Verdict.AGREE
    assert row["difference"] < row["fixed_error"]
    row = adaptive_step.compared("figure1")
    assert row["steps"] < 0.6 * row["fixed_steps"]
    assert row["lowered"] > 3


def made_up(message="in cell 3, t = 4: dt = 1", smallest=0.0, mass=1e-13):
    rows = [
        {
            "scene": hard_scenes.long_run().name,
            "verdict": SURVIVES,
            "message": "",
            "smallest_R": smallest,
        },
        {"scene": "A", "verdict": FAILS, "message": message, "smallest_R": ""},
        {"scene": "B", "verdict": REFUSED, "message": "dt = 1: must not", "smallest_R": ""},
    ]
    common = {"model": "ca", "largest_R": 1.0, "mass_error_at_most": ""}
    table = [common | row for row in rows]
    table[0]["mass_error_at_most"] = mass
    adaptive = {"scene": "figure2", "difference": 0.1, "error": 0.2, "fixed_error": 0.2, "steps": 1}
    adaptive |= {"lowered": 0, "raised": 0}
    return {
        "comparison": pd.DataFrame(table),
        "scarp": scarp_grids.with_changes(scarp_rows(0.0)),
        "adaptive_step": pd.DataFrame([adaptive | {"fixed_steps": 2, "verdict": "agree"}]),
    }


def test_claims_fail_by_what_they_claim():
    def failing(**changes):
        claims = study.judge(made_up(**changes))
        return [claim.name for claim in claims if claim.verdict is not Verdict.AGREE]

    assert failing() == []
    assert failing(message="it broke at t = 4") == ["each failing model says where"]
    assert failing(smallest=-0.1) == ["R >= 0"]
    assert failing(mass=1e-11) == ["mass"]
    assert failing(smallest=float("nan")) == ["finite"]


def test_panels_of_the_scarp_name_what_they_show():
    from matplotlib.figure import Figure

    table = pd.DataFrame(
        [
            {"model": model, "kappa": kappa, "cells": cells, "max_R": 1.0, "place": 2.0}
            for model, kappa in scarp_grids.SERIES
            for cells in (100, 200)
        ]
    )
    axis = Figure().subplots()
    scarp_grids.draw(axis, table, "max_R", "max R")
    assert axis.get_ylabel() == "max R"
    names = {line.get_label() for line in axis.get_lines()}
    assert names == {name for _, name in scarp_grids.SERIES.values()}
