import ast
import math
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import bcre_ca
import bcre_pde
import bcre_pde.theory
import bcre_studies
from bcre_ca import theory as ca_theory
from bcre_pde import simple_wave
from bcre_studies.models.automaton import rule_of
from bcre_studies.models.bcre import problem_of
from bcre_studies.models.effective import effective
from bcre_studies.models.registry import AUTOMATON, BCRE, MODELS
from bcre_studies.models.run import frame_times
from bcre_studies.scenes.scene import load


def figure_2(**changes):
    return load("figure2").with_changes(**({"until": 4.0} | changes))


def test_frames_run_from_zero_to_the_end():
    assert frame_times(load("figure1"), 5) == [0.0, 100.0, 200.0, 300.0, 400.0]


def test_rule_of_a_scene_carries_its_material_and_cell():
    rule = rule_of(figure_2(cells=200, step=0.1))
    assert rule == bcre_ca.Rule(v=2.5, D=0.1, gamma=0.01, Sc=0.5, d=0.5, dt=0.1)


def test_automatic_step_is_four_fifths_of_the_largest_stable_one():
    assert rule_of(figure_2(step="auto")).dt == pytest.approx(
        0.8 / (2.5 + 0.2 + 0.01 * 0.02), rel=1e-10
    )
    assert rule_of(load("figure1")).dt == pytest.approx(0.8 / 0.3, rel=1e-10)


def test_automaton_of_a_scene_is_evolve():
    scene = figure_2()
    run = AUTOMATON.run(scene, [scene.time.until])
    h, R = scene.initial(scene.centres())
    expected = bcre_ca.evolve(h, R, rule_of(scene), 20)
    assert run.steps == 20
    assert run.R[-1].tobytes() == expected[1].tobytes()
    assert run.h[-1].tobytes() == expected[0].tobytes()


def test_step_that_cannot_be_stable_is_refused_with_the_largest_that_would_be():
    with pytest.raises(bcre_ca.UnstableStep, match=r"largest stable step is 0\.370"):
        AUTOMATON.run(figure_2(step=1.0), [4.0])


def test_run_stops_after_the_frame_that_satisfies_it():
    run = AUTOMATON.run(figure_2(), [1.0, 2.0, 3.0, 4.0], stop=lambda run: run.t[-1] >= 2)
    assert run.t.tolist() == [1.0, 2.0]


@pytest.mark.parametrize("name", ["figure1", "figure2", "figure3", "rough_slope"])
def test_mass_is_conserved_to_rounding_in_both_models(name):
    scene = load(name)
    times = [0.0, min(scene.time.until, 60.0)]
    automaton = AUTOMATON.run(scene, times)
    solution = BCRE.run(scene, times, 100)
    assert automaton.mass_error() <= 1e-12
    assert solution.mass_error() <= 1e-12
    assert (automaton.model, solution.model) == ("ca", "pde")


def test_mass_error_is_what_is_missing_relative_to_the_start():
    run = AUTOMATON.run(figure_2(), [0.0, 4.0])
    short = replace(run, R=run.R * np.array([[1.0], [0.9]]))
    scale = run.d * (np.abs(run.h[0]) + run.R[0]).sum()
    assert short.mass_error() == pytest.approx(0.1 * run.d * run.R[1].sum() / scale, rel=1e-9)


def test_dataframe_has_one_row_for_each_time_and_cell():
    run = AUTOMATON.run(figure_2(), [0.0, 2.0, 4.0])
    table = run.to_dataframe(figure="2")
    assert list(table.columns) == ["figure", "model", "t", "x", "h", "R"]
    assert len(table) == 300
    assert set(table["model"]) == {AUTOMATON.name}
    assert table.attrs["units"] == {"t": "time", "x": "length", "h": "length", "R": "length"}
    last = table[table["t"] == 4.0]
    assert np.array_equal(last["R"], run.R[-1])
    assert np.array_equal(last["x"], run.x)


@pytest.mark.parametrize("model", [AUTOMATON, BCRE], ids=lambda model: model.name)
def test_dataset_holds_the_run_with_its_units_and_survives_a_file(model, tmp_path):
    run = model.run(figure_2(), [0.0, 4.0])
    path = tmp_path / "run.nc"
    run.to_xarray().to_netcdf(path, engine="scipy")
    with xr.open_dataset(path, engine="scipy") as data:
        assert np.array_equal(data.R, run.R)
        assert np.array_equal(data.h.sel(t=4.0), run.h[1])
        assert np.array_equal(data.x, run.x)
        assert np.array_equal(data.outflow, run.outflow)
        area = run.d * (data.h + data.R).sum("x") + data.outflow
        assert float(area[1]) == pytest.approx(float(area[0]), rel=1e-12)
        assert data.outflow.attrs["units"] == "length^2"
        assert all({"units", "long_name"} <= set(data[name].attrs) for name in data.variables)
        assert (data.attrs["model"], data.attrs["gamma"], data.attrs["d"]) == (
            model.name,
            0.01,
            run.d,
        )


def test_problem_of_a_scene_carries_its_material():
    scene = figure_2()
    assert problem_of(scene).material == bcre_pde.Material(2.5, 0.1, 0.01, 0.5, 0.0)
    changed = scene.with_changes(D=1.0, kappa=2.0)
    assert problem_of(changed).material == bcre_pde.Material(2.5, 1.0, 0.01, 0.5, 2.0)
    assert (problem_of(scene).length, problem_of(scene).ends) == (100.0, "open")


def test_effective_scene_adds_what_the_cells_and_steps_of_the_automaton_add():
    scene = figure_2(kappa=0.3)
    material = effective(scene).material
    assert pytest.approx(0.1 + 2.5 / 2 * (1 - 0.5), rel=1e-14) == material.D
    assert material.kappa == pytest.approx(0.3 + 0.005, rel=1e-14)
    assert effective(scene, with_curvature=False).material.kappa == 0.3


@pytest.mark.parametrize("v", [0.1, 0.7])
@pytest.mark.parametrize("excess", [0.5, 3.0])
def test_closed_forms_of_the_automaton_tend_to_those_of_the_pde(v, excess):
    D, gamma, R0, k = 0.2, 0.05, 4.0, 1.3
    sigma, d = gamma * excess, 1e-4
    dt = 0.1 * d**2 / D
    pde = bcre_pde.theory
    assert ca_theory.second_critical_excess(v, D, gamma, d) == pytest.approx(
        pde.second_critical_slope(v, D, gamma, 0.0), rel=1e-3
    )
    assert ca_theory.rolling_mode_rate(v, D, d, dt, k) == pytest.approx(
        pde.rolling_mode_rate(v, D, k), rel=1e-3
    )
    assert ca_theory.surface_mode_rate(gamma, R0, d, dt, k) == pytest.approx(
        pde.surface_mode_rate(gamma, 0.0, R0, k), rel=1e-3
    )
    assert ca_theory.growth_rate_at_a_fixed_place(v, D, sigma, d, dt) == pytest.approx(
        pde.growth_rate_at_a_fixed_place(v, D, sigma), abs=1e-3
    )
    assert ca_theory.uphill_front_speed(v, D, sigma, d, dt) == pytest.approx(
        pde.uphill_front_speed(v, D, sigma), abs=1e-3
    )


def test_effective_coefficients_give_the_pde_the_modes_of_the_automaton_at_long_waves():
    v, D, gamma, R0, d, dt, k = 0.3, 0.1, 0.02, 5.0, 0.5, 0.4, 0.01
    rule = bcre_ca.Rule(v, D, gamma, 0.5, d, dt)
    rolling = bcre_pde.theory.rolling_mode_rate(v, rule.effective_diffusion(), k)
    surface = bcre_pde.theory.surface_mode_rate(gamma, rule.effective_curvature(R0), R0, k)
    assert ca_theory.rolling_mode_rate(v, D, d, dt, k).real == pytest.approx(rolling.real, rel=1e-3)
    assert ca_theory.surface_mode_rate(gamma, R0, d, dt, k).real == pytest.approx(
        surface.real, rel=1e-3
    )


@pytest.mark.parametrize("refinement", [1, 2])
def test_automaton_of_the_climbing_wave_is_first_order_and_the_pde_far_nearer(refinement):
    """Both against R(x, t) = R0(x + gamma R t), from the same table; 1.95e-3 at 400 cells."""

    def R0(x):
        distance = (x - 10 + 10) % 20 - 10
        return 1 + 0.3 * np.exp(-((distance / 1.5) ** 2))

    scene = load("climbing_wave").with_changes(cells=400 // refinement, step=0.025 * refinement)
    exact = simple_wave.layer(scene.centres(), 2.0, R0, lambda R: 0.5 * R, 1.3)
    automaton = AUTOMATON.run(scene, [2.0])
    assert np.abs(automaton.R[-1] - exact).mean() == pytest.approx(1.95e-3 * refinement, rel=0.05)
    solution = BCRE.run(scene, [2.0], scene.domain.cells)
    assert np.abs(solution.R[-1] - exact).mean() <= 1e-6
    assert math.isclose(automaton.t[-1], 2.0)


def test_models_are_listed_without_the_libraries_that_run_them():
    code = (
        "import sys; from bcre_studies.models.registry import MODELS; "
        "print(*MODELS, sep=','); heavy = {'numpy', 'numba', 'pde', 'scipy', 'pandas'}; "
        "print(sorted(heavy & set(sys.modules)))"
    )
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ended.stdout.split("\n")[:2] == [
        "ca,pde,pde effective,height alone,aradian,ca aradian,hadeler-kuttler,ca hadeler-kuttler,"
        "hwa-kardar,quasi-static",
        "[]",
    ]


@pytest.mark.parametrize("name", MODELS)
def test_every_model_runs_a_scene_with_no_more_than_its_name(name):
    seen = []
    run = MODELS[name].run(figure_2(), [0.0, 2.0, 4.0], 40, stop=lambda run: seen.append(run.t[-1]))
    assert run.model == name
    assert run.h.shape == run.R.shape == (3, 40)
    assert run.t.tolist() == [0.0, 2.0, 4.0]
    assert run.mass_error() < 1e-12
    assert seen in ([], [0.0, 2.0, 4.0])


def test_names_of_models_stand_in_the_registry_alone():
    root = Path(bcre_studies.__file__).parent
    names = set(MODELS)
    for path in root.rglob("*.py"):
        constants = {
            node.value
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
            if isinstance(node, ast.Constant) and isinstance(node.value, str)
        }
        assert path.name == "registry.py" or not constants & names, path


def test_every_model_looks_different_and_has_a_column_of_its_own():
    for what in ("label", "column", "color", "marker"):
        assert len({getattr(model, what) for model in MODELS.values()}) == len(MODELS)
