"""Times of the automaton beside those of what would be used instead; ``make bench`` runs them.

Compare within one group and one run only. Whatever compiles has done so before it is timed.
"""

import numpy as np
import pytest

import bcre_ca
from bcre_pde import BCRE
from bcre_studies.models.bcre import problem_of
from bcre_studies.performance.rivals import (
    fipy_solver,
    method_of_lines,
    numpy_automaton,
    pypde_expressions,
)
from bcre_studies.scenes.scene import load
from bcre_studies.timing import machine

ROUNDS = 5
STEPS = {1_000: 20_000, 100_000: 200, 10_000_000: 20}
FIGURE2 = load("figure2")
PROBLEM, UNTIL = problem_of(FIGURE2), FIGURE2.time.until


def figure2_step(cells):
    """The scene's Courant number at any number of cells."""
    return FIGURE2.time.step * FIGURE2.domain.cells / cells


def wet_slope(cells):
    """h, R and a rule under which sand rolls everywhere and stays as it is for long."""
    rule = bcre_ca.Rule(v=0.5, D=0.1, gamma=0.01, Sc=0.5, d=1.0, dt=0.5)
    wave = np.sin(2 * np.pi * np.arange(cells) / 1000)
    return -0.5 * np.arange(cells) + 0.1 * wave, 1 + 0.5 * wave, rule


@pytest.mark.parametrize("cells", STEPS)
def bench_compiled_automaton(benchmark, cells):
    benchmark.group = f"{STEPS[cells]} steps of {cells} cells"
    h, R, rule = wet_slope(cells)
    benchmark.pedantic(bcre_ca.evolve, (h, R, rule, STEPS[cells]), rounds=ROUNDS, warmup_rounds=1)


@pytest.mark.parametrize("cells", STEPS)
def bench_preallocated_numpy(benchmark, cells):
    benchmark.group = f"{STEPS[cells]} steps of {cells} cells"
    h, R, rule = wet_slope(cells)
    benchmark.pedantic(numpy_automaton.march, (h, R, rule, STEPS[cells]), rounds=3, warmup_rounds=0)


def bench_additions(benchmark):
    """7 additions a cell and step: no automaton of 20000 steps of 1000 cells can be faster."""
    benchmark.group = "20000 steps of 1000 cells"
    load = machine.additions(7 * 20_000 * 1000 // (machine.VALUES * machine.CHAIN))
    benchmark.pedantic(load.call, rounds=ROUNDS, warmup_rounds=1)


def bench_memory_passes(benchmark):
    """20 passes over h and R: no step that visits all cells in turn can be faster."""
    benchmark.group = "20 steps of 10000000 cells"
    load = machine.memory_pass(10_000_000)
    benchmark.pedantic(lambda: [load.call() for _ in range(20)], rounds=ROUNDS, warmup_rounds=1)


@pytest.mark.parametrize("cells", [100, 400])
def bench_figure2_in_the_compiled_automaton(benchmark, cells):
    benchmark.group = f"figure 2 to its end, {cells} cells"
    x = FIGURE2.centres(cells)
    m, dt = PROBLEM.material, figure2_step(cells)
    rule = bcre_ca.Rule(m.v, m.D, m.gamma, m.Sc, PROBLEM.length / cells, dt)
    h, R = FIGURE2.initial(x)
    steps = round(UNTIL / dt)
    benchmark.pedantic(
        bcre_ca.evolve, (h, R, rule, steps), rounds=50, iterations=5, warmup_rounds=1
    )


@pytest.mark.parametrize("cells", [100, 400])
def bench_figure2_by_lsoda(benchmark, cells):
    benchmark.group = f"figure 2 to its end, {cells} cells"
    solve = method_of_lines.prepare(PROBLEM, UNTIL, cells)
    benchmark.pedantic(solve, rounds=ROUNDS, warmup_rounds=1)


@pytest.mark.parametrize("cells", [400])
def bench_figure2_by_euler_steps_of_py_pde_compiled_beforehand(benchmark, cells):
    """The same scheme as the automaton's, and the same result."""
    benchmark.group = f"figure 2 to its end, {cells} cells"
    dt = figure2_step(cells)
    solve = pypde_expressions.prepare(PROBLEM, UNTIL, cells, dt)
    same = numpy_automaton.prepare(PROBLEM, UNTIL, cells, dt)()
    np.testing.assert_allclose(solve().R, same.R, rtol=0, atol=1e-12)
    benchmark.pedantic(solve, rounds=20, warmup_rounds=1)


@pytest.mark.parametrize("cells", [100])
@pytest.mark.filterwarnings("ignore:numpy.core:DeprecationWarning")
@pytest.mark.skipif(not fipy_solver.available(), reason="FiPy is not installed")
def bench_figure2_in_fipy(benchmark, cells):
    benchmark.group = f"figure 2 to its end, {cells} cells"
    solve = fipy_solver.prepare(PROBLEM, UNTIL, cells, figure2_step(cells))
    benchmark.pedantic(solve, rounds=3, warmup_rounds=1)


@pytest.mark.parametrize("cells", [1_000, 100_000])
def bench_right_hand_side_of_the_pde(benchmark, cells):
    benchmark.group = f"one right-hand side of BCRE, {cells} cells"
    from pde import CartesianGrid

    grid = CartesianGrid([[0.0, PROBLEM.length]], cells, periodic=False)
    equation = BCRE(PROBLEM.material, grid)
    h, R = PROBLEM.initial(grid.cell_coords[:, 0])
    state = equation.state(grid, h + PROBLEM.material.Sc * grid.cell_coords[:, 0], R)
    benchmark.pedantic(
        equation.evolution_rate, (state,), rounds=50, iterations=1_000_000 // cells, warmup_rounds=1
    )
