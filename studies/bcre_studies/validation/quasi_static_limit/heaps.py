"""Half heaps on level ground, fed at their closed top, in BCRE, the automaton and the limit."""

from __future__ import annotations

from typing import Any

import numpy as np

from bcre_studies.comparison.rounding import significant
from bcre_studies.models.registry import AUTOMATON, BCRE, QUASI_STATIC, Model
from bcre_studies.models.run import Run
from bcre_studies.observables.rolling_share import smallness, surface_error
from bcre_studies.scenes.scene import Scene, load

Row = dict[str, Any]

EPS = (0.1, 0.05, 0.025, 0.0125)
TAU = (0.08, 0.04, 0.02, 0.01)
LENGTH, SC, RATE = 100.0, 0.5, 1.0
CELLS = 80
"""Of a line twice as long as the heap; BCRE also runs on twice as many."""
HIGH, LOW = 0.2, 0.6
"""Between these parts of the heap's length its slope is measured."""
QUANTITIES = ("at rest", "slope", "reach")
MODELS = {model.name: model for model in (BCRE, AUTOMATON)}
FIGURES = ("figure1", "figure2", "figure3")
HEAPS = 12
"""Heaps with other materials, which the rule was not made from."""


def heap(
    eps: float,
    tau: float,
    length: float = LENGTH,
    Sc: float = SC,
    rate: float = RATE,
    spread: float = 0.0,
) -> Scene:
    """The heap that comes to ``length`` at the end.

    A = Sc l and A^2/(2 Sc) = Q t give the time, tau = Q/(v A) gives v, eps = v/(gamma Sc l) gamma.

    Parameters
    ----------
    rate: Q, area poured per unit of time.
    spread: D/(v l).
    """
    height = Sc * length
    v = rate / (tau * height)
    width = 2 * length / CELLS
    return Scene.model_validate(
        {
            "title": f"Half heap, eps = {eps:g}, tau = {tau:g}",
            "material": {"v": v, "D": spread * v * length, "gamma": v / (eps * height), "Sc": Sc},
            "domain": {"length": 2 * length, "cells": CELLS, "ends": "wall"},
            "time": {"until": height * length / (2 * rate)},
            "surface": [{"kind": "incline", "slope": 0.0}],
            "source": [{"rate": rate, "place": width / 2, "width": width}],
            "solver": {"tolerance": 1e-4},
        }
    )


def measured(run: Run, limit: Run) -> dict[str, float]:
    """What the layer changes in the heap at the end, each relative to the quasi-static limit.

    ``error`` is the mean distance of h, or of h + R; ``at rest`` the sand that lies; ``slope`` the
    mean slope between two places on the heap; ``reach`` the mean place of the sand that lies.
    """
    length = limit.scene.domain.length / 2
    places = np.array([HIGH, LOW]) * length
    values = []
    for one in (run, limit):
        x, h = one.x, one.h[-1]
        high, low = one.sample(places, "h")
        values.append((h.sum() * one.d, (high - low) / np.ptp(places), (x * h).sum() / h.sum()))
    own, of_limit = np.array(values)
    sand = {"error": run.h[-1], "error of h + R": run.h[-1] + run.R[-1]}
    lies = limit.h[-1]
    errors = {key: float(np.abs(h - lies).mean() / lies.mean()) for key, h in sand.items()}
    return errors | dict(zip(QUANTITIES, own / of_limit - 1, strict=True))


def on_map(case: tuple[str, float, float]) -> Row:
    """One model at one point of the map of eps and tau."""
    name, eps, tau = case
    scene = heap(eps, tau)
    grids = (2 * CELLS, CELLS) if name == BCRE.name else (CELLS,)
    found = [_on_grid(MODELS[name], scene, cells) for cells in grids]
    row: Row = {"model": name, "eps": eps, "tau": tau}
    row |= {key: significant(value, 4) for key, value in found[0].items()}
    if name == BCRE.name:
        row["grid error"] = significant(max(abs(found[0][k] - found[1][k]) for k in found[0]), 1)
    return row


def _on_grid(model: Model, scene: Scene, cells: int) -> dict[str, float]:
    times = [0.0, scene.time.until]
    return measured(model.run(scene, times, cells), QUASI_STATIC.run(scene, times, cells))


def of_other_material(seed: int) -> Row:
    """A heap of random size, material, rate, eps, tau and diffusion, in BCRE."""
    rng = np.random.default_rng(seed)
    eps, tau = 10 ** rng.uniform(-2.2, -1.0, 2)
    length, Sc, rate = 10 ** rng.uniform(1, 2.5), rng.uniform(0.2, 1.0), 10 ** rng.uniform(-1, 1)
    spread = eps * rng.uniform(0, 1)
    scene = heap(eps, tau, length, Sc, rate, spread)
    found = _on_grid(BCRE, scene, 2 * CELLS)
    row = {"seed": seed, "eps": eps, "tau": tau, "D/(v l)": spread, "l": length, "Sc": Sc}
    row |= {"Q": rate, "error": found["error"]}
    return {key: significant(value, 3) if key != "seed" else seed for key, value in row.items()}


def of_figure(name: str) -> Row:
    """Where a figure of the paper lies, and how far the limit is from the automaton there."""
    scene = load(name)
    times = [float(t) for t in np.linspace(0, scene.time.until, 11)]
    run = AUTOMATON.run(scene, times)
    eps, tau = smallness(run)
    error = surface_error(QUASI_STATIC.run(scene, times), run)
    return {
        "figure": name,
        "eps": significant(eps, 2),
        "tau": significant(tau, 2),
        "error": significant(error, 2),
    }
