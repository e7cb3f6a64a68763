"""Exact solutions hold through ``bcre run`` with tables, on parameters that stand in no file."""

import json
import sys
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from bcre_pde import Material, exact, simple_wave
from bcre_studies import cli

SCENE = """
title = "Exact"
[material]
v = {v!r}
D = {D!r}
gamma = {gamma!r}
Sc = {Sc!r}
[domain]
length = {length!r}
cells = {cells}
ends = "{ends}"
[time]
until = {until!r}
step = {step!r}
[[surface]]
kind = "table"
file = "start.csv"
[[rolling]]
kind = "table"
file = "start.csv"
"""


@pytest.fixture
def run(tmp_path, monkeypatch):
    """Run a table of layers at the cell centres; return x, h, R at the end and the summary."""
    monkeypatch.chdir(tmp_path)

    def run(layers, model, cells, *options, **values):
        length = values["length"]
        x = (np.arange(cells) + 0.5) * length / cells
        h, R = layers(x, 0.0)
        pd.DataFrame({"x": x, "h": h, "R": R}).to_csv("start.csv", index=False)
        Path("scene.toml").write_text(SCENE.format(cells=cells, **values), encoding="utf-8")
        arguments = ["run", "scene.toml", "--model", model, "--frames", "2", "--out", "o"]
        monkeypatch.setattr(sys, "argv", ["bcre", *arguments, *options])
        cli.main()
        table = pd.read_csv("o/profiles.csv")
        end = table[table["t"] == table["t"].max()]
        summary = json.loads(Path("o/summary.json").read_text(encoding="utf-8"))[model]
        return end["x"].to_numpy(), end["h"].to_numpy(), end["R"].to_numpy(), summary

    return run


def order(cells, errors):
    return float(-np.polyfit(np.log(cells), np.log(errors), 1)[0])


# The climbing wave: R(x, t) = R0(x + gamma R t), nonlinear, D = kappa = 0


def hump(x, base, height, width, centre, length):
    distance = (x - centre + length / 2) % length - length / 2
    return base + height * np.exp(-((distance / width) ** 2))


WAVES = {
    "low and fast": (
        {"v": 0.7, "gamma": 0.8, "Sc": 0.3, "length": 14.0, "until": 3.0},
        {"base": 1.2, "height": 0.2, "width": 1.1, "centre": 7.0},
    ),
    "high and slow": (
        {"v": 0.25, "gamma": 0.35, "Sc": 0.8, "length": 23.0, "until": 4.0},
        {"base": 0.9, "height": 0.5, "width": 2.3, "centre": 4.0},
    ),
}


def wave(name):
    """The scene's values, the exact layers, and the time at which the wave breaks."""
    values, shape = WAVES[name]
    R0 = partial(hump, length=values["length"], **shape)
    reach = shape["base"] + shape["height"]
    material = Material(values["v"], 0.0, values["gamma"], values["Sc"])

    def layers(x, t):
        R = simple_wave.layer(x, t, R0, partial(simple_wave.climb, material), reach)
        return simple_wave.surface(material, x, R), R

    steepest = shape["height"] / shape["width"] * np.sqrt(2 / np.e)
    breaking = simple_wave.breaking_time(values["gamma"] * steepest)
    return {**values, "D": 0.0, "ends": "periodic"}, layers, breaking


@pytest.mark.parametrize("name", WAVES)
def test_pde_is_on_the_climbing_wave_to_a_millionth_at_400_cells(run, name):
    values, layers, breaking = wave(name)
    assert values["until"] < breaking
    x, h, R, summary = run(layers, "pde", 400, "--set", "solver.cells=400", step=0.01, **values)
    expected_h, expected_R = layers(x, values["until"])
    assert summary["cells"] == 400
    assert np.abs(R - expected_R).mean() <= 1e-6
    assert np.abs(h - expected_h).mean() <= 1e-6
    moved = np.abs(expected_R - layers(x, 0.0)[1]).mean()
    assert moved > 0.02
    assert summary["mass_error"] <= 1e-12


@pytest.mark.parametrize("name", WAVES)
@pytest.mark.parametrize("cells", [48, 96, 160])
def test_pde_is_as_near_to_the_climbing_wave_as_its_error_estimate_says(run, name, cells):
    values, layers, _ = wave(name)
    grid = ["--set", f"solver.cells={cells}"]
    x, _, R, summary = run(layers, "pde", 800, *grid, step=0.01, **values)
    expected = layers(x, values["until"])[1]
    error = np.abs(R - expected).mean() / expected.mean()
    # The estimate is of all frames, of which the first, half of them here, has no error.
    assert error <= 2 * summary["error_estimate"] <= 40 * error


@pytest.mark.parametrize("name", WAVES)
def test_automaton_is_of_order_one_on_the_climbing_wave(run, name):
    values, layers, _ = wave(name)
    cells, errors = (200, 400, 800), []
    for count in cells:
        step = values["length"] / count / (2 * values["v"])
        bound = values["length"] / count / (values["gamma"] * 1.5)
        x, h, R, summary = run(layers, "ca", count, step=min(step, bound), **values)
        expected_h, expected_R = layers(x, values["until"])
        errors.append([np.abs(R - expected_R).mean(), np.abs(h - expected_h).mean()])
        assert summary["R_min"] >= 0
        assert summary["mass_error"] <= 1e-12
    for kind in np.transpose(errors):
        assert 0.9 <= order(cells, kind) <= 1.1
        assert kind[-1] < 2e-3


def test_coefficient_off_by_one_percent_is_seen(run):
    values, layers, _ = wave("low and fast")
    for name in ("v", "gamma"):
        wrong = values | {name: 1.01 * values[name]}
        x, _, R, _ = run(layers, "pde", 400, "--set", "solver.cells=400", step=0.01, **wrong)
        assert np.abs(R - layers(x, values["until"])[1]).mean() > 1e-5


# The frozen slope: R = M (4 pi D t)^(-1/2) exp(sigma t - (x - v t)^2/(4 D t)) under R of 1e-100


RELEASE = {"excess": 0.8, "v": 0.7, "D": 0.4, "gamma": 0.15, "Sc": 0.3}


def release():
    solution = exact.frozen_slope_release(**RELEASE)
    values = {name: RELEASE[name] for name in ("v", "D", "gamma", "Sc")}
    values |= {"length": solution.length, "until": solution.until, "ends": "open"}
    return values, solution


def errors_in_window(solution, x, R):
    inside = (x >= solution.window[0]) & (x <= solution.window[1])
    expected = solution.layers(x, solution.until)[1]
    return np.abs(R - expected)[inside].mean() / expected[inside].mean()


def test_pde_carries_spreads_and_grows_a_layer_of_1e_100_on_an_incline(run):
    values, solution = release()
    x, h, R, summary = run(
        solution.layers, "pde", 400, "--set", "solver.cells=400", step=0.01, **values
    )
    assert 1e-101 < R.max() < 1e-99
    assert errors_in_window(solution, x, R) <= 1e-6
    assert h == pytest.approx(solution.layers(x, 0.0)[0], abs=1e-10)
    assert (R @ x) / R.sum() == pytest.approx(15 + 0.7 * solution.until, abs=0.01)
    assert summary["mass_error"] <= 1e-12


def test_automaton_is_of_order_one_on_a_layer_of_1e_100_on_an_incline(run):
    values, solution = release()
    cells, errors = (400, 800, 1600), []
    for count in cells:
        d = solution.length / count
        step = 0.5 / (values["v"] / d + 2 * values["D"] / d**2)
        x, h, R, _ = run(solution.layers, "ca", count, step=step, **values)
        errors.append(errors_in_window(solution, x, R))
        assert h == pytest.approx(solution.layers(x, 0.0)[0], abs=1e-10)
    assert 0.9 <= order(cells, errors) <= 1.1


# A wave of R on the repose slope: R = 1 + e^(-D k^2 t) sin(k (x - v t))/2


def test_wave_of_the_rolling_layer_drifts_and_decays_in_both_models(run):
    solution = exact.rolling_mode(wavenumber=0.9, v=1.3, D=0.17, Sc=0.7)
    values = {"v": 1.3, "D": 0.17, "gamma": 0.5, "Sc": 0.7}
    values |= {"length": solution.length, "until": solution.until, "ends": "periodic"}
    x, _, R, _ = run(solution.layers, "pde", 100, "--set", "solver.cells=100", step=0.01, **values)
    expected = solution.layers(x, solution.until)[1]
    assert np.abs(R - expected).mean() <= 1e-6
    assert 0.2 < np.ptp(expected) < 0.9
    cells, errors = (100, 200, 400), []
    for count in cells:
        d = solution.length / count
        step = 0.5 / (1.3 / d + 2 * 0.17 / d**2)
        x, _, R, _ = run(solution.layers, "ca", count, step=step, **values)
        errors.append(np.abs(R - solution.layers(x, solution.until)[1]).mean())
    assert 0.9 <= order(cells, errors) <= 1.1
