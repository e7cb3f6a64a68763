"""The plain integrations themselves: independent of the packages, and right where it is known."""

import ast
import cmath
import math
from pathlib import Path

import numpy as np
import pytest

import exact_sand
import plain_automaton
import plain_bcre
from drawn_scenes import OPTIONS, draw
from sand import Sand

FIGURE_1 = Sand(v=0.1, D=0.1, gamma=0.01, Sc=0.5)
PLAIN = ("sand", "plain_automaton", "plain_bcre", "exact_sand", "drawn_scenes")


@pytest.mark.parametrize("name", PLAIN)
def test_it_knows_nothing_of_what_it_judges(name):
    tree = ast.parse((Path(__file__).parent / f"{name}.py").read_text(encoding="utf-8"))
    roots = {
        (node.module or "").partition(".")[0]
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom)
    } | {
        alias.name.partition(".")[0]
        for node in ast.walk(tree)
        if isinstance(node, ast.Import)
        for alias in node.names
    }
    assert not roots & {"bcre_ca", "bcre_pde", "bcre_studies", "pde"}


# The automaton, from SCIENCE 3 and 4


def test_a_wave_of_the_layer_is_multiplied_by_G():
    cells, dt, sand = 24, 0.7, Sand(v=0.3, D=0.2, gamma=0.0, Sc=0.5)
    angle = 2 * math.pi * 3 / cells
    R = [1 + 0.1 * math.cos(angle * i) for i in range(cells)]
    column = plain_automaton.Column(sand, 1.0, [-0.5 * i for i in range(cells)], R, periodic=True)
    plain_automaton.march(column, dt, 10)
    z = cmath.exp(-1j * angle)
    G = 1 - sand.v * dt * (1 - z) + sand.D * dt * (z - 2 + 1 / z)
    expected = [1 + 0.1 * (G**10 * cmath.exp(1j * angle * i)).real for i in range(cells)]
    assert pytest.approx(expected, abs=1e-13) == column.R


@pytest.mark.parametrize("scheme", plain_automaton.SCHEMES)
@pytest.mark.parametrize("periodic", [False, True])
def test_sand_is_neither_made_nor_lost(scheme, periodic):
    sand = Sand(v=0.4, D=0.2, gamma=0.1, Sc=0.5, kappa=0.02, v_up=0.6)
    drawn = draw(3, scheme=scheme)
    h, R = exact_sand.averages(drawn.data, 24)
    column = plain_automaton.Column(sand, 1.0, h.tolist(), R.tolist(), scheme, periodic)
    before = column.mass()
    plain_automaton.march(column, 0.5 * column.largest_step(), 40)
    assert column.mass() + column.outflow == pytest.approx(before, rel=1e-13)
    assert min(column.R) >= 0


@pytest.mark.parametrize(("scheme", "order"), [("upwind", 1), ("calibrated", 1), ("limited", 2)])
def test_the_climbing_wave_converges(scheme, order):
    # D = 0 leaves the calibrated rule nothing to take from: it stays of first order.
    errors = []
    for cells in (40, 80):
        u, R, exact = climbing_wave(cells, 1.0)
        x = (np.arange(cells) + 0.5) * 20 / cells
        column = plain_automaton.Column(
            WAVE, 20 / cells, (u - WAVE.Sc * x).tolist(), R.tolist(), scheme, periodic=True
        )
        steps = cells // 5
        plain_automaton.march(column, 1.0 / steps, steps)
        errors.append(float(np.mean(np.abs(np.array(column.R) - exact))))
    assert math.log2(errors[0] / errors[1]) > 0.75 * order


WAVE = Sand(v=1.0, D=0.0, gamma=0.5, Sc=0.5)


def climbing_wave(cells, t):
    """u and R at the start and the exact R(x, t) = R0(x + gamma R t), SCIENCE 4.2."""

    def R0(x):
        return 1 + 0.3 * np.exp(-((((x - 10 + 10) % 20 - 10) / 1.5) ** 2))

    x = (np.arange(cells) + 0.5) * 20 / cells
    R = R0(x)
    exact = R.copy()
    for _ in range(100):
        exact = R0(x + WAVE.gamma * exact * t)
    return -R - WAVE.v / WAVE.gamma * np.log(R), R, exact


# BCRE


def test_the_climbing_wave_by_finite_volumes_converges_at_second_order():
    errors = []
    for cells in (100, 200):
        u, R, exact = climbing_wave(cells, 2.0)
        history = plain_bcre.finite_volumes(WAVE, u, R, 0.0, 20.0, [2.0], True)
        errors.append(float(np.mean(np.abs(history.R[-1] - exact))))
    assert math.log2(errors[0] / errors[1]) > 1.8
    assert errors[1] < 1e-4


def test_the_climbing_wave_by_fourier_series_is_exact():
    u, R, exact = climbing_wave(128, 2.0)
    history = plain_bcre.fourier(WAVE, u, R, 20.0, [2.0])
    assert np.max(np.abs(history.R[-1] - exact)) < 2e-7


def test_saturated_exchange_has_its_exact_solution():
    # v_up << gamma R: E = v_up (S - Sc); s = s0(x + v_up t), R - R0(x - v t) as in SCIENCE 4.5.
    gamma, v, v_up, t = 1e9, 0.7, 0.4, 2.0
    sand = Sand(v=v, D=0.0, gamma=gamma, Sc=0.5, v_up=v_up)
    x = (np.arange(64) + 0.5) * 20 / 64
    wave = 2 * np.pi / 20

    def U(x):
        return 0.1 * np.cos(wave * x)  # s0 = -U', hence H = -U

    history = plain_bcre.fourier(sand, U(x), np.full(64, 3.0), 20.0, [t])
    R = 3 - v_up / (v + v_up) * (U(x + v_up * t) - U(x - v * t))
    assert np.max(np.abs(history.u[-1] - U(x + v_up * t))) < 1e-7
    assert np.max(np.abs(history.R[-1] - R)) < 1e-7


def test_both_plain_methods_agree_with_all_terms():
    sand = Sand(v=0.4, D=0.2, gamma=0.1, Sc=0.5, kappa=0.02, v_up=0.6)
    x = (np.arange(192) + 0.5) * 20 / 192
    u, R = 0.3 * np.sin(2 * np.pi * x / 20), 1 + 0.3 * np.cos(2 * np.pi * x / 10)
    exact = plain_bcre.fourier(sand, u, R, 20.0, [5.0])
    near = plain_bcre.finite_volumes(sand, u, R, 0.0, 20.0, [5.0], True)
    assert np.mean(np.abs(near.R - exact.R)) < 2e-4
    assert np.mean(np.abs(near.u - exact.u)) < 2e-4


def test_finite_volumes_with_open_ends_keep_the_sand_and_the_foot():
    x = np.arange(100) + 0.5
    sand = Sand(v=1.0, D=0.5, gamma=0.05, Sc=0.5)
    u, R = -0.3 * x, np.ones(100)
    history = plain_bcre.finite_volumes(sand, u, R, -30.0, 100.0, [0.0, 40.0], False)
    mass = (history.u + history.R).sum(axis=1) + history.outflow
    assert mass[1] == pytest.approx(mass[0], rel=1e-13)
    assert history.outflow[1] > 30
    assert history.u[1, -1] == pytest.approx(-29.85, abs=0.2)
    assert history.R.min() >= 0


# The sand at the start


@pytest.mark.parametrize("ends", ["open", "periodic"])
def test_means_over_cells_are_those_of_the_values(ends):
    for index, (surface, rolling) in enumerate(
        [("sine", "pulses"), ("noise", "pulse"), ("uneven", "table")]
    ):
        drawn = draw(index, ends=ends, surface=surface, rolling=rolling)
        h, R = exact_sand.averages(drawn.data, 24)
        x = (np.arange(24 * 4000) + 0.5) * drawn.length / (24 * 4000)
        for mean, values in zip((h, R), exact_sand.values(drawn.data, x), strict=True):
            fine = values.reshape(24, 4000).mean(axis=1)
            assert np.max(np.abs(mean - fine)) < 1e-6 * np.max(np.abs(fine))


def test_a_pulse_in_a_single_cell_leaves_its_area_there():
    term = {"kind": "gaussian", "amplitude": 1.0, "centre": 50.25, "width": 0.1}
    scene = {"domain": {"length": 100.0, "ends": "open"}, "rolling": [term]}
    _, R = exact_sand.averages(scene, 100)
    assert R[50] == pytest.approx(0.1 * math.sqrt(math.pi), rel=1e-3)
    assert R.sum() == pytest.approx(0.1 * math.sqrt(math.pi), rel=1e-12)


# The scenes


def test_a_number_names_the_same_scene_for_ever():
    first = draw(0).data
    assert first == draw(0).data
    assert first["material"]["v"] == V_OF_SCENE_0


V_OF_SCENE_0 = 0.1865


def test_every_two_options_meet_in_three_hundred_scenes():
    met = [draw(index).options for index in range(300)]
    for a in OPTIONS:
        for value in OPTIONS[a][0]:
            assert sum(row[a] == value for row in met) >= 10
