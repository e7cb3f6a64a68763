"""Whatever is given to a public entry of BCRE: a right answer, or a line that names it."""

import pickle
from contextlib import nullcontext

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import bcre_pde
from bcre_pde import Material, Problem, SolveError, plane
from bcre_pde.equation import BCRE
from bcre_pde.fixed_step import take_fixed_steps
from bcre_pde.plane import radial

SAND = Material(v=0.1, D=0.1, gamma=0.01, Sc=0.5)
N = 8

WRONG = {
    "text": lambda x: ["a"] * x.size,
    "complex": lambda x: x + 1j,
    "objects": lambda x: np.array([None] * x.size),
    "masked": lambda x: np.ma.masked_greater(x, 0),
    "a column": lambda x: x[:, None],
    "a number": lambda x: 1.0,
    "nothing": lambda x: None,
    "one cell more": lambda x: np.ones(x.size + 1),
    "not a number": lambda x: np.full(x.shape, np.nan),
    "infinite": lambda x: np.full(x.shape, np.inf),
}
RIGHT = {
    "list": lambda x: [1] * x.size,
    "integers": lambda x: np.ones(x.shape, int),
    "single": lambda x: np.ones(x.shape, np.float32),
    "read only": lambda x: np.broadcast_to(1.0, x.shape),
}


def solved(h, R):
    return bcre_pde.solve(Problem(lambda x: (h(x), R(x)), SAND, 8.0), [0.0], N)


def ones(x):
    return np.ones(x.shape)


@pytest.mark.parametrize("layer", ["h", "R"])
@pytest.mark.parametrize("kind", WRONG)
def test_a_wrong_initial_layer_is_named(layer, kind):
    layers = {"h": ones, "R": ones} | {layer: WRONG[kind]}
    with pytest.raises(ValueError, match=f"initial {layer} "):
        solved(**layers)


@pytest.mark.parametrize("kind", RIGHT)
def test_initial_layers_of_any_kind_of_numbers_are_taken(kind):
    found = solved(RIGHT[kind], RIGHT[kind])
    assert np.array_equal(found.R, solved(ones, ones).R)


def test_a_negative_rolling_layer_is_refused():
    with pytest.raises(ValueError, match=r"initial R = -0\.5 somewhere: must be >= 0"):
        solved(ones, lambda x: -0.5 * np.ones(x.shape))
    problem = radial.Problem(lambda r: (0 * r, -ones(r)), SAND, 8.0)
    with pytest.raises(ValueError, match="initial R"):
        radial.solve(problem, [0.0], N)
    flat = plane.Problem(lambda x, y: (0 * x, -ones(x)), plane.Material.isotropic(SAND), 8.0, 8.0)
    with pytest.raises(ValueError, match="initial R"):
        plane.solve(flat, [0.0], (N, N))


@pytest.mark.parametrize("shape", [(3, N - 1), (2, N), (3, N + 5), (N,), (0,)])
def test_rates_of_another_shape_are_refused_before_compiled_code_writes_past_their_end(shape):
    equation = BCRE(SAND, BCRE.grid(8.0, N, "open"))
    right = np.zeros((3, N))
    for layers, out in ((np.zeros(shape), right), (right, np.zeros(shape))):
        with pytest.raises(ValueError, match="has the shape"):
            equation.write_rate(layers, out)
    with pytest.raises(ValueError, match="float32"):
        equation.write_rate(right, np.zeros((3, N), np.float32))


STILL = Problem(lambda x: (0 * x, 0 * x), SAND, 8.0)
ARGUMENTS = {
    "times": lambda x: bcre_pde.solve(STILL, x, N),
    "cells": lambda x: bcre_pde.solve(STILL, [0.0], x),
    "tolerance": lambda x: bcre_pde.solve(STILL, [0.0], N, tolerance=x),
    "method": lambda x: bcre_pde.solve(STILL, [0.0], N, method=x),
    "problem": lambda x: bcre_pde.solve(x, [0.0], N),
    "length": lambda x: Problem(STILL.initial, SAND, x),
    "ends": lambda x: Problem(STILL.initial, SAND, 8.0, x),
    "initial": lambda x: Problem(x, SAND, 8.0),
    "v": lambda x: Material(x, 0.1, 0.01, 0.5),
    "v_up": lambda x: Material(0.1, 0.1, 0.01, 0.5, v_up=x),
    "source width": lambda x: bcre_pde.source.Source(1.0, 2.0, x),
    "steps": lambda x: take_fixed_steps(SAND, np.ones(N), np.ones(N), 1.0, 0.1, x),
    "stop": lambda x: bcre_pde.solve(STILL, [0.0], N, stop=x),
    "source": lambda x: Problem(STILL.initial, SAND, 8.0, sources=[x]),
    "material": lambda x: bcre_pde.largest_explicit_step(x, 1.0, 1.0),
    "D": lambda x: bcre_pde.second_critical_slope(0.1, x, 0.01, 0.5),
    "measure": lambda x: bcre_pde.solve_refined(STILL, [0.0], x, lambda _: 0.1),
    "allowed": lambda x: bcre_pde.solve_refined(STILL, [0.0], lambda _: 0.1, x),
    "ratio": lambda x: bcre_pde.grid_convergence_index(1.0, 2.0, 3.0, x),
    "changed": lambda x: bcre_pde.error_of_finest([x, "a"]),
    "dx": lambda x: take_fixed_steps(SAND, np.ones(N), np.ones(N), x, 0.1, 1),
}


@pytest.mark.parametrize("name", ARGUMENTS)
@pytest.mark.parametrize("value", ["Periodic", -1, float("nan"), [None], 1j, {}])
def test_a_wrong_argument_is_named(name, value):
    with pytest.raises(ValueError, match=rf"^{name}\b"):
        ARGUMENTS[name](value)


TAKEN = ("one cell more", "not a number", "infinite")
"""By steps of fixed length: as many cells as there are, and layers that have grown out of hand."""

wrong = {kind: layer for kind, layer in WRONG.items() if kind not in TAKEN}
any_layer = st.sampled_from([*wrong.values(), *RIGHT.values()])


@given(any_layer, any_layer)
def test_no_pair_of_layers_crashes_or_fails_without_a_name(h, R):
    layers = h(np.ones(N)), R(np.ones(N))
    is_wrong = any(layer in wrong.values() for layer in (h, R))
    with pytest.raises(ValueError, match=r"^(u|R|cells) ") if is_wrong else nullcontext():
        take_fixed_steps(SAND, *layers, 1.0, 0.1, 2)


def test_failure_of_a_solver_survives_a_worker():
    failure = pickle.loads(pickle.dumps(SolveError("gave up", 2.0, 3)))
    assert (str(failure), failure.time, failure.cell) == ("gave up", 2.0, 3)


def test_solutions_compare_as_a_bool():
    found = solved(ones, ones)
    assert (found == found) is True
    assert (found == solved(ones, ones)) is False
