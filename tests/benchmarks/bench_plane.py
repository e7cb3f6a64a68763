"""Times of the automaton on a plane beside those of Taichi and landlab; ``make bench`` runs them.

Compare within one group and one run only. Whatever compiles has done so before it is timed.
"""

import numpy as np
import pytest

from bcre_ca.plane import Plane, Run, Sand
from bcre_studies.performance.record.plane import RULE, wet_plane
from bcre_studies.performance.rivals import landlab_hillslope, taichi_automaton

SIDE, STEPS, ROUNDS = 512, 16, 20
SMALL = 256
THREADS = (1, 2)

without_taichi = pytest.mark.skipif(
    not taichi_automaton.available(), reason="Taichi is not installed"
)
without_landlab = pytest.mark.skipif(
    not landlab_hillslope.available(), reason="landlab is not installed"
)


def group_of(steps, side):
    return f"{steps} steps of {side} x {side} cells of a tilted plane"


@pytest.mark.parametrize("threads", THREADS)
def bench_compiled_automaton(benchmark, threads):
    benchmark.group = group_of(STEPS, SIDE)
    run = Run(Sand(*wet_plane(SIDE)), Plane(RULE), threads)
    benchmark.pedantic(run.take, (STEPS,), rounds=ROUNDS, warmup_rounds=2)


@pytest.mark.parametrize("threads", THREADS)
@without_taichi
def bench_like_kernel_in_taichi(benchmark, threads):
    """The same scheme, and after as many steps the same layers."""
    benchmark.group = group_of(STEPS, SIDE)
    layers = wet_plane(SIDE)
    march = taichi_automaton.prepare(*layers, RULE, threads)
    same = Run(Sand(*layers), Plane(RULE), 1)
    same.take(STEPS)
    march.take(STEPS)
    for found, expected in zip(march.layers(), (same.h, same.R), strict=True):
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12)
    benchmark.pedantic(march.take, (STEPS,), rounds=ROUNDS, warmup_rounds=2)


def bench_compiled_automaton_on_a_free_surface(benchmark):
    """The flow rule of one neighbour, as landlab's component has it, but of eight."""
    benchmark.group = f"one step of {SMALL} x {SMALL} cells, steepest descent"
    run = Run(Sand(*wet_plane(SMALL)), Plane(RULE, "d8"), 1)
    benchmark.pedantic(run.take, (1,), {"dt": 0.2}, rounds=ROUNDS, warmup_rounds=2)


@without_landlab
def bench_hillslope_component_of_landlab(benchmark):
    benchmark.group = f"one step of {SMALL} x {SMALL} cells, steepest descent"
    h, _ = wet_plane(SMALL)
    step = landlab_hillslope.prepare(h, RULE.d, 1.5 * RULE.Sc, 0.2)
    assert np.abs(step() - h).max() > 0
    benchmark.pedantic(step, rounds=3, warmup_rounds=0)
