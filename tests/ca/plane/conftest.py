"""Sand on planes of every kind for the tests, small enough for the plain step."""

import math
from dataclasses import replace

import numpy as np
import pytest

from bcre_ca import Rule
from bcre_ca.plane import Plane, Sand, Source, evolve, step
from bcre_ca.plane.bounds import excess_of, largest_step_of

THICK = {"v_up": 1.5, "dry": 1e-4}
"""Terms that each make compiled code of their own; here with walls and base on a tilted plane."""

RULE = Rule(v=0.3, D=0.1, gamma=0.02, Sc=0.6, d=0.7, dt=0.3)


def _scene(rng, flow, shape=None, ends=None, part_of_bound=0.5):
    """Sand wet here and there on a rough plane, with or without walls, base and sources."""
    N, M = shape or rng.integers(1, 40, 2)
    d = rng.uniform(0.3, 1.5)
    rule = Rule(*rng.uniform(0, 0.5, 3), Sc=rng.uniform(0, 1), d=d, dt=1.0)
    if flow == "tilted":
        rule = replace(rule, **THICK)
    h = rng.normal(size=(N, M)) - rng.choice([0.0, 0.6]) * d * np.arange(N)[:, None]
    R = 10 ** rng.uniform(-6, 0, (N, M)) * (rng.random((N, M)) < rng.choice([0.05, 0.5]))
    R[:, : rng.integers(0, M)] = 0
    walls = rng.random((N, M)) < 0.15
    walls[N // 2, M // 2] = False
    R[walls] = 0
    centre = ((N // 2 + 0.5) * d, (M // 2 + 0.5) * d)
    sources = (Source(0.1, centre, 3 * d, (0.5, 2.0)), Source(0.2, centre, 7 * d))
    plane = Plane(
        rule,
        flow,
        D_across=rng.choice([None, 0.0, 0.2]),
        ends=ends or str(rng.choice(["open", "closed", "periodic"])),
        sides=str(rng.choice(["closed", "periodic"])),
        walls=walls,
        base=h - rng.random((N, M)) if rng.random() < 0.5 else None,
        sources=sources if rng.random() < 0.5 else (),
    )
    return Sand(h, R), with_step(plane, h, R, part_of_bound)


def with_step(plane, h, R, part):
    """The plane with a dt of that part of the bound, in which no layer grows by more than half."""
    beyond = excess_of(h, plane)
    largest = largest_step_of(plane, R.max(), max(-beyond.min(), 0.0))
    growth = plane.rule.gamma * np.abs(beyond).max() / plane.rule.d
    dt = min(part * largest, 0.5 / growth if growth > 0 else 1.0, 1.0)
    return replace(plane, rule=replace(plane.rule, dt=dt))


def _plain_march(sand, plane, steps):
    h, R, t, lost = sand.h, sand.R, sand.t, []
    for _ in range(steps):
        h, R, outflow = step(h, R, plane, t)
        t = t + plane.rule.dt
        lost.append(outflow)
    return h, R, math.fsum(lost) * plane.rule.d**2


def _forms():
    """One small run for each code that the tests have compiled: flow, walls, rule, number type."""
    thick = replace(RULE, **THICK)
    layers = np.zeros((4, 4)), np.full((4, 4), 0.1)
    single = tuple(layer.astype(np.float32) for layer in layers)
    walls = np.zeros((4, 4), bool)
    return {
        "double": (layers, Plane(RULE)),
        "facets": (layers, Plane(RULE, "facet8")),
        "single": (single, Plane(RULE)),
        "split4": (layers, Plane(RULE, "split4")),
        "walls": (layers, Plane(thick, walls=walls)),
    }


@pytest.fixture(scope="session", autouse=True)
def compiled(worker_id):
    """Compile the forms, the second worker from the last one on, until the two meet."""
    for _, (layers, plane) in sorted(_forms().items(), reverse=worker_id == "gw1"):
        evolve(*layers, plane, 1)


@pytest.fixture(scope="session")
def scene():
    """(rng, flow, shape, ends, part_of_bound) -> sand and the plane it lies on."""
    return _scene


@pytest.fixture(scope="session")
def plain_march():
    """(sand, plane, steps) -> h, R and the volume that left, by the plain step."""
    return _plain_march


@pytest.fixture
def rng(request):
    """Numbers that depend on the test alone."""
    return np.random.default_rng(list(request.node.name.encode()))


@pytest.fixture(scope="session")
def rule():
    return RULE


@pytest.fixture(scope="session")
def thick_rule():
    """With saturated exchange, and thin layers that come to rest."""
    return replace(RULE, **THICK)
