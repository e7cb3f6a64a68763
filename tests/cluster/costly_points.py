"""Sweeps whose cost is measured: a bare rule a point, a scene a point, and a point that waits."""

import time
from functools import cache
from pathlib import Path

import numpy as np

import bcre_ca
from bcre_studies.sweeps.of_spec import sweep_of
from bcre_studies.sweeps.spec import load_spec
from bcre_studies.sweeps.sweep import Sweep

CELLS, STEPS = 200, 2000
WAIT_S = 0.01
MODULE = "bcre_studies.sweeps.points"
RANGES = {"v": (0.05, 0.2), "D": (0.05, 0.2), "gamma": (0.005, 0.02)}

SPEC = f"""
title = "A scene a point"
scene = "figure1"
models = ["ca"]
observables = ["slope"]
frames = 2

[set]
"domain.cells" = {CELLS}
"domain.length" = {CELLS}.0
"time.until" = {STEPS}.0
"time.step" = 1.0
"surface.0.slope" = 0.48
"rolling.0.centre" = 40.0

[sample]
method = "latin hypercube"
seed = 1
"""


@cache
def start():
    """h and R of every bare rule: a pulse on a slope just below repose."""
    x = np.arange(CELLS) + 0.5
    return 0.48 * (CELLS - x), np.exp(-(((x - 40) / 3) ** 2))


def rule_of(point):
    """The rule of a point."""
    return bcre_ca.Rule(point["v"], point["D"], point["gamma"], Sc=0.5, d=1.0, dt=1.0)


def step_on(point):
    """So many steps of the point's rule."""
    h, R = bcre_ca.evolve(*start(), rule_of(point), STEPS)
    return {"height": float(h[0]), "layer": float(R.max())}


def wait(point):
    """Nothing, for a while."""
    time.sleep(WAIT_S)
    return {"height": point["v"], "layer": 0.0}


def points(count):
    """So many points of the ranges, the same ones every time."""
    chance = np.random.default_rng(1)
    drawn = [chance.uniform(low, high, count).tolist() for low, high in RANGES.values()]
    return [dict(zip(RANGES, values, strict=True)) for values in zip(*drawn, strict=True)]


def bare(measure, count):
    """A sweep of so many rules without scenes."""
    columns = dict.fromkeys((*RANGES, "height", "layer"), float)
    return Sweep("rules", measure, points(count), columns, {"count": count}, MODULE)


def of_scenes(count, folder):
    """The same as the sweep of a TOML file."""
    axes = "".join(
        f'[[axis]]\nkey = "{key}"\nfrom = {low}\nto = {high}\n'
        for key, (low, high) in RANGES.items()
    )
    path = Path(folder) / "spec.toml"
    path.write_text(f"{SPEC}count = {count}\n{axes}")
    return sweep_of(load_spec(path))
